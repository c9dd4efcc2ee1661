#include "common/model/effect_size.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "common/model/onset.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {
namespace {

constexpr double kReferenceMass = 30.0;  // kg

/// Reads "N m/(rad/s)^2", "N^(1/2)/(m/s)": factors behind one another, each divided by when a stroke stands before it.
class Unit {
 public:
  explicit Unit(std::string_view text) : rest_{text} {}

  double read() {
    double sum = 0.0;
    bool divide = false;
    while (!rest_.empty() && rest_.front() != ')') {
      const char c = rest_.front();
      if (c == ' ' || c == '/') {
        divide = c == '/';
        rest_.remove_prefix(1);
        continue;
      }
      const double of_factor = factor();
      sum += divide ? -of_factor : of_factor;
      divide = false;
    }
    return sum;
  }

 private:
  double factor() {
    double growth = 0.0;
    if (rest_.front() == '(') {
      rest_.remove_prefix(1);
      growth = read();
      if (!rest_.empty()) rest_.remove_prefix(1);
    } else {
      const std::size_t end = std::min(rest_.find_first_of(" /^()"), rest_.size());
      growth = of_symbol(rest_.substr(0, end));
      rest_.remove_prefix(std::max<std::size_t>(end, 1));
    }
    if (rest_.empty() || rest_.front() != '^') return growth;
    rest_.remove_prefix(1);
    return growth * power();
  }
  double power() {
    if (rest_.empty() || rest_.front() != '(') return number();
    rest_.remove_prefix(1);
    double value = number();
    if (!rest_.empty() && rest_.front() == '/') {
      rest_.remove_prefix(1);
      value /= number();
    }
    if (!rest_.empty()) rest_.remove_prefix(1);
    return value;
  }
  double number() {
    double value = 1.0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    rest_.remove_prefix(error == std::errc{} ? static_cast<std::size_t>(end - rest_.data()) : 0);
    return value;
  }
  static double of_symbol(std::string_view symbol) {
    if (symbol == "N" || symbol == "kg") return 1.0;
    if (symbol == "m") return 1.0 / 3.0;
    if (symbol == "s") return 1.0 / 6.0;
    return 0.0;
  }

  std::string_view rest_;
};

double scaled(double value, double factor) { return std::isfinite(value) ? value * factor : value; }

}  // namespace

double growth_of(std::string_view unit) { return Unit{unit}.read(); }

double size_factor(const Vehicle& vehicle, std::string_view unit) {
  if (!(vehicle.mass > kReferenceMass)) return 1.0;
  return std::max(1.0, std::pow(vehicle.mass / kReferenceMass, growth_of(unit)));
}

EffectParameter parameter_of(const Effect& effect, int variant, std::size_t number, const Vehicle& vehicle) {
  EffectParameter parameter = effect.parameters()[number];
  if (effect.measures() || effect.knows_size() || parameter.name == kOnset) return parameter;
  const double factor = size_factor(vehicle, effect.unit(variant, number));
  parameter.sigma *= factor;
  parameter.low = scaled(parameter.low, factor);
  parameter.high = scaled(parameter.high, factor);
  return parameter;
}

std::vector<EffectParameter> parameters_of(const Effect& effect, int variant, const Vehicle& vehicle) {
  std::vector<EffectParameter> parameters;
  for (std::size_t i = 0; i < effect.parameters().size(); ++i)
    parameters.push_back(parameter_of(effect, variant, i, vehicle));
  return parameters;
}

bool stopped_at_limit(const Effect& effect, int variant, EffectTheta theta, const Vehicle& vehicle) {
  constexpr double kNear = 1e-6;  // of the limit, or of an ordinary size
  const std::vector<EffectParameter> parameters = parameters_of(effect, variant, vehicle);
  bool absent = effect.amplitudes() > 0;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (!effect.takes_part(variant, i)) continue;
    if (i < static_cast<std::size_t>(effect.amplitudes()))
      absent = absent && std::abs(theta[i]) <= kNear * parameters[i].sigma;
    const auto [low, high] = std::pair{parameters[i].low, parameters[i].high};
    if (low != 0.0 && !parameters[i].blurred && theta[i] <= low + kNear * std::abs(low)) return true;
    if (high != 0.0 && theta[i] >= high - kNear * std::abs(high)) return true;
  }
  return absent;
}

}  // namespace fathom::model
