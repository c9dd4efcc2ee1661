// Physics: w = c (x - x_0) y along an axis, or each of them: x the product of the candidate's measured columns, y that
// of its velocities and thrusts, c one number per axis of the body, of the world's north and east, or along a measured
// bearing. x_0 is 0, or the columns' mean: where a column hardly changes, the force that it would be by itself is a
// steady one, and belongs to those. Prior: kSize of the applied wrench, as for free forces, with the tails of all
// effects. Ignores: that a column is late.
#include "common/model/candidates/column_effect.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/brief_number.hpp"
#include "common/base/error.hpp"
#include "common/model/rollout.hpp"

namespace fathom::model {
namespace {

constexpr double kSize = 0.1;  // of the applied wrench: an ordinary force
/// Least spread over mean of a column that is taken from zero: below, what it would do by itself and a constant are
/// alike but for 4 % of their square.
constexpr double kLeastSpread = 0.2;
constexpr double kConstant = 1e-6;  // of its mean: rounding
constexpr double kLeastPart = 0.1;  // of all of the thrust: what an axis that is not driven may feel

enum Number : std::size_t { kNorth = 6, kEast = 7, kAlong = 8, kNumbers = 9 };
constexpr std::array<const char*, kNumbers> kNumberNames{"c_X", "c_Y",     "c_Z",    "c_K",    "c_M",
                                                         "c_N", "c_north", "c_east", "c_along"};

/// What forms evaluate.
struct Law {
  Candidate candidate;
  std::size_t place{};  // among the vehicle's candidates
  Allocation allocation;

  [[nodiscard]] double of_model(const Motion& motion) const {
    double product = 1.0;
    for (const Candidate::Power& one : candidate.model) {
      double x = 0.0;
      if (one.name == "U") {
        x = motion.nu.head<3>().norm();
      } else if (one.name.starts_with("tau_")) {
        const auto axis = std::ranges::find(kAxisNames, one.name.substr(4)) - kAxisNames.begin();
        x = allocation.row(axis) * motion.force;
      } else {
        x = motion.nu[std::ranges::find(kVelocityNames, one.name) - kVelocityNames.begin()];
      }
      if (one.size) x = std::abs(x);
      for (int k = 0; k < one.power; ++k) product *= x;
    }
    return product;
  }
};

class GoesWith final : public Form {
 public:
  GoesWith(std::shared_ptr<const Law> law, std::string name, std::vector<std::size_t> numbers, double from,
           std::vector<double> start, FormTraits traits)
      : Form{traits},
        law_{std::move(law)},
        name_{std::move(name)},
        numbers_{std::move(numbers)},
        from_{from},
        start_{std::move(start)} {}

  FormName name(const Scene&) const override { return name_; }
  Starts starts(const Scene&) const override { return {start_}; }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const std::size_t at = 2 * law_->place;
    if (motion.columns.size() < at + 2) return;  // it was not measured: no simulator knows it
    const double size = (motion.columns[at] - from_) * law_->of_model(motion), bearing = motion.columns[at + 1];
    Eigen::Vector3d f_W = Eigen::Vector3d::Zero();
    for (const std::size_t number : numbers_) {
      const double force = theta[number] * size;
      if (number < kNorth) load.wrench[static_cast<Eigen::Index>(number)] += force;
      if (number == kNorth) f_W.x() += force;
      if (number == kEast) f_W.y() += force;
      if (number == kAlong) f_W += force * Eigen::Vector3d{std::cos(bearing), std::sin(bearing), 0.0};
    }
    load.wrench.head<3>() += motion.R_WB.transpose() * f_W;
  }

 private:
  std::shared_ptr<const Law> law_;
  std::string name_;
  std::vector<std::size_t> numbers_;
  double from_;
  std::vector<double> start_;
};

/// Names that outlive the effect whose parts point to them.
struct Words {
  std::string name, sentence;
  std::array<std::string, kNumbers> units;
};

class ColumnEffect final : private Words, public Effect {
 public:
  ColumnEffect(Words words, const std::array<double, kNumbers>& sigma, Forms forms)
      : Words{std::move(words)},
        Effect{{.name = Words::name,
                .sentence = Words::sentence,
                .revealed_by = kShowsColumn,
                .stage = Stage::kBody,
                .amplitudes = kNumbers,
                .knows_size = true,
                .feels_motion = false},
               numbers_with(units, sigma),
               std::move(forms)} {}

 private:
  static std::vector<EffectParameter> numbers_with(const std::array<std::string, kNumbers>& units,
                                                   const std::array<double, kNumbers>& sigma) {
    std::vector<EffectParameter> all;
    for (std::size_t i = 0; i < kNumbers; ++i)
      all.push_back({.name = kNumberNames[i], .unit = units[i], .sigma = sigma[i]});
    return all;
  }
};

/// Of what a candidate is on recordings.
struct Shown {
  double mean{}, spread{};         ///< of the product of its columns
  double rms[2]{};                 ///< of all of it: from zero, about the mean
  Vector6d tau{Vector6d::Zero()};  ///< rms of what is applied, N, N m
  bool attitude{};
};

Shown shown_by(const Law& law, std::span<const Trial> trials) {
  Shown shown;
  const std::size_t at = 2 * law.place;
  double count = 0.0, square = 0.0;
  for (const Trial& trial : trials) {
    shown.attitude = shown.attitude || trial.observed.attitude;
    for (std::size_t k = 0; k < trial.size(); ++k) {
      shown.mean += trial.columns[k][static_cast<Eigen::Index>(at)];
      shown.tau += (law.allocation * trial.input[k]).cwiseAbs2();
      count += 1.0;
    }
  }
  count = std::max(count, 1.0);
  shown.mean /= count;
  shown.tau = (shown.tau / count).cwiseSqrt().eval();
  for (const Trial& trial : trials) {
    Motion motion;
    for (std::size_t k = 0; k < trial.size(); ++k) {
      const double x = trial.columns[k][static_cast<Eigen::Index>(at)];
      motion.nu = trial.nu[k];
      motion.force = trial.input[k];
      const double y = law.of_model(motion);
      square += (x - shown.mean) * (x - shown.mean) / count;
      shown.rms[0] += x * x * y * y / count;
      shown.rms[1] += (x - shown.mean) * (x - shown.mean) * y * y / count;
    }
  }
  shown.spread = std::sqrt(square);
  for (double& rms : shown.rms) rms = std::sqrt(rms);
  return shown;
}

std::string with_unit(double value, const std::string& unit) {
  return brief_number(value) + (unit.empty() ? "" : " " + unit);
}

std::string unit_of_model(const Candidate& candidate) {
  std::string unit;
  for (const Candidate::Power& one : candidate.model) {
    std::string of = "m/s";
    if (one.name == "p" || one.name == "q" || one.name == "r") of = "rad/s";
    if (one.name.starts_with("tau_")) of = one.name < "tau_X" ? "N m" : "N";
    unit = times_unit(unit, power_of_unit(of, one.power));
  }
  return unit;
}

std::shared_ptr<const Effect> effect_of(const std::shared_ptr<const Law>& law, const Vehicle& vehicle,
                                        const Shown& shown, const std::string& column_unit) {
  const Candidate& candidate = law->candidate;
  // What has no known unit is counted in itself.
  const std::string unit =
      times_unit(column_unit.empty() ? "[" + candidate.text + "]" : column_unit, unit_of_model(candidate));
  const bool compound = unit.find_first_of(" /") != std::string::npos;
  const std::string per = compound ? "/(" + unit + ")" : "/" + unit;
  Words words{
      .name = effect_name(candidate), .sentence = "A force goes with the column " + candidate.text + ".", .units = {}};
  for (std::size_t i = 0; i < kNumbers; ++i) words.units[i] = (i > 2 && i < kNorth ? "N m" : "N") + per;

  const bool far = shown.spread > kLeastSpread * std::abs(shown.mean);
  const double thrust = shown.tau.head<3>().norm();
  const double rms = std::max(shown.rms[far ? 0 : 1], 1e-300);
  std::array<double, kNumbers> sigma{};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const double wrench = i < kNorth ? std::max(shown.tau[static_cast<Eigen::Index>(i)], kLeastPart * thrust) : thrust;
    sigma[i] = std::max(kSize * wrench, 1e-9) / rms;
  }

  Forms forms;
  const auto add = [&](const std::string& name, const std::vector<std::size_t>& numbers) {
    NumberSet sought;
    std::vector<double> start(kNumbers, 0.0);
    for (const std::size_t number : numbers) {
      sought.add(number);
      start[number] = 0.1 * sigma[number];
    }
    const auto form = [&](const std::string& called, double from) {
      forms.push_back(
          std::make_unique<GoesWith>(law, called, numbers, from, start, FormTraits{.sought = sought, .obeys = 0}));
    };
    if (far) form(name, 0.0);
    if (std::abs(shown.mean) > kConstant * shown.spread)
      form(name + ", about " + with_unit(shown.mean, column_unit), shown.mean);
    else if (!far)
      form(name, shown.mean);
  };
  if (!candidate.bearing.empty()) {
    add("along " + candidate.bearing, {kAlong});
  } else {
    std::vector<std::size_t> driven;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!vehicle.dof[axis]) continue;
      driven.push_back(axis);
      add(kAxisNames[axis], {axis});
    }
    if (driven.size() > 1) add("all axes", driven);
    if (shown.attitude && (vehicle.dof[0] || vehicle.dof[1])) add("north and east", {kNorth, kEast});
  }
  return std::make_shared<const ColumnEffect>(std::move(words), sigma, std::move(forms));
}

}  // namespace

std::vector<const Effect*> Candidates::pointers() const {
  std::vector<const Effect*> all;
  for (const auto& effect : effects) all.push_back(effect.get());
  return all;
}

Candidates candidates_of(const Vehicle& vehicle, std::span<const Trial> trials) {
  Candidates candidates;
  if (vehicle.candidates.empty() || trials.empty()) return candidates;
  const Allocation allocation = nominal_model(vehicle, trials.front().input_is_wrench).allocation;
  for (std::size_t place = 0; place < vehicle.candidates.size(); ++place) {
    const Candidate& candidate = vehicle.candidates[place];
    const std::string& unit = trials.front().column_units.at(place);
    for (const Trial& trial : trials) {
      if (trial.column_units.at(place) == unit) continue;
      throw InputError("candidate '" + candidate.text + "': " + trial.name + " has it in '" +
                       trial.column_units[place] + "', " + trials.front().name + " in '" + unit +
                       "'; give the unit in the map");
    }
    const auto law = std::make_shared<const Law>(Law{candidate, place, allocation});
    const Shown shown = shown_by(*law, trials);
    if (shown.spread <= kConstant * std::abs(shown.mean) || !(shown.rms[1] > 0.0)) {
      candidates.idle.push_back({effect_name(candidate), "it is " + with_unit(shown.mean, unit) +
                                                             " throughout all that is fitted: nothing can go with it"});
      continue;
    }
    candidates.effects.push_back(effect_of(law, vehicle, shown, unit));
  }
  return candidates;
}

}  // namespace fathom::model
