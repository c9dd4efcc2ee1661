#include "common/report/correction_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/model/learned/factors/factor_kind.hpp"
#include "common/model/learned/told.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

using model::Factor;
using model::Feature;
using model::FeatureState;
using model::Quantity;

constexpr int kPoints = 61;
constexpr double kInside = 0.95;  // of what was visited: no picture shows how it fades
constexpr int kWidth = 360, kHeight = 220;
constexpr std::size_t kTitleFits = 52;          // letters of the usual size
constexpr int kTitleFont = 12, kLeastFont = 8;  // points

/// What a feature reads: a state's number, and the range to be shown.
struct Argument {
  std::string name, unit;
  double low{}, high{};
  int order{};  // of arguments that are alike
  void (*set)(FeatureState&, int index, double x){};
  int index{};
  bool operator<(const Argument& other) const { return name < other.name; }
};

void set_nu(FeatureState& s, int i, double x) { s.nu[i] = x; }
void set_speed(FeatureState& s, int, double x) { s.nu.head<3>() = Eigen::Vector3d{x, 0.0, 0.0}; }
void set_tau(FeatureState& s, int i, double x) { s.tau[i] = x; }
void set_force(FeatureState& s, int i, double x) { s.force[i] = x; }
void set_place(FeatureState& s, int i, double x) { s.p_WB[i] = x; }
void set_time(FeatureState& s, int, double x) { s.t = x; }
void set_voltage(FeatureState& s, int, double x) { s.voltage = x; }
void set_heading(FeatureState& s, int, double x) {
  s.heading_cosine = std::cos(x);
  s.heading_sine = std::sin(x);
}

std::optional<Argument> argument_of(const Factor& f, const CorrectionGiven& given) {
  const auto index = static_cast<std::size_t>(f.index);
  const auto nu = [&](std::size_t i) { return kInside * given.visited_nu[i]; };
  switch (f.quantity) {
    case Quantity::kVelocity:
    case Quantity::kSpeed:
    case Quantity::kPowerOdd:
    case Quantity::kPowerEven:
      return Argument{.name = model::kNuNames[index],
                      .unit = index < 3 ? "m/s" : "rad/s",
                      .low = -nu(index),
                      .high = nu(index),
                      .set = set_nu,
                      .index = f.index};
    case Quantity::kFlowSpeed:
      return Argument{.name = "U", .unit = "m/s", .high = std::hypot(nu(0), nu(1), nu(2)), .set = set_speed};
    case Quantity::kWrench:
    case Quantity::kWrenchSize:
      return Argument{.name = std::string{"tau_"} + model::kTauNames[index],
                      .unit = index < 3 ? "N" : "N m",
                      .low = -kInside * given.visited_tau[index],
                      .high = kInside * given.visited_tau[index],
                      .set = set_tau,
                      .index = f.index};
    case Quantity::kThruster:
    case Quantity::kThrusterSize:
    case Quantity::kThrusterRoot:
    case Quantity::kThrustKnot:
    case Quantity::kThrustBelow:
    case Quantity::kThrustHeld: {
      const double most = index < given.visited_force.size() ? kInside * given.visited_force[index] : 1.0;
      return Argument{.name = "f_" + std::to_string(index + 1),
                      .unit = "N",
                      .low = -most,
                      .high = most,
                      .set = set_force,
                      .index = f.index};
    }
    case Quantity::kAdvance:
    case Quantity::kAdvanceSize:
      return Argument{
          .name = "u_a", .unit = "m/s", .low = -nu(0), .high = nu(0), .set = set_nu};  // a thruster that points ahead
    case Quantity::kDepthBump:
    case Quantity::kDepth:
      return Argument{.name = "z",
                      .unit = "m",
                      .low = given.visited_low[2],
                      .high = given.visited_high[2],
                      .set = set_place,
                      .index = 2};
    case Quantity::kNear: {  // along the axis that it lies closest to
      constexpr std::array kPlaces{"x", "y", "z"};
      std::size_t axis = 2;
      if (f.index == 0) axis = std::abs(std::sin(f.c)) > std::abs(std::cos(f.c)) ? 1 : 0;
      return Argument{.name = kPlaces[axis],
                      .unit = "m",
                      .low = given.visited_low[axis],
                      .high = given.visited_high[axis],
                      .set = set_place,
                      .index = static_cast<int>(axis)};
    }
    case Quantity::kNorth:
    case Quantity::kStretch:
    case Quantity::kPlanStretch:
    case Quantity::kPlanBump:
      return Argument{.name = "x",
                      .unit = "m",
                      .low = given.visited_low[0],
                      .high = given.visited_high[0],
                      .set = set_place,
                      .index = 0};
    case Quantity::kEast:
      return Argument{.name = "y",
                      .unit = "m",
                      .low = given.visited_low[1],
                      .high = given.visited_high[1],
                      .set = set_place,
                      .index = 1};
    case Quantity::kHeadingCosine:
    case Quantity::kHeadingSine:
      return Argument{.name = "psi", .unit = "rad", .low = -M_PI, .high = M_PI, .set = set_heading};
    case Quantity::kRamp:
      return Argument{.name = "t", .unit = "s", .low = f.a - f.b, .high = f.a + f.b, .set = set_time};
    case Quantity::kSettling:
      return Argument{
          .name = "t", .unit = "s", .low = f.a, .high = f.a + (f.c - f.a) / model::kLawReach, .set = set_time};
    case Quantity::kVoltage:
      return Argument{
          .name = "V", .unit = "V", .low = f.a * (1.0 - f.c), .high = f.a * (1.0 + f.c), .set = set_voltage};
    case Quantity::kAfter:
      return Argument{
          .name = "t", .unit = "s", .low = f.a - 10.0 - 2.0 * f.b, .high = f.a + 10.0 + 2.0 * f.b, .set = set_time};
    case Quantity::kToneCosine:
    case Quantity::kToneSine:
    case Quantity::kTravelCosine:
    case Quantity::kTravelSine:
      return Argument{.name = "t", .unit = "s", .high = 4.0 * M_PI / std::max(f.a, 1e-3), .set = set_time};
    default:  // low passes: a curve over them says nothing
      return std::nullopt;
  }
}

/// Every thruster's line points ahead, so that its advance is u.
FeatureState middle_of(const CorrectionGiven& given, const model::Allocation& ahead) {
  FeatureState state;
  state.allocation = &ahead;
  state.force.setZero(static_cast<Eigen::Index>(given.visited_force.size()));
  for (std::size_t i = 0; i < given.visited_force.size(); ++i)
    state.force[static_cast<Eigen::Index>(i)] = 0.5 * given.visited_force[i];
  for (Eigen::Index i = 0; i < 6; ++i) {
    state.nu[i] = 0.5 * given.visited_nu[static_cast<std::size_t>(i)];
    state.tau[i] = 0.5 * given.visited_tau[static_cast<std::size_t>(i)];
  }
  for (Eigen::Index i = 0; i < 3; ++i)
    state.p_WB[i] =
        0.5 * (given.visited_low[static_cast<std::size_t>(i)] + given.visited_high[static_cast<std::size_t>(i)]);
  return state;
}

std::string data(const std::string& name, const std::vector<std::vector<double>>& columns) {
  std::string text = "$" + name + " << EOD\n";
  for (std::size_t k = 0; k < columns.front().size(); ++k) {
    for (const auto& column : columns) text += plain(column[k]) + " ";
    text += "\n";
  }
  return text + "EOD\n";
}

/// With measured columns one spread above their means.
Feature beside_columns(Feature feature) {
  const auto end = feature.factors.begin() + feature.count;
  const auto kept = std::remove_if(feature.factors.begin(), end, [](const model::Factor& factor) {
    return factor.quantity == model::Quantity::kColumn;
  });
  feature.count = static_cast<int>(kept - feature.factors.begin());
  return feature;
}

}  // namespace

std::vector<CorrectionCurve> correction_curves(const CorrectionGiven& given) {
  std::vector<CorrectionCurve> curves;
  const model::Allocation ahead = Vector6d::Unit(0).replicate(1, static_cast<Eigen::Index>(given.visited_force.size()));
  std::size_t first = 0;
  while (first < given.terms.size()) {
    std::size_t last = first;
    std::vector<Feature> features;
    for (; last < given.terms.size() && given.terms[last].group == given.terms[first].group &&
           given.terms[last].axis == given.terms[first].axis;
         ++last) {
      if (const auto feature = model::feature_of(given.terms[last])) features.push_back(beside_columns(*feature));
    }
    std::set<Argument> arguments;
    for (const Feature& feature : features) {
      for (int i = 0; i < feature.count; ++i) {
        auto argument = argument_of(feature.factors[static_cast<std::size_t>(i)], given);
        if (!argument || !(argument->high > argument->low)) continue;
        const auto [place, fresh] = arguments.insert(*argument);
        if (fresh || argument->name != "t") continue;
        Argument wider = *place;  // steps side by side
        wider.low = std::min(wider.low, argument->low);
        wider.high = std::max(wider.high, argument->high);
        arguments.erase(place);
        arguments.insert(wider);
      }
    }
    if (features.size() == last - first) {
      for (const Argument& argument : arguments) {
        CorrectionCurve curve{
            .title = given.terms[first].group + ", along " + model::direction_words(given.terms[first].axis),
            .argument = argument.name,
            .unit = argument.unit};
        FeatureState state = middle_of(given, ahead);
        for (const Argument& other : arguments) {  // times after all that has happened
          if (other.name == "t") state.t = other.high;
        }
        for (int k = 0; k < kPoints; ++k) {
          const double x = argument.low + (argument.high - argument.low) * k / (kPoints - 1);
          argument.set(state, argument.index, x);
          double force = 0.0, variance = 0.0;
          std::vector<double> phi;
          for (std::size_t j = 0; j < features.size(); ++j) {
            phi.push_back(features[j].value(state));
            force += phi.back() * given.terms[first + j].weight;
          }
          for (std::size_t i = 0; i < phi.size(); ++i) {
            for (std::size_t j = 0; j < phi.size(); ++j) {
              if (first + i < given.covariance.size() && first + j < given.covariance[first + i].size())
                variance += phi[i] * given.covariance[first + i][first + j] * phi[j];
            }
          }
          curve.x.push_back(x);
          curve.force.push_back(force);
          curve.sigma.push_back(std::sqrt(std::max(variance, 0.0)));
        }
        curves.push_back(std::move(curve));
      }
    }
    first = last;
  }
  return curves;
}

Figure draw_correction(const CorrectionCurve& curve, const std::vector<double>& truth) {
  Figure figure{.alt = curve.title + " over " + curve.argument, .width = kWidth, .height = kHeight};
  std::vector<double> low, high;
  for (std::size_t k = 0; k < curve.x.size(); ++k) {
    low.push_back(curve.force[k] - 1.96 * curve.sigma[k]);
    high.push_back(curve.force[k] + 1.96 * curve.sigma[k]);
  }
  figure.script = data("band", {curve.x, low, high}) + data("force", {curve.x, curve.force});
  if (!truth.empty()) figure.script += data("truth", {curve.x, truth});
  const int smaller = static_cast<int>(kTitleFont * kTitleFits / std::max(curve.title.size(), kTitleFits));
  figure.script += "set label 100 " + quoted(curve.title) + " at graph 0, graph 1 left offset -4, 0.8 font '," +
                   std::to_string(std::max(smaller, kLeastFont)) + "' textcolor rgb '#22262b'\nset xlabel " +
                   quoted(curve.argument + " [" + curve.unit + "]") +
                   " offset 0, 0.6 textcolor rgb '#22262b'\nset xrange [" + plain(curve.x.front()) + ":" +
                   plain(curve.x.back()) +
                   "]\nset xtics autofreq\nset ytics autofreq\nset xzeroaxis lt 1 lc rgb '#b8bec7' lw 1\n"
                   "plot $band u 1:2:3 w filledcurves lc rgb '#cfe0ef', $force w l lc rgb '#0a5ea8' lw 1.8" +
                   (truth.empty() ? "" : ", $truth w l dt 2 lc rgb '#22262b' lw 1.4") + "\n";
  return figure;
}

}  // namespace fathom::report
