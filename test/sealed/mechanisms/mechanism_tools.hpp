// What the files of mechanisms share: a base that keeps name and limits, and one line per entry of a list.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {

/// A mechanism whose size is one number with stated limits.
class Sized : public Mechanism {
 public:
  Sized(const std::string& name, double guess, double largest) : Mechanism(name), guess_(guess), largest_(largest) {}
  [[nodiscard]] double first_guess() const override { return guess_; }
  [[nodiscard]] double largest() const override { return largest_; }

 private:
  double guess_, largest_;
};

template <class Kind>
std::unique_ptr<Mechanism> make(const std::string& name, const Craft& craft, const Site& site, Random& random) {
  return std::make_unique<Kind>(name, craft, site, random);
}

/// Wrench that the hull's drag makes at the vehicle's usual pace: a yardstick for sizes.
[[nodiscard]] inline Vector6 usual_drag(const Craft& craft) {
  return craft.pace.cwiseProduct(craft.hull.linear + craft.hull.quadratic.cwiseProduct(craft.pace));
}

/// One of the degrees of freedom in which the vehicle is driven, below `limit`.
[[nodiscard]] inline int draw_axis(const Craft& craft, Random& random, int limit = 6) {
  for (;;) {
    const int axis = random.below(limit);
    if (craft.actuated[static_cast<std::size_t>(axis)]) return axis;
  }
}

/// Thrusters are called T1, T2, ... in vehicle files.
[[nodiscard]] inline std::string jet_name(Eigen::Index jet) { return "T" + std::to_string(jet + 1); }

constexpr std::array<const char*, 6> kAxisLetters{"X", "Y", "Z", "K", "M", "N"};
constexpr std::array<const char*, 6> kSpeedLetters{"u", "v", "w", "p", "q", "r"};

[[nodiscard]] inline Eigen::Index draw_jet(const Craft& craft, Random& random) {
  return random.below(static_cast<int>(craft.jets.size()));
}

/// Whether it is a propeller, however it is told: no fin and no weight, which know neither deadbands nor batteries.
[[nodiscard]] inline std::vector<bool> propellers_of(const Craft& craft) {
  std::vector<bool> are;
  for (const Jet& jet : craft.jets) are.push_back(jet.drive == Drive::kForce || jet.drive == Drive::kPropeller);
  return are;
}

/// Moments at which something is wrong: episodes of random length at random distance.
struct Episodes {
  std::vector<std::pair<double, double>> spans;
  void draw(double from, double to, double gap, double shortest, double longest, Random& random) {
    spans.clear();
    for (double t = from; t < to;) {
      t += -gap * std::log(1.0 - random.unit());
      const double length = random.uniform(shortest, longest);
      spans.emplace_back(t, t + length);
      t += length;
    }
  }
  [[nodiscard]] bool at(double t) const {
    const auto next = std::upper_bound(spans.begin(), spans.end(), std::pair{t, 1e300});
    return next != spans.begin() && t < std::prev(next)->second;
  }
};

}  // namespace fathom::sealed
