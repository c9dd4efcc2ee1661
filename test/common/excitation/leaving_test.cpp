// A mode is left when metric, residual and physics agree, and otherwise it is said which of them does not.
#include "common/excitation/leaving.hpp"

#include <doctest/doctest.h>

#include "common/model/vehicle.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::excitation {
namespace {

const Mode kSurge{.name = "surge", .axis = 0, .threshold = 0.25};

ModelEstimate good() {
  ModelEstimate model;
  model.parameters = {{"m_X", 9.8, 0.1, "kg"}, {"X_u", -8.6, 0.1, "N/(m/s)"}, {"X_u|u|", -17.9, 0.2, "N/(m/s)^2"}};
  model.modes = {{"surge", 0.2, 0.02}, {"total", 0.9, 0.3}};
  model.residual_ratio.setConstant(0.9);
  return model;
}

std::string missing(const ModelEstimate& model) {
  const auto verdict = may_leave(kSurge, model, test::vehicle_from_repository("seabotix_lbv150"), {});
  std::string all;
  for (const std::string& one : verdict.missing) all += one + ";";
  return all;
}

}  // namespace

TEST_CASE("leaving: all three agree") { CHECK(missing(good()).empty()); }

TEST_CASE("leaving: each of the three can keep the mode, and says so") {
  ModelEstimate unsure = good();
  unsure.modes[0].sum = 0.4;
  CHECK(missing(unsure) == "sum of variances 0.4, needed 0.25;");
  ModelEstimate wrong = good();
  wrong.residual_ratio[0] = 12.0;
  CHECK(missing(wrong) == "residual on X has 12 times the noise's power;");
  ModelEstimate pulled = good();
  pulled.residual_mean[0] = -7.0;
  CHECK(missing(pulled) == "residual on X is one-sided (-7 sigma);");
  ModelEstimate light = good();
  light.parameters[0].value = 1.0;
  CHECK(missing(light).find("m_X = 1 does not suit a dry 11") == 0);
  ModelEstimate driven = good();
  driven.parameters[1].value = 2.0;
  driven.parameters[2].value = -1.0;
  CHECK(missing(driven) == "X_u and X_u|u| together do not brake;");
  ModelEstimate silent = good();
  silent.residual_ratio.setZero();
  CHECK(missing(silent) == "no residual on X yet;");
  CHECK(missing(ModelEstimate{}) == "MODEL says nothing of this mode;");
}

TEST_CASE("leaving: a residual on another axis is that axis's business, but not in the last mode") {
  ModelEstimate other = good();
  other.residual_ratio[2] = 50.0;
  CHECK(missing(other).empty());
  const auto total = may_leave({.name = "total", .axis = -1, .threshold = 1.0}, other,
                               test::vehicle_from_repository("seabotix_lbv150"), {});
  CHECK_FALSE(total.missing.empty());
}

TEST_CASE("leaving: the parameters of a mode are those of its axis, W-B with heave") {
  const auto vehicle = test::vehicle_from_repository("seabotix_lbv150");
  CHECK(parameters_of(kSurge, vehicle) == std::vector<std::string>{"m_X", "X_u", "X_u|u|"});
  CHECK(parameters_of({.name = "heave", .axis = 2}, vehicle).size() == 4);
  CHECK(parameters_of({.name = "total", .axis = -1}, vehicle).size() == 13);
}

}  // namespace fathom::excitation
