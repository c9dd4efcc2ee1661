// A vehicle whose truth is its file's hydrodynamic derivatives: the simulator moves it as manoeuvres are flown, and its
// instruments see what they should.
#include <doctest/doctest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/model/sensors/kinematic_point.hpp"
#include "test/support/dive_site.hpp"

using namespace fathom;
using namespace fathom::simulation;

namespace {

const std::string kName = "pap104_half";
const test::Changes kStillLine{{"umbilical_pull: 1 N", "umbilical_pull: 0 N"}};
const test::Changes kPerfectCells{{"noise: 0.2 N", "noise: 0 N"}, {"gain_error: 3 %", "gain_error: 0 %"}};

/// Flies a preset from the simulator's start and hands every step's samples out.
template <class Each>
void fly(Simulator& simulator, const std::string& name, double seconds, const Each& each) {
  model::ManoeuvrePilot pilot{model::manoeuvre_preset(name)};
  const Utime end = utime_after(simulator.now(), seconds);
  while (simulator.now() < end) {
    const double t = seconds_between(simulator.origin(), simulator.now());
    simulator.drive(pilot.thrust(t, euler_from_rotation(simulator.moment().R_WB).z()));
    each(simulator.step());
  }
}

}  // namespace

TEST_CASE("simulator: the PAP-104 goes where the same manoeuvre takes it when it is flown alone") {
  for (const char* name : {"line", "zigzag", "circle"}) {
    CAPTURE(std::string{name});
    auto simulator = test::make_simulator(kName, kName, {}, kStillLine);
    const auto flight = model::fly(test::vehicle_of_file(kName), model::manoeuvre_preset(name), 0.02);
    double apart = 0.0, turned = 0.0;
    fly(*simulator, name, 59.0, [&](const auto&) {
      const Moment now = simulator->moment();
      const model::FlightMoment& alone = flight[static_cast<std::size_t>(std::lround(now.t / 0.02))];
      apart = std::max(apart, (now.p_WB - alone.p_WB).norm());
      turned = std::max(turned, now.q_WB.angularDistance(alone.q_WB));
    });
    CHECK(apart < 0.05);  // m: another step of integration, a thrust that is held for 20 ms
    CHECK(turned < 0.01);
    CHECK((flight[2950].p_WB - flight[0].p_WB).norm() > 2.0);
    CHECK(simulator->contacts().floor == 0);
  }
}

TEST_CASE("simulator: load cells of derivatives show thrust, the chain's weight, and an umbilical that trails") {
  test::Changes changes = kStillLine;
  changes.insert(changes.end(), kPerfectCells.begin(), kPerfectCells.end());
  auto simulator = test::make_simulator(kName, kName, {}, changes);
  std::vector<Loads> loads;
  fly(*simulator, "line", 50.0, [&](const auto& samples) { test::collect(samples, loads); });
  const Eigen::Map<const Eigen::VectorXd> rest{loads.front().load.data(), 8}, ahead{loads.back().load.data(), 8};
  const model::Vehicle vehicle = test::vehicle_of_file(kName);
  CHECK(rest.head<5>().norm() < 1e-3);  // neither thrust nor drag
  // At rest the chain's lifted part balances the buoyancy that is too much; it bobs a little.
  CHECK(rest.tail<3>().norm() == doctest::Approx(vehicle.buoyancy - vehicle.mass * model::kGravity).epsilon(0.01));
  CHECK(ahead[0] == doctest::Approx(11.5));
  CHECK(ahead[1] == doctest::Approx(11.5));
  const Moment now = simulator->moment();
  CHECK(ahead[2] == doctest::Approx(now.umbilical_B.x()).epsilon(0.01));
  CHECK(now.umbilical_B.x() < -1.0);  // N: it drags
  CHECK(ahead[5] < rest[5]);          // the chain rubs
}

TEST_CASE("simulator: the umbilical's random pull has its size, acts in motion alone, and is the seed's") {
  const auto pulls = [](std::uint64_t seed) {
    auto simulator = test::make_simulator(kName, kName, {.seed = seed}, kPerfectCells);
    std::vector<Loads> loads;
    fly(*simulator, "line", 59.0, [&](const auto& samples) { test::collect(samples, loads); });
    return loads;
  };
  const auto loads = pulls(1), again = pulls(1), other = pulls(2);
  double still = 0.0, square = 0.0, n = 0.0;
  for (const Loads& one : loads) {
    const double t = seconds_between(loads.front().utime, one.utime);
    if (t < 5.0) still = std::max(still, std::abs(one.load[3]));
    if (t > 20.0) square += one.load[3] * one.load[3], n += 1.0;
  }
  CHECK(still < 0.05);
  CHECK(std::sqrt(square / n) > 0.6);  // N, of a process of 1 N and 1 s over 39 s
  CHECK(std::sqrt(square / n) < 1.5);
  CHECK(loads.back().load == again.back().load);
  CHECK(loads.back().load != other.back().load);
}

TEST_CASE("simulator: transponders ahead are hidden by the hull, others are not") {
  auto simulator =
      test::make_simulator(kName, kName, {}, {{"      loss: 5 %", "      loss: 0 %"}, {"loss: 90 %}", "loss: 100 %}"}});
  std::vector<Ranges> ranges;
  fly(*simulator, "circle", 90.0, [&](const auto& samples) { test::collect(samples, ranges); });
  // At the start, heading north from (3, 10): C lies within 37 degrees of the bow, A astern.
  CHECK(ranges.front().valid[0] == 1);
  CHECK(ranges.front().valid[2] == 0);
  int hidden = 0, heard = 0;
  for (const Ranges& one : ranges) (one.valid[0] != 0 ? heard : hidden) += 1;
  CHECK(hidden > 5);  // the circle turns its bow to each of them
  CHECK(heard > 30);
}

TEST_CASE("simulator: hidden effects act on a vehicle of derivatives as on any other") {
  const auto speed = [](const std::vector<std::string>& hide) {
    auto simulator = test::make_simulator(kName, kName, {.hide = hide}, kStillLine);
    fly(*simulator, "line", 58.0, [](const auto&) {});
    return simulator->moment();
  };
  const Moment plain = speed({}), weak = speed({"thruster_gain=variant:port,gain_change:-0.2"});
  CHECK(weak.nu[0] < plain.nu[0] - 0.01);
  CHECK(weak.R_WB(1, 0) < -0.05);  // the port thruster gives less: the bow goes to port
  const Moment carried = speed({"current=v_N:0.1,v_E:0"});
  CHECK(carried.p_WB.x() > plain.p_WB.x() + 1.0);
  CHECK(carried.nu[0] > plain.nu[0] + 0.02);
  CHECK(carried.nu[0] < plain.nu[0] + 0.1);  // the chain holds on to the ground
}

TEST_CASE("simulator: what does not go together with derivatives is said") {
  const auto complaint = [](const test::Changes& changes) -> std::string {
    try {
      static_cast<void>(test::make_simulator(kName, kName, {}, changes));
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  CHECK(complaint({}) == "none");
  CHECK(complaint({{"  derivatives:", "  truth: {m_X: 1 kg}\n  derivatives:"}}).find("two truths") !=
        std::string::npos);
  CHECK(complaint({{"pull_memory: 1 s", "pull_memory: 0 s"}}).find("pull_memory") != std::string::npos);
  CHECK_THROWS_AS(static_cast<void>(test::make_simulator("seabotix_lbv150", kName, {})), InputError);
}
