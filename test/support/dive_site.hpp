// A simulator from the repository's files, with single lines of its settings changed.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/config.hpp"
#include "common/model/site.hpp"
#include "common/simulation/simulator.hpp"
#include "test/support/scratch.hpp"

namespace fathom::test {

inline model::Vehicle vehicle_of_file(const std::string& name) {
  return model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/" + name + ".yaml");
}
inline model::Site site_of_file(const std::string& name) {
  return model::Site::load(std::string{FATHOM_SOURCE_DIR} + "/config/sites/" + name + ".yaml");
}

/// Text pieces to find in config/simulation/NAME.yaml and what to put in their place (first occurrence).
using Changes = std::vector<std::pair<std::string, std::string>>;

inline std::string simulation_text(const std::string& name, const Changes& changes) {
  std::string text = read_bytes(std::string{FATHOM_SOURCE_DIR} + "/config/simulation/" + name + ".yaml");
  for (const auto& change : changes) {
    const auto at = text.find(change.first);
    REQUIRE_MESSAGE(at != std::string::npos, change.first);
    text.replace(at, change.first.size(), change.second);
  }
  return text;
}

inline std::unique_ptr<simulation::Simulator> make_simulator(const std::string& vehicle, const std::string& site,
                                                             const simulation::Setup& setup,
                                                             const Changes& changes = {}) {
  const Config config = Config::parse(simulation_text(vehicle, changes), vehicle + ".yaml");
  auto simulator = std::make_unique<simulation::Simulator>(vehicle_of_file(vehicle), site_of_file(site),
                                                           config.section("simulator"), setup);
  config.finish();
  return simulator;
}

/// One stream of a run.
template <class Wanted>
void collect(const std::vector<simulation::Sample>& samples, std::vector<Wanted>& into) {
  for (const simulation::Sample& sample : samples) {
    if (const auto* one = std::get_if<Wanted>(&sample)) into.push_back(*one);
  }
}

/// Runs for so many seconds with one wrench and collects a stream.
template <class Wanted>
std::vector<Wanted> run(simulation::Simulator& simulator, double seconds, const Vector6d& tau = Vector6d::Zero()) {
  std::vector<Wanted> found;
  const Utime end = utime_after(simulator.now(), seconds);
  while (simulator.now() < end) {
    simulator.command({.utime = simulator.now(), .tau = tau, .life = 1.0});
    collect(simulator.step(), found);
  }
  return found;
}

}  // namespace fathom::test
