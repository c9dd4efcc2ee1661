// A residual that is "due primarily to the umbilical and chain forces" (Pereira and Duncan, sec. VI): it goes with them
// when they are not known, and away when they are.
#include "common/identification/regression/residual_tracing.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/model/manoeuvres.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::identification {
namespace {

constexpr double kRowEvery = 0.1;  // s

/// Exact motion under an umbilical that pulls at random (1 N, 1 s), and a small white force that nothing measures.
std::vector<ManoeuvreRows> pulled(const model::Vehicle& vehicle) {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  std::vector<ManoeuvreRows> runs;
  for (const char* name : {"line", "zigzag", "circle"}) {
    model::Manoeuvre manoeuvre = model::manoeuvre_preset(name);
    manoeuvre.duration = 95.0;
    std::vector<Eigen::Vector3d> pull{Eigen::Vector3d::Zero()};
    while (pull.size() < 9700) {
      const Eigen::Vector3d fresh{normal(random), normal(random), normal(random)};
      pull.push_back(0.99 * pull.back() + std::sqrt(1.0 - 0.99 * 0.99) * fresh);
    }
    ManoeuvreRows& run = runs.emplace_back(ManoeuvreRows{.name = name, .dt = kRowEvery, .stretches = {{}}});
    for (const model::FlightMoment& m : model::fly(vehicle, manoeuvre, kRowEvery, [&](double t) {
           return pull[static_cast<std::size_t>(std::lround(100.0 * t))];
         })) {
      const Vector6d tau = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
      ManoeuvreRows::Row row{m.q_WB, m.nu, m.nu_dot, tau + m.umbilical + m.chain, {m.umbilical, m.chain}};
      for (int i = 0; i < 6; ++i) row.known[i] += (i < 3 ? 0.1 : 0.01) * normal(random);
      run.stretches.front().push_back(row);
    }
  }
  return runs;
}

const TracedPull* find(const std::vector<TracedPull>& traced, const std::string& pull, int axis) {
  const auto found = std::find_if(traced.begin(), traced.end(),
                                  [&](const auto& one) { return kPulls[one.pull] == pull && one.axis == axis; });
  return found != traced.end() ? &*found : nullptr;
}

}  // namespace

TEST_CASE("residual tracing: what umbilical and chain leave goes with them, and is gone when they are known") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  const auto traced = trace_pulls(vehicle, pulled(vehicle), {});
  REQUIRE(traced.size() == 12);
  for (const int axis : {1, 5}) {  // sway and yaw: the umbilical is attached astern
    CAPTURE(axis);
    const TracedPull* one = find(traced, "umbilical", axis);
    REQUIRE(one != nullptr);
    CHECK(one->before > 3.0 * one->after);
    CHECK(one->correlation * one->correlation > 0.5);
    CHECK(one->correlation > 0.0);  // b then holds the pull itself
    CHECK(one->phi_before > 0.8);   // a second of memory in rows of 0.1 s is 0.905
    CHECK(std::abs(one->phi_after) < 0.1);
  }
  const TracedPull& yaw = *find(traced, "umbilical", 5);
  REQUIRE(yaw.traces.size() == 3);  // line, zigzag, circle
  double square = 0.0, rows = 0.0;
  for (std::size_t i = 0; i < yaw.traces.size(); ++i) {
    const PullTrace& trace = yaw.traces[i];
    CHECK(trace.run == i);
    CHECK(trace.dt == kRowEvery);
    REQUIRE(trace.before.size() == trace.pull.size());
    REQUIRE(trace.after.size() == trace.pull.size());
    CHECK(trace.after.norm() < 0.5 * trace.before.norm());
    CHECK(trace.before.dot(trace.pull) > 0.5 * trace.before.norm() * trace.pull.norm());
    square += trace.before.squaredNorm();
    rows += static_cast<double>(trace.before.size());
  }
  CHECK(std::sqrt(square / rows) == doctest::Approx(yaw.before));
  const TracedPull* heave = find(traced, "chain", 2);
  REQUIRE(heave != nullptr);
  CHECK(heave->before > 10.0 * heave->after);  // it holds the height
  // Attached on the axis of roll, the umbilical cannot roll the hull, and nothing goes with it.
  const TracedPull* roll = find(traced, "umbilical", 3);
  REQUIRE(roll != nullptr);
  CHECK(roll->before == doctest::Approx(roll->after));
  CHECK(roll->correlation == 0.0);
  CHECK(roll->gained.empty());
}

TEST_CASE("residual tracing: a pull without a cell is not traced") {
  model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  std::erase_if(vehicle.hydrodynamics->load_cells, [](const auto& cell) { return cell.of == "umbilical"; });
  const auto traced = trace_pulls(vehicle, pulled(vehicle), {});
  CHECK(traced.size() == 6);
  CHECK(find(traced, "umbilical", 1) == nullptr);
}

}  // namespace fathom::identification
