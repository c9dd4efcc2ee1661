#include "test/sealed/mechanisms/thrust_mechanisms.hpp"

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Numbers = std::map<std::string, double>;

double largest_force(const Craft& craft) {
  const Vector6 drag = usual_drag(craft);
  return 2.0 * drag.head<3>().maxCoeff();
}

/// Every propeller answers like a first-order filter.
class Lag : public Sized {
 public:
  Lag(const std::string& name, const Craft& craft, const Site&, Random&)
      : Sized(name, 0.15, 3.0), jets_(static_cast<int>(craft.jets.size())) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      const double lag = std::max(size(), 0.004);  // s; the shortest that the integration step resolves
      rate[i] = (f - z[i]) / lag;
      f = z[i];
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T", size()}}; }

 private:
  int jets_;
};

class Delay : public Sized {
 public:
  Delay(const std::string& name, const Craft&, const Site&, Random&) : Sized(name, 0.1, 2.0) {}
  [[nodiscard]] double delay() const override { return size(); }
  [[nodiscard]] Numbers parameters() const override { return {{"T", size()}}; }
};

/// A propeller that does not move for small commands: either the rest is shifted, or all of it comes at once.
class DeadBand : public Sized {
 public:
  DeadBand(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.03 * largest_force(craft), 2.0 * largest_force(craft)),
        step_(random.chance(0.4)),
        pushes_(propellers_of(craft)) {}
  void thrust(const Instant&, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < pushes_.size(); ++i) {
      if (!pushes_[i]) continue;
      double& f = force[static_cast<Eigen::Index>(i)];
      const double over = std::abs(f) - size();
      f = over <= 0.0 ? 0.0 : (step_ ? f : std::copysign(over, f));
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"d", size()}}; }
  [[nodiscard]] std::string form() const override { return step_ ? "step" : "offset"; }

 private:
  bool step_;
  std::vector<bool> pushes_;
};

/// Propellers are shaped to push forward.
class Asymmetry : public Sized {
 public:
  Asymmetry(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.1, 0.9), sign_(random.chance(0.8) ? -1.0 : 1.0) {}
  void thrust(const Instant&, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    for (double& f : force) f *= f < 0.0 ? 1.0 + sign_ * size() : 1.0;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"a", sign_ * size()}}; }

 private:
  double sign_;
};

/// One thruster is weaker or stronger than its file says, from the start or (failure) from one moment on.
class OneThruster : public Sized {
 public:
  OneThruster(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1, 1.0), fails_(name == "thruster_failure"), jet_(draw_jet(craft, random)) {
    sign_ = fails_ || random.chance(0.75) ? -1.0 : 1.0;
    when_ = fails_ ? random.uniform(60.0, 240.0) : -1e9;
  }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    if (at.t >= when_) force[jet_] *= 1.0 + sign_ * size();
  }
  [[nodiscard]] Numbers parameters() const override {
    Numbers numbers{{"g", sign_ * size()}};
    if (fails_) numbers["t_0"] = when_;
    return numbers;
  }
  [[nodiscard]] std::string form() const override { return jet_name(jet_); }

 private:
  bool fails_;
  Eigen::Index jet_;
  double sign_, when_;
};

/// One thruster is mounted askew, or elsewhere than drawn.
class Misalignment : public Sized {
 public:
  Misalignment(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1, 0.8), jet_(draw_jet(craft, random)), shifted_(random.chance(0.3)) {
    const Jet& jet = craft.jets[static_cast<std::size_t>(jet_)];
    position_ = jet.position;
    axis_ = jet.axis;
    const bool upright = std::abs(axis_.z()) > 0.9;
    const double heading = random.uniform(0.0, 2.0 * std::numbers::pi);
    side_ = upright ? Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0)
                    : Eigen::Vector3d(Eigen::Vector3d::UnitZ().cross(axis_) * random.sign());
    // A shift turns the vehicle only if it moves the thruster's line; of an upright one that shows in roll and pitch.
    if (upright && !craft.actuated[3]) shifted_ = false;
    reach_ = craft.extent.x();
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double f = (*at.force)[jet_];
    Eigen::Vector3d axis = axis_, position = position_;
    if (shifted_) {
      position += size() * reach_ * side_;
    } else {
      axis = std::cos(size()) * axis_ + std::sin(size()) * side_;
    }
    terms.wrench.head<3>() += f * (axis - axis_);
    terms.wrench.tail<3>() += f * (position.cross(axis) - position_.cross(axis_));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{shifted_ ? "shift_m" : "angle_rad", size() * (shifted_ ? reach_ : 1.0)}};
  }
  [[nodiscard]] std::string form() const override { return jet_name(jet_); }

 private:
  Eigen::Index jet_;
  bool shifted_;
  Eigen::Vector3d position_, axis_, side_;
  double reach_{};
};

/// Thrust follows the battery: by its logged voltage, or (nobody measured it) simply less and less.
class Sag : public Sized {
 public:
  Sag(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.8, 3.0),
        nominal_(craft.nominal_voltage),
        logged_(random.chance(0.6)),
        pushes_(propellers_of(craft)) {
    full_ = random.uniform(1.02, 1.1);
    fall_ = random.uniform(0.0005, 0.0011);  // of nominal, per second
    ripple_ = random.uniform(0.005, 0.03);
    period_ = random.uniform(11.0, 40.0);
  }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    const double factor =
        logged_ ? std::pow(voltage(at.t) / nominal_, size()) : std::max(1.0 - size() * at.t / 1000.0, 0.05);
    for (std::size_t i = 0; i < pushes_.size(); ++i) {
      if (pushes_[i]) force[static_cast<Eigen::Index>(i)] *= factor;
    }
  }
  [[nodiscard]] double voltage(double t) const override {
    if (!logged_) return 0.0;
    return nominal_ * std::max(full_ - fall_ * t + ripple_ * std::sin(2.0 * std::numbers::pi * t / period_), 0.5);
  }
  [[nodiscard]] Numbers parameters() const override { return {{logged_ ? "k" : "s", size()}}; }
  [[nodiscard]] std::string form() const override { return logged_ ? "voltage exponent" : "loss per 1000 s"; }

 private:
  double nominal_;
  bool logged_;
  std::vector<bool> pushes_;
  double full_, fall_, ripple_, period_;
};

/// T = T_nn |n| n - T_nv |n| v_a (Fossen 2011, sec. 9.3): a propeller that runs away from its wake finds less to push.
class Loss : public Sized {
 public:
  Loss(const std::string& name, const Craft& craft, const Site&, Random&) : Sized(name, 0.5, 12.0) {
    for (const Jet& jet : craft.jets) jets_.push_back(jet);
  }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    const Eigen::Vector3d v = at.nu_r.head<3>(), w = at.nu_r.tail<3>();
    for (std::size_t i = 0; i < jets_.size(); ++i) {
      const double advance = jets_[i].axis.dot(v + w.cross(jets_[i].position));
      double& f = force[static_cast<Eigen::Index>(i)];
      f -= size() * std::sqrt(std::abs(f)) * advance;
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T_nv", size()}}; }

 private:
  std::vector<Jet> jets_;
};

}  // namespace

std::vector<Entry> thrust_mechanisms() {
  const Needs single{.thrusters = true}, timed{.thrusters = true, .clock = true};
  return {{"thruster_lag", single, make<Lag>},
          {"thruster_delay", {}, make<Delay>},
          {"thruster_deadband", single, make<DeadBand>},
          {"thrust_asymmetry", single, make<Asymmetry>},
          {"thruster_gain", single, make<OneThruster>},
          {"thruster_misalignment", single, make<Misalignment>},
          {"thruster_failure", timed, make<OneThruster>},
          {"battery_sag", timed, make<Sag>},
          {"thrust_loss", single, make<Loss>}};
}

}  // namespace fathom::sealed
