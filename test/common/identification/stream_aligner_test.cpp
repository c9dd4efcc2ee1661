// Which input and voltage a state meets, and when it may be used.
#include "common/identification/stream_aligner.hpp"

#include <doctest/doctest.h>

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr Utime kMs = 1000;

StateEstimate state_at(Utime ms) {
  StateEstimate state;
  state.utime = ms * kMs;
  return state;
}

model::ActuatorForces force(double value) { return model::ActuatorForces::Constant(2, value); }

}  // namespace

TEST_CASE("stream aligner: a state waits for an input at or after it, and meets what lies between") {
  StreamAligner aligner{{}};
  REQUIRE(aligner.push_input(0, force(1.0)));
  REQUIRE(aligner.push(state_at(25)));
  CHECK_FALSE(aligner.next());
  REQUIRE(aligner.push_input(100 * kMs, force(5.0)));
  const auto aligned = aligner.next();
  REQUIRE(aligned);
  CHECK((*aligned->input)[0] == doctest::Approx(2.0));
  CHECK_FALSE(aligner.next());

  StreamAligner held{{.interpolate = false}};
  (void)held.push_input(0, force(1.0));
  (void)held.push_input(100 * kMs, force(5.0));
  (void)held.push(state_at(25));
  CHECK((*held.next()->input)[0] == 1.0);
}

TEST_CASE("stream aligner: a wide gap between inputs leaves a state without one, a stopped stream too") {
  StreamAligner aligner{{}};
  (void)aligner.push_input(0, force(1.0));
  (void)aligner.push_input(900 * kMs, force(1.0));
  (void)aligner.push(state_at(300));
  CHECK_FALSE(aligner.next()->input);
  (void)aligner.push(state_at(1000));
  (void)aligner.push(state_at(1400));
  CHECK_FALSE(aligner.next());  // the input may be late
  (void)aligner.push(state_at(2000));
  REQUIRE(aligner.next());  // no longer
  CHECK_FALSE(aligner.push(state_at(2000)));
  CHECK_FALSE(aligner.push_input(900 * kMs, force(2.0)));
  CHECK(aligner.next(true));  // the end of the streams decides about the rest
}

TEST_CASE("stream aligner: voltage is the newest at or before the state, waited for no longer than the skew") {
  StreamAligner aligner{{.voltage = true}};
  for (const Utime ms : {0, 400, 800, 1200}) (void)aligner.push_input(ms * kMs, force(1.0));
  (void)aligner.push_voltage(0, 16.0);
  (void)aligner.push(state_at(100));
  CHECK_FALSE(aligner.next());
  (void)aligner.push_voltage(100 * kMs, 15.0);
  (void)aligner.push_voltage(200 * kMs, 14.0);
  CHECK(aligner.next()->voltage == 15.0);
  (void)aligner.push(state_at(600));
  CHECK_FALSE(aligner.next());
  (void)aligner.push(state_at(1150));
  CHECK(aligner.next()->voltage == 14.0);
}
