// fathom plan: a plan for a vehicle and a site as they are configured, and what bad input prints.
#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Ran;
using test::Scratch;
using test::shell;

std::string plan(const std::string& vehicle, const std::string& site) {
  return program("fathom") + " plan --vehicle " + file("config/vehicles/" + vehicle + ".yaml") + " --site " +
         file("config/sites/" + site + ".yaml");
}

void refused_in_one_line(const Ran& ran, const std::string& words) {
  CAPTURE(ran.text);
  CHECK(ran.code != 0);
  CHECK(ran.says(words));
  // One line, and what was being done until then.
  std::istringstream lines{ran.text};
  int others = 0;
  for (std::string line; std::getline(lines, line);) others += line.find(" % rehearsing") == std::string::npos ? 1 : 0;
  CHECK(others == 1);
}

}  // namespace

TEST_CASE("fathom plan: every effect that can act is answered, in words and as JSON") {
  const Scratch scratch;
  const Ran ran = shell(plan("seabotix_lbv150", "tank") + " --json " + scratch.path("plan.json"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK(ran.says("all modes are done"));
  CHECK(ran.says("the smallest that would be found"));
  std::ifstream in{scratch.path("plan.json")};
  const auto json = nlohmann::json::parse(in);
  std::set<std::string> names;
  int found = 0;
  for (const auto& effect : json.at("effects")) {
    names.insert(effect.at("name").get<std::string>());
    if (!effect.at("found").get<bool>()) continue;
    ++found;
    CHECK(effect.at("hidden_share").get<double>() >= 0.0);
    CHECK(effect.at("hidden_share").get<double>() <= 1.0);
    CHECK_FALSE(effect.at("smallest_size").empty());
  }
  CHECK(names.size() == json.at("effects").size());
  CHECK(names.contains("current"));
  CHECK(found > 15);
}

TEST_CASE("fathom plan: less noise finds smaller effects, as far as they matter") {
  const Scratch scratch;
  const auto smallest = [&](const std::string& noise) {
    const std::string path = scratch.path("plan-" + noise + ".json");
    const Ran ran = shell(plan("seabotix_lbv150", "tank") + " --velocity-noise " + noise + " --rate-noise " + noise +
                          " --json " + path);
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    std::ifstream in{path};
    const auto json = nlohmann::json::parse(in);
    for (const auto& effect : json.at("effects")) {
      if (effect.at("name") == "current") return effect.at("smallest_size").at("v_N").at("value").get<double>();
    }
    return 0.0;
  };
  const double noisy = smallest("0.15"), quiet = smallest("0.05"), silent = smallest("0.005");
  CHECK(quiet > 0.0);
  CHECK(noisy > 1.5 * quiet);
  CHECK(silent == doctest::Approx(quiet).epsilon(0.1));  // what is too small to matter is promised by no silence
}

TEST_CASE("fathom plan: what is missing is said in one line") {
  refused_in_one_line(shell(plan("none", "tank")), "none.yaml");
  refused_in_one_line(shell(plan("seabotix_lbv150", "tank_tag16h5")), "water");
  refused_in_one_line(shell(plan("seabotix_lbv150", "tank") + " --excitation loud"), "loud");
  refused_in_one_line(shell(plan("seabotix_lbv150", "tank") + " --longest 3"), "ends as soon as it begins");
  refused_in_one_line(shell(plan("seabotix_lbv150", "tank") + " --json /nowhere/plan.json"), "/nowhere/plan.json");
}

}  // namespace fathom
