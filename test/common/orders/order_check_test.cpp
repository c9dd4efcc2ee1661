// Which orders may be obeyed, rule by rule.
#include "common/orders/order_check.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace fathom;
using orders::OrderCheck;

namespace {

constexpr Utime kNow = 1'700'000'000'000'000;

Operator good(std::int64_t sequence) {
  return {.utime = kNow, .sequence = sequence, .challenge = 77, .enable = true, .authentic = true};
}

std::string said(const OrderCheck& check, const Operator& order) { return std::string{check.objection(order, kNow)}; }

}  // namespace

TEST_CASE("orders: one that is signed, new, of this life and of now may be obeyed, and each rule is missed alone") {
  OrderCheck check{5.0};
  CHECK(said(check, good(1)).find("no thruster driver") != std::string::npos);
  check.begin(77);
  CHECK(said(check, good(1)).empty());
  Operator order = good(1);
  order.authentic = false;
  CHECK(said(check, order).find("not signed") != std::string::npos);
  order = good(1);
  order.challenge = 78;
  CHECK(said(check, order).find("started again") != std::string::npos);
  for (const double off : {-5.1, 5.1}) {
    order = good(1);
    order.utime = utime_after(kNow, off);
    CHECK(said(check, order).find("not of this time") != std::string::npos);
  }
  order = good(1);
  order.utime = utime_after(kNow, 4.9);
  CHECK(said(check, order).empty());
}

TEST_CASE("orders: numbers rise, may leave some out, and no order locks out the others") {
  OrderCheck check{5.0};
  check.begin(77);
  check.accept(good(3));
  CHECK(said(check, good(3)) == "heard before");
  CHECK(said(check, good(2)) == "heard before");
  CHECK(check.again(good(3)));
  CHECK_FALSE(check.again(good(2)));
  Operator other = good(3);  // of another console, in the same moment
  ++other.utime;
  CHECK_FALSE(check.again(other));
  other = good(3);
  other.authentic = false;
  CHECK_FALSE(check.again(other));
  CHECK(said(check, good(4)).empty());
  CHECK(said(check, good(3 + OrderCheck::kAhead)).empty());
  CHECK(said(check, good(4 + OrderCheck::kAhead)).find("does not follow") != std::string::npos);
  CHECK(said(check, good(kNow)).find("does not follow") != std::string::npos);  // a clock's time is no number
}

TEST_CASE("orders: a new life of the gate begins with its own numbers; who comes late begins with those accepted") {
  OrderCheck check{5.0};
  check.begin(77, 5);
  CHECK(said(check, good(5)) == "heard before");
  check.accept(good(6));
  check.begin(77, 5);  // said again
  CHECK(said(check, good(6)) == "heard before");
  check.begin(78, 0);
  CHECK(said(check, good(7)).find("started again") != std::string::npos);
  Operator order = good(1);
  order.challenge = 78;
  CHECK(said(check, order).empty());
}

TEST_CASE("orders: what was given before an abort and comes after it is not obeyed, whoever kept it back") {
  OrderCheck check{5.0};
  check.begin(77);
  check.accept(good(1));
  const Utime aborted = utime_after(kNow, -1.0);
  check.abort(aborted);
  Operator order = good(2);
  for (const double before : {0.0, 0.1, 3.0}) {
    order.utime = utime_after(aborted, -before);
    CHECK(said(check, order).find("before the abort") != std::string::npos);
  }
  order.utime = utime_after(aborted, 0.1);
  CHECK(said(check, order).empty());
  check.abort(utime_after(kNow, 3600.0));  // by a clock that has been set back since
  CHECK(said(check, order).empty());
  check.abort(aborted);
  check.begin(78);  // a new life knows of no abort, and has a challenge of its own
  order = good(1);
  order.challenge = 78;
  order.utime = utime_after(aborted, -0.1);
  CHECK(said(check, order).empty());
}
