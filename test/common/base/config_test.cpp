#include "common/base/config.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <string>

#include "common/base/error.hpp"

using fathom::Config;
using fathom::InputError;

namespace {

constexpr double kRounding = 1e-14;  // one multiplication

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

std::string message_of(const std::string& yaml, const std::function<void(const Config&)>& use) {
  return message([&] { use(Config::parse(yaml, "v.yaml")); });
}

}  // namespace

TEST_CASE("config: quantities are converted to the unit that the reader asks for") {
  const Config config = Config::parse(
      "mass: 11500 g\nposition: 10 -5 0 cm\naxis: [0.6, 0, 0.8]\nquoted: \"[1, 2, 3] mm\"\n"
      "each: [1 m, 20 cm, 3 mm]\nratio: 0.25\ncount: 3\non: true\nwords: [a, b]\nlong: 1 2\n  3 4 N\n",
      "v.yaml");
  CHECK(config.quantity("mass", "kg") == doctest::Approx(11.5).epsilon(kRounding));
  CHECK(config.vector3("position", "m").isApprox(Eigen::Vector3d(0.1, -0.05, 0.0), kRounding));
  CHECK(config.vector3("axis", "").isApprox(Eigen::Vector3d(0.6, 0.0, 0.8), kRounding));
  CHECK(config.vector3("quoted", "m").isApprox(Eigen::Vector3d(0.001, 0.002, 0.003), kRounding));
  CHECK(config.vector3("each", "m").isApprox(Eigen::Vector3d(1.0, 0.2, 0.003), kRounding));
  CHECK(config.quantity("ratio", "") == 0.25);
  CHECK(config.integer("count") == 3);
  CHECK(config.flag("on"));
  CHECK(config.texts("words") == std::vector<std::string>{"a", "b"});
  CHECK(config.quantities("long", "N") == std::vector<double>{1.0, 2.0, 3.0, 4.0});
  CHECK_NOTHROW(config.finish());
}

TEST_CASE("config: sections and lists of sections are read and know where they stand") {
  const Config config = Config::parse("thrusters:\n  - name: bow\n  - name: stern\nwater:\n  depth: 2 m\n", "v.yaml");
  const auto thrusters = config.list("thrusters");
  REQUIRE(thrusters.size() == 2);
  CHECK(thrusters[1].text("name") == "stern");
  CHECK(thrusters[1].where("name") == "v.yaml:3");
  CHECK(thrusters[0].text("name") == "bow");
  CHECK(config.section("water").quantity("depth", "m") == 2.0);
  CHECK(config.where("water") == "v.yaml:4");
  CHECK(config.is_section("water"));
  CHECK_FALSE(config.is_section("thrusters"));
  CHECK_FALSE(config.has("air"));
  CHECK(config.keys() == std::vector<std::string>{"thrusters", "water"});
  CHECK_NOTHROW(config.finish());
}

TEST_CASE("config: complaints are one line that names file, line and remedy") {
  const auto mass = [](const Config& config) { static_cast<void>(config.quantity("mass", "kg")); };
  CHECK(message_of("a: 1\nmass: 3 m\n", mass) == "v.yaml:2: 'mass': unit 'm' does not fit: expected 'kg'");
  CHECK(message_of("a: 1\nmass: 3\n", mass) == "v.yaml:2: 'mass': the unit is missing: expected 'kg'");
  CHECK(message_of("a: 1\nmass: heavy\n", mass) == "v.yaml:2: 'mass' must begin with a number in kg, not 'heavy'");
  CHECK(message_of("mass: nan kg\n", mass) == "v.yaml:1: 'mass' must be finite, not 'nan kg'");
  CHECK(message_of("mass: .inf\n", mass).rfind("v.yaml:1: ", 0) == 0);
  CHECK(message_of("mass: 1e999 kg\n", mass).rfind("v.yaml:1: ", 0) == 0);
  CHECK(message_of("mass: 1e308 (kg kg kg)/(g g)\n", mass) ==
        "v.yaml:1: 'mass' must be finite, not '1e308 (kg kg kg)/(g g)'");
  CHECK(message_of("mass: 1 2 kg\n", mass) == "v.yaml:1: 'mass' must be one number, not 2");
  CHECK(message_of("mass:\n", mass) == "v.yaml:1: 'mass' must be a number in kg");
  CHECK(message_of("a: 1\n", mass) == "v.yaml:1: key 'mass' is missing");
  CHECK(message_of("a: 1\nmas: 3 kg\n", mass) == "v.yaml:2: unknown key 'mas'; did you mean 'mass'?");
  CHECK(message_of("mass: 3 kg\nb: 2\nmass: 4 kg\n", mass) ==
        "v.yaml:3: key 'mass' stands here twice (first in line 1)");
  CHECK(message_of("mass: [1, 2\n", mass).rfind("v.yaml:2: not valid YAML: ", 0) == 0);
  CHECK(message_of("mass: 1 kg\n---\nmass: 2 kg\n", mass) ==
        "v.yaml:2: text that does not belong to the document above ('---', or a bracket too many)");
  CHECK(message_of("---\nmass: 1 kg\n...\n", mass) == "no complaint");
  CHECK(message_of("mass: 1 kg\n]\n", mass).rfind("v.yaml:", 0) == 0);
  CHECK(message_of("mass: [1, 2]]\nb: 3\n", mass).rfind("v.yaml:", 0) == 0);
  CHECK(message_of("", mass) == "v.yaml:1: the file is empty");
  CHECK(message_of("- 1\n", mass) == "v.yaml:1: expected 'key: value' lines");
  CHECK(message_of("a: &x [*x]\n", mass).rfind("v.yaml:", 0) == 0);
  CHECK(message([] { static_cast<void>(Config::load("/nowhere/v.yaml")); }) ==
        "/nowhere/v.yaml: cannot read this configuration file");
  CHECK(message([] { static_cast<void>(Config::load("/tmp")); }) == "/tmp: cannot read this configuration file");
}

TEST_CASE("config: a key that nobody read is refused, below too, with the nearest known key") {
  const auto finish = [](const Config& config) {
    static_cast<void>(config.quantity("mass", "kg"));
    if (config.has("buoyancy")) static_cast<void>(config.quantity("buoyancy", "N"));
    if (config.has("water")) static_cast<void>(config.section("water").has("density"));
    config.finish();
  };
  CHECK(message_of("mass: 1 kg\nbouyancy: 2 N\n", finish) ==
        "v.yaml:2: unknown key 'bouyancy'; did you mean 'buoyancy'?");
  CHECK(message_of("mass: 1 kg\ncolour: red\n", finish) == "v.yaml:2: unknown key 'colour'");
  CHECK(message_of("mass: 1 kg\nwater:\n  densty: 3\n", finish) ==
        "v.yaml:3: unknown key 'densty' in 'water'; did you mean 'density'?");
  CHECK(message_of("mass: 1 kg\nbuoyancy: 2 N\n", finish) == "no complaint");
}

TEST_CASE("config: a misspelt key is named before what follows from its absence") {
  // The reader of an optional key learns of its absence from has(), and then complains of something else.
  const auto vehicle = [](const Config& config) {
    if (!config.has("mass")) config.fail("mass", "state the 'mass', or a prior for every parameter");
    if (!config.has("dof")) config.fail("", "nothing may move");
    static_cast<void>(config.texts("dof"));
    static_cast<void>(config.quantity("mass", "kg"));
    config.finish();
  };
  CHECK(message_of("name: a\nmas: 10 kg\ndof: [yaw]\n", vehicle) ==
        "v.yaml:2: unknown key 'mas'; did you mean 'mass'?");
  CHECK(message_of("dof: [yaw]\nMass: 10 kg\n", vehicle) == "v.yaml:2: unknown key 'Mass'; did you mean 'mass'?");
  CHECK(message_of("mass: 10 kg\ndfo: [yaw]\n", vehicle) == "v.yaml:2: unknown key 'dfo'; did you mean 'dof'?");
  CHECK(message_of("name: a\ndof: [yaw]\n", vehicle) == "v.yaml:1: state the 'mass', or a prior for every parameter");
  // A complaint of a value stands when no key looks like an absent one.
  CHECK(message_of("mass: 10 m\ndof: [yaw]\ncolour: red\n", vehicle).rfind("v.yaml:1: 'mass': unit 'm'", 0) == 0);
  // Short keys that differ are other keys.
  CHECK(message_of("Y: 1\n", [](const Config& config) { static_cast<void>(config.quantity("X", "")); }) ==
        "v.yaml:1: key 'X' is missing");
  CHECK(message_of("gap-max: 1 s\n", [](const Config& config) {
          static_cast<void>(config.quantity("gap_max", "s"));
        }) == "v.yaml:1: unknown key 'gap-max'; did you mean 'gap_max'?");
}

TEST_CASE("config: signs and choices are checked where they are read") {
  const auto positive = [](const Config& config) { static_cast<void>(config.positive("x", "m")); };
  const auto not_negative = [](const Config& config) { static_cast<void>(config.not_negative("x", "m")); };
  CHECK(Config::parse("x: 2 m\n", "v.yaml").positive("x", "m") == 2.0);
  CHECK(Config::parse("x: 0 m\n", "v.yaml").not_negative("x", "m") == 0.0);
  CHECK(message_of("x: 0 m\n", positive) == "v.yaml:1: 'x' must be positive");
  CHECK(message_of("x: -1 m\n", not_negative) == "v.yaml:1: 'x' must not be negative");
  const auto input = [](const Config& config) { static_cast<void>(config.either("input", "linear", "hold")); };
  CHECK(Config::parse("input: linear\n", "v.yaml").either("input", "linear", "hold"));
  CHECK_FALSE(Config::parse("input: hold\n", "v.yaml").either("input", "linear", "hold"));
  CHECK(message_of("input: held\n", input) == "v.yaml:1: 'input' must be linear or hold, not 'held'");
}
