#include "test/sealed/mechanisms/water_mechanisms.hpp"

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// X_uu, or X_uuu.
std::string power_name(int axis, int power) {
  const auto i = static_cast<std::size_t>(axis);
  std::string name = std::string(kAxisLetters[i]) + "_";
  for (int k = 0; k < power; ++k) name += kSpeedLetters[i];
  return name;
}

class Current : public Sized {
 public:
  Current(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.05, 1.0), heading_(random.uniform(-std::numbers::pi, std::numbers::pi)) {}
  void water(double, const Vector3d&, Water& water) const override {
    water.velocity += size() * Vector3d(std::cos(heading_), std::sin(heading_), 0.0);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"v_N", size() * std::cos(heading_)}, {"v_E", size() * std::sin(heading_)}};
  }

 private:
  double heading_;
};

/// A long-crested swell in deep water (Airy): orbital velocity that fades with depth below the surface at z = 0.
class Wave : public Sized {
 public:
  Wave(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.05, 1.5),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)),
        omega_(2.0 * std::numbers::pi * random.log_uniform(0.08, 0.4)),
        phase_(random.uniform(-std::numbers::pi, std::numbers::pi)) {}
  void water(double t, const Vector3d& position, Water& water) const override {
    const double number = omega_ * omega_ / kGravity;
    const Vector3d along(std::cos(heading_), std::sin(heading_), 0.0);
    const double fade = size() * std::exp(-number * std::max(position.z(), 0.0));
    const double angle = omega_ * t - number * along.dot(position) + phase_;
    const double c = fade * std::cos(angle), s = fade * std::sin(angle);
    water.velocity += c * along + s * Vector3d::UnitZ();
    water.acceleration += omega_ * (-s * along + c * Vector3d::UnitZ());
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"frequency_Hz", omega_ / (2.0 * std::numbers::pi)}, {"speed_at_surface", size()}, {"heading", heading_}};
  }

 private:
  double heading_, omega_, phase_;
};

/// Radiation memory after Cummins (1962) with an exponential kernel: force = -c int exp(-(t-s)/T) nu_dot(s) ds.
class FluidMemory : public Sized {
 public:
  FluidMemory(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.3, 8.0), time_(random.log_uniform(0.4, 4.0)) {
    if (random.chance(0.3)) swing_ = random.uniform(0.8, 2.5) / time_;
    const int only = random.chance(0.5) ? draw_axis(craft, random) : -1;
    for (int i = 0; i < 6; ++i) {
      if (!craft.actuated[static_cast<std::size_t>(i)] || (only >= 0 && i != only)) continue;
      weight_[i] = usual_drag(craft)[i] / craft.pace[i];
    }
  }
  [[nodiscard]] int memory() const override { return swing_ > 0.0 ? 12 : 6; }
  void body(const Instant& at, std::span<const double> z, std::span<double> rate, Terms& terms) const override {
    if (swing_ > 0.0) return swing(at, z, rate, terms);
    // The integral is nu minus its own low pass y, T y_dot = nu - y.
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      rate[k] = (at.nu_r[i] - z[k]) / time_;
      terms.wrench[i] -= size() * weight_[i] * (at.nu_r[i] - z[k]);
    }
  }
  [[nodiscard]] Numbers parameters() const override {
    Numbers numbers{{"T_memory", time_}, {"factor", size()}};
    if (swing_ > 0.0) numbers["omega"] = swing_;
    return numbers;
  }

 private:
  /// Waves that come back: the kernel exp(-t/T) cos(omega t), as an oscillator that the motion drives.
  void swing(const Instant& at, std::span<const double> z, std::span<double> rate, Terms& terms) const {
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double x = z[k], v = z[6 + k], decay = 1.0 / time_;
      rate[k] = v;
      rate[6 + k] = at.nu_r[i] - 2.0 * decay * v - (decay * decay + swing_ * swing_) * x;
      terms.wrench[i] -= size() * weight_[i] * decay * (v + decay * x);
    }
  }

  double time_, swing_{};
  Vector6 weight_{Vector6::Zero()};
};

class CubicDrag : public Sized {
 public:
  CubicDrag(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.5, 8.0), axis_(draw_axis(craft, random)) {
    unit_ = usual_drag(craft)[axis_] / std::pow(craft.pace[axis_], 3);
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.wrench[axis_] -= size() * unit_ * std::pow(at.nu_r[axis_], 3);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"c_cubic", -size() * unit_}}; }
  [[nodiscard]] std::string form() const override { return power_name(axis_, 3); }

 private:
  int axis_;
  double unit_{};
};

/// Bow and stern, or keel and deck, are shaped differently.
class AsymmetricDrag : public Sized {
 public:
  AsymmetricDrag(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.2, 0.95), axis_(random.chance(0.6) ? 0 : 2), sign_(random.sign()) {
    // Drag remains drag: the forward and the backward coefficient stay positive.
    unit_ = craft.hull.quadratic[axis_];
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.wrench[axis_] += sign_ * size() * unit_ * at.nu_r[axis_] * at.nu_r[axis_];
  }
  [[nodiscard]] Numbers parameters() const override { return {{"c", sign_ * size() * unit_}}; }
  [[nodiscard]] std::string form() const override { return power_name(axis_, 2); }

 private:
  int axis_;
  double sign_, unit_;
};

/// A hull without its planes of symmetry: one off-diagonal term of drag (linear or quadratic) or of added mass.
class CrossCoupling : public Sized {
 public:
  CrossCoupling(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.2, 3.0), kind_(random.below(3)), sign_(random.sign()) {
    using Pair = std::pair<int, int>;
    std::vector<Pair> pairs{{1, 5}, {5, 1}, {2, 0}, {0, 2}, {5, 0}};
    if (craft.actuated[3]) pairs.insert(pairs.end(), {{4, 0}, {2, 4}, {4, 2}, {3, 1}, {3, 5}});
    std::tie(i_, j_) = pairs[static_cast<std::size_t>(random.below(static_cast<int>(pairs.size())))];
    const Hull& hull = craft.hull;
    Vector6 mass = hull.added;
    mass.head<3>().array() += hull.mass;
    mass.tail<3>() += hull.inertia;
    const double force = usual_drag(craft)[i_];
    unit_ = kind_ == 0   ? force / craft.pace[j_]
            : kind_ == 1 ? force / (craft.pace[j_] * craft.pace[j_])
                         : 0.25 * std::sqrt(mass[i_] * mass[j_]);
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double d = sign_ * size() * unit_, v = at.nu_r[j_];
    if (kind_ == 0) terms.wrench[i_] += d * v;
    if (kind_ == 1) terms.wrench[i_] += d * std::abs(v) * v;
    if (kind_ == 2) {
      terms.added(i_, j_) += d;
      terms.added(j_, i_) += d;
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"coefficient", sign_ * size() * unit_}}; }
  [[nodiscard]] std::string form() const override {
    const auto row = static_cast<std::size_t>(kind_ == 2 ? std::min(i_, j_) : i_);
    const auto column = static_cast<std::size_t>(kind_ == 2 ? std::max(i_, j_) : j_);
    const std::string axis = kAxisLetters[row], speed = kSpeedLetters[column];
    return axis + "_" + speed + (kind_ == 0 ? "" : kind_ == 1 ? "|" + speed + "|" : "_dot");
  }

 private:
  int kind_, i_{}, j_{};
  double sign_, unit_{};
};

}  // namespace

std::vector<Entry> water_mechanisms() {
  return {{"current", {}, make<Current>},
          {"cross_coupling", {}, make<CrossCoupling>},
          {"asymmetric_drag", {}, make<AsymmetricDrag>},
          {"cubic_drag", {}, make<CubicDrag>},
          {"wave", {.clock = true}, make<Wave>},
          {"fluid_memory", {}, make<FluidMemory>}};
}

}  // namespace fathom::sealed
