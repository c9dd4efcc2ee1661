// The whole experiment in the tank of the paper, closed with a small plant and the recursive identifier.
#include <doctest/doctest.h>

#include <sstream>

#include "test/common/excitation/tank_run.hpp"

namespace fathom {
namespace {

using test::tank_run;
using test::tank_settings;
using test::TankRun;

std::string table(const TankRun& run) {
  std::ostringstream text;
  text << run.reason << "; ended " << run.ended << " s, least room " << run.least_room << " m, bent " << run.bent_share
       << ", 5 % by information at " << run.time_to_five_percent << " s\n";
  for (const auto& v : run.visits)
    text << "  " << v.mode << " " << v.begun << " to " << v.ended << (v.left ? " left" : " given up: ") << v.missing
         << "\n";
  for (const auto& p : run.model.parameters) text << "  " << p.name << " " << p.value << " +- " << p.std << "\n";
  return text.str();
}

double true_value(const test::TankSettings& settings, const std::string& name) {
  for (std::size_t i = 0; i < settings.vehicle.parameters.size(); ++i) {
    if (settings.vehicle.parameters[i] == name) return settings.vehicle.priors[i].mean;  // what the plant is made of
  }
  return 0.0;
}

}  // namespace

TEST_CASE("closed loop: the paper's schedule, from nothing to its thresholds, without touching a wall") {
  const auto settings = tank_settings();
  double ended = 0.0, covered = 0.0, parameters = 0.0;
  constexpr int kSeeds = 5;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const TankRun run = tank_run(settings, {.seed = seed});
    CAPTURE(table(run));
    CHECK(run.phase == excitation::Phase::kDone);
    CHECK(run.least_room > 0.05);  // m between the hull's corners and the nearest wall, floor or surface
    REQUIRE(run.visits.size() == 5);
    for (const auto& visit : run.visits) CHECK(visit.left);
    // Each mode moves its own axis and holds the others.
    CHECK(run.rms_by_mode.at("yaw")[5] > 0.1);
    CHECK(run.rms_by_mode.at("surge")[0] > 0.2);
    CHECK(run.rms_by_mode.at("sway")[1] > 0.2);
    CHECK(run.rms_by_mode.at("heave")[2] > 0.1);
    for (const int axis : {0, 1, 2, 5}) CHECK(run.rms_by_mode.at("total")[axis] > 0.1);
    CHECK(run.rms_by_mode.at("surge").segment<2>(1).maxCoeff() < 0.02);
    CHECK(run.rms_by_mode.at("yaw").head<3>().maxCoeff() < 0.02);
    for (const char* mode : {"yaw", "surge", "sway"})
      CHECK(run.drift_by_mode.at(mode) < 0.2);  // m; unheld it floats up
    for (const NamedValue& p : run.model.parameters) {
      const double truth = true_value(settings, p.name);
      parameters += 1.0;
      covered += std::abs(p.value - truth) < 1.96 * p.std ? 1.0 : 0.0;
      if (test::revealed(p.name)) CHECK(std::abs(p.value - truth) < 0.05 * std::abs(truth));
    }
    ended += run.ended / kSeeds;
  }
  MESSAGE("mean time to the paper's P*: " << ended << " s (the paper: about 330 s); 95 % intervals cover "
                                          << 100.0 * covered / parameters << " %");
  CHECK(ended > 230.0);
  CHECK(ended < 430.0);
  CHECK(covered / parameters > 0.8);  // 65 intervals
}

TEST_CASE("closed loop: designed segments are several times quicker than the schedule, by information and by error") {
  // White noise of 0.36 N and 0.08 N m per 10 ms: a tenth of the paper's R_tau, what good sensors leave.
  const test::TankHooks hooks{.limit = 202.0, .noise_share = 0.1};
  double paper = 0.0, optimal = 0.0, ended = 0.0;
  constexpr int kSeeds = 3;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const TankRun schedule = tank_run(tank_settings(), {.seed = seed}, hooks);
    auto settings = tank_settings(true);
    settings.supervisor.most_dwell = 300.0;
    const TankRun designed = tank_run(settings, {.seed = seed}, hooks);
    CAPTURE(table(designed));
    CHECK(designed.least_room > 0.03);
    paper += schedule.time_to_five_percent / kSeeds;
    optimal += designed.time_to_five_percent / kSeeds;
    // The sum of variances at which the schedule ends after some 340 s.
    CHECK(designed.phase == excitation::Phase::kDone);
    ended += designed.ended / kSeeds;
  }
  MESSAGE("5 % on the ten well revealed parameters by information: schedule "
          << paper << " s, designed " << optimal << " s; all thirteen as sure as the schedule's end after " << ended
          << " s");
  CHECK(ended < 200.0);
  CHECK(paper < 60.0);
  CHECK(optimal < 15.0);
  CHECK(optimal < paper / 2.5);
}

TEST_CASE("closed loop: after thirty designed seconds the ten well revealed parameters are nearly known") {
  const auto settings = tank_settings(true);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const TankRun run = tank_run(settings, {.seed = seed}, {.limit = 31.0});
    CAPTURE(table(run));
    for (const NamedValue& p : run.model.parameters) {
      if (test::revealed(p.name)) CHECK(std::abs(p.value / true_value(settings, p.name) - 1.0) < 0.1);
    }
  }
}

TEST_CASE("closed loop: a taut tether that nobody declared keeps the modes from being left, and is said") {
  auto settings = tank_settings();
  settings.supervisor.most_dwell = 60.0;
  settings.supervisor.retries = 0;
  // A spring of 4 N/m toward the tank's south end.
  const TankRun run =
      tank_run(settings, {.effects = {test::active("tether_tension", {4.0, 0.2, -2.5, 0.0, 1.0})}}, {.limit = 400.0});
  CAPTURE(table(run));
  bool said = false;
  for (const auto& visit : run.visits) {
    if (visit.mode == "surge") CHECK_FALSE(visit.left);
    said = said || visit.missing.find("residual on X") != std::string::npos;
  }
  CHECK(said);
  CHECK(run.least_room > 0.0);
}

}  // namespace fathom
