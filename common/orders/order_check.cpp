#include "common/orders/order_check.hpp"

#include <cmath>

namespace fathom::orders {

void OrderCheck::begin(std::int64_t challenge, std::int64_t accepted) {
  if (challenge == challenge_) return;
  challenge_ = challenge;
  accepted_ = accepted;
  last_.reset();
  aborted_.reset();
}

std::string_view OrderCheck::objection(const Operator& order, Utime now) const {
  if (!order.authentic) return "not signed with this vehicle's key";
  if (challenge_ == 0) return "no thruster driver has been heard";
  if (order.challenge != challenge_) return "a replay: to a thruster driver that has since been started again";
  if (order.sequence <= accepted_) return "heard before";
  if (order.sequence > accepted_ + kAhead) return "its number does not follow the last one";
  if (std::abs(seconds_between(order.utime, now)) > age_) return "not of this time: a replay, or late";
  const bool clock_went_back = aborted_ && now < *aborted_;  // then nothing is known of before and after
  if (aborted_ && !clock_went_back && order.utime <= *aborted_) return "given before the abort; give it again";
  return {};
}

}  // namespace fathom::orders
