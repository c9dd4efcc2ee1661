// Further forms of listed effects, and effects listed later: drawn only when asked for by name (--only), so that the
// numbers of the benchmark's sets keep their meaning. The name behind the colon is the form's.
#include "test/sealed/mechanisms/interaction_mechanisms.hpp"
#include "test/sealed/mechanisms/mechanism_tools.hpp"
#include "test/sealed/mechanisms/site_mechanisms.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// The owner counts from a point that is not the centre of mass. Trimmed: buoyancy acts on the same plumb line.
class CentreOfMass : public Sized {
 public:
  CentreOfMass(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name.substr(0, name.find(':')), 0.05, 0.4 * craft.extent.x()) {
    do along_ = Vector3d(random.normal(), random.normal(), random.normal());
    while (along_.head<2>().norm() < 0.3 || along_.norm() > 3.0);
    along_.normalize();
  }
  void body(const Instant&, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.centre += size() * along_;
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"x_G", size() * along_.x()}, {"y_G", size() * along_.y()}, {"z_G", size() * along_.z()}};
  }

 private:
  Vector3d along_;
};

/// Where a cable is made fast: aft, above, a little to one side.
Vector3d draw_cleat(const Craft& craft, Random& random) {
  return craft.extent.cwiseProduct(
      Vector3d(-random.uniform(0.3, 0.7), random.uniform(-0.2, 0.2), -random.uniform(0.2, 0.5)));
}

/// Wrench about the origin of a force [N, in the body] at the cleat.
Vector6 at_cleat(const Vector3d& cleat, const Vector3d& force) {
  Vector6 wrench;
  wrench << force, cleat.cross(force);
  return wrench;
}

/// As in the list, but made fast astern, and to a fixed end that pulls it there.
class TetherAstern : public Sized {
 public:
  TetherAstern(const std::string&, const Craft& craft, const Site& site, Random& random)
      : Sized("tether_tension", 0.2 * usual_drag(craft)[0], 30.0 * usual_drag(craft)[0]),
        cleat_(draw_cleat(craft, random)) {
    anchor_ =
        site.centre + Vector3d(random.sign() * (site.half.x() * random.uniform(0.6, 1.3) + 0.5),
                               random.uniform(-1.0, 1.0) * site.half.y(), -site.half.z() * random.uniform(1.0, 1.4));
    slack_ = (anchor_ - site.centre).norm() * random.uniform(0.8, 1.0);
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d to = anchor_ - at.position - at.turn * cleat_;
    const double stretch = to.norm() - slack_;
    if (stretch > 0.0) terms.wrench += at_cleat(cleat_, at.turn.transpose() * (size() * stretch * to.normalized()));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"k", size()},        {"L", slack_},       {"A_N", anchor_.x()}, {"A_E", anchor_.y()},
            {"A_D", anchor_.z()}, {"p_x", cleat_.x()}, {"p_y", cleat_.y()},  {"p_z", cleat_.z()}};
  }

 private:
  Vector3d cleat_, anchor_;
  double slack_{};
};

/// What is paid out drags at the cleat, whose own speed counts.
class TowAstern : public Sized {
 public:
  TowAstern(const std::string&, const Craft& craft, const Site& site, Random& random)
      : Sized("tether_drag", 0.3, 10.0), cleat_(draw_cleat(craft, random)) {
    anchor_ =
        site.centre + Vector3d(random.sign() * (site.half.x() * random.uniform(0.6, 1.3) + 0.5),
                               random.uniform(-1.0, 1.0) * site.half.y(), -site.half.z() * random.uniform(1.0, 1.4));
    unit_ = craft.hull.quadratic[0] / site.half.norm();
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d v = at.nu_r.head<3>() + at.nu_r.tail<3>().cross(cleat_);
    const double length = (anchor_ - at.position - at.turn * cleat_).norm();
    terms.wrench += at_cleat(cleat_, -size() * unit_ * length * v.norm() * v);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"c_length", size() * unit_}, {"A_N", anchor_.x()}, {"A_E", anchor_.y()}, {"A_D", anchor_.z()},
            {"p_x", cleat_.x()},          {"p_y", cleat_.y()},  {"p_z", cleat_.z()}};
  }

 private:
  Vector3d cleat_, anchor_;
  double unit_{};
};

/// Two kinds of thrusters: those that push up and down, and the others, each kind with a time of its own.
class TwoKinds : public Sized {
 public:
  TwoKinds(const std::string& name, const Craft& craft, double guess, double largest, Random& random)
      : Sized(name, guess, largest), slower_is_upright_(random.chance(0.5)), ratio_(random.uniform(0.0, 0.5)) {
    for (const Jet& jet : craft.jets) upright_.push_back(std::abs(jet.axis.z()) > 0.7);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T", time(false)}, {"T_vertical", time(true)}}; }

 protected:
  [[nodiscard]] double time(bool upright) const { return upright == slower_is_upright_ ? size() : ratio_ * size(); }
  [[nodiscard]] double time_of(Eigen::Index jet) const { return time(upright_[static_cast<std::size_t>(jet)]); }
  [[nodiscard]] int jets() const { return static_cast<int>(upright_.size()); }

 private:
  bool slower_is_upright_;
  double ratio_;
  std::vector<bool> upright_;
};

class TwoDelays : public TwoKinds {
 public:
  TwoDelays(const std::string&, const Craft& craft, const Site&, Random& random)
      : TwoKinds("thruster_delay", craft, 0.1, 2.0, random) {}
  [[nodiscard]] double delay_of(Eigen::Index jet) const override { return time_of(jet); }
};

constexpr double kQuickest = 0.004;  // s; the shortest lag that the integration step resolves

class TwoLags : public TwoKinds {
 public:
  TwoLags(const std::string&, const Craft& craft, const Site&, Random& random)
      : TwoKinds("thruster_lag", craft, 0.15, 3.0, random) {}
  [[nodiscard]] int memory() const override { return jets(); }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      rate[k] = (force[i] - z[k]) / std::max(time_of(i), kQuickest);
      force[i] = z[k];
    }
  }
};

/// The shaft answers like a first-order filter; thrust goes with n |n|.
class ShaftLag : public Sized {
 public:
  ShaftLag(const std::string&, const Craft& craft, const Site&, Random&)
      : Sized("thruster_lag", 0.15, 3.0), jets_(static_cast<int>(craft.jets.size())) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      rate[i] = (std::copysign(std::sqrt(std::abs(f)), f) - z[i]) / std::max(size(), kQuickest);
      f = z[i] * std::abs(z[i]);
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T", size()}}; }

 private:
  int jets_;
};

/// A motor's torque against the water's: the shaft gains speed by what is left of both.
class TorqueLag : public Sized {
 public:
  TorqueLag(const std::string&, const Craft& craft, const Site&, Random&)
      : Sized("thruster_lag", 0.15, 3.0),
        jets_(static_cast<int>(craft.jets.size())),
        usual_(usual_drag(craft).head<3>().maxCoeff()) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    const double inertia = 2.0 * std::sqrt(usual_) * std::max(size(), kQuickest);  // size: at the usual thrust
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      rate[i] = (f - z[i] * std::abs(z[i])) / inertia;
      f = z[i] * std::abs(z[i]);
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T_at_usual_thrust", size()}}; }

 private:
  int jets_;
  double usual_;
};

/// A propeller that takes hold little by little.
class SoftBand : public Sized {
 public:
  SoftBand(const std::string&, const Craft& craft, const Site&, Random&)
      : Sized("thruster_deadband", 0.06 * usual_drag(craft).head<3>().maxCoeff(),
              4.0 * usual_drag(craft).head<3>().maxCoeff()) {}
  void thrust(const Instant&, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    if (!(size() > 0.0)) return;
    for (double& f : force) f *= 1.0 - std::exp(-std::pow(f / size(), 2));
  }
  [[nodiscard]] Numbers parameters() const override { return {{"d_soft", size()}}; }  // Fathom's law is another
};

/// A hull that passes by a plane is drawn to it: the energy of its image grows as it comes nearer.
class Suction : public Sized {
 public:
  Suction(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name.substr(0, name.find(':')), 0.003, 1e4) {
    const bool bottom = name.starts_with("bottom");
    const int axis = bottom ? 2 : random.below(2);
    normal_ = Vector3d::Unit(axis) * (bottom ? 1.0 : random.sign());
    distance_ = normal_.dot(site.centre) + site.half[axis] + random.uniform(0.6, 1.2);
    const double pace = std::max(craft.pace.head<3>().maxCoeff(), 0.05);
    unit_ = usual_drag(craft).head<3>().maxCoeff() * std::pow(0.5 * site.half[axis] + 0.6, 4) / (pace * pace);
  }
  void body(const Instant& now, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double gap = std::max(distance_ - normal_.dot(now.position), 0.2);
    const Vector3d v = now.turn * now.nu_r.head<3>();
    const double along = v.squaredNorm() - std::pow(normal_.dot(v), 2);
    terms.wrench.head<3>() += now.turn.transpose() * normal_ * (size() * unit_ * along / std::pow(gap, 4));
  }
  [[nodiscard]] Numbers parameters() const override { return {{"suction", size() * unit_}}; }

 private:
  Vector3d normal_;
  double distance_, unit_;
};

/// The tide turns within half a minute: the stream comes from the other side.
class TideTurns : public Sized {
 public:
  TideTurns(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name.substr(0, name.find(':')), 0.05, 0.6),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)),
        at_(random.uniform(80.0, 250.0)) {}
  void water(double t, const Vector3d&, Water& water) const override {
    water.velocity += size() * std::tanh((t - at_) / 15.0) * Vector3d(std::cos(heading_), std::sin(heading_), 0.0);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"v", size()}, {"heading", heading_}, {"turns_at", at_}};
  }

 private:
  double heading_, at_;
};

/// The stream is faster above than below.
class ShearedStream : public Sized {
 public:
  ShearedStream(const std::string& name, const Craft&, const Site& site, Random& random)
      : Sized(name.substr(0, name.find(':')), 0.05, 0.8),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)),
        middle_(site.centre.z()),
        half_(site.half.z()) {}
  void water(double, const Vector3d& position, Water& water) const override {
    const double share = std::clamp((middle_ - position.z()) / half_, -1.5, 1.5);
    water.velocity += size() * share * Vector3d(std::cos(heading_), std::sin(heading_), 0.0);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"v_above", size()}, {"heading", heading_}}; }

 private:
  double heading_, middle_, half_;
};

/// The stream turns round the compass within minutes.
class TurningStream : public Sized {
 public:
  TurningStream(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name.substr(0, name.find(':')), 0.05, 0.6),
        rate_(random.sign() * 2.0 * std::numbers::pi / random.uniform(250.0, 700.0)),
        phase_(random.uniform(-std::numbers::pi, std::numbers::pi)) {}
  void water(double t, const Vector3d&, Water& water) const override {
    const double angle = rate_ * t + phase_;
    water.velocity += size() * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"v", size()}, {"rate", rate_}}; }

 private:
  double rate_, phase_;
};

/// Fresh on salt, that mix by diffusion; or a top that the wind has stirred, below which the water grows denser.
class Layers : public Sized {
 public:
  Layers(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.3 * usual_drag(craft)[2], 40.0 * usual_drag(craft)[2]),
        depth_(site.centre.z() + 0.5 * site.half.z() * random.uniform(-1.0, 1.0)),
        stirred_(random.chance(0.4)),
        width_(site.half.z() * (stirred_ ? random.uniform(0.1, 0.4) : random.uniform(0.02, 0.2))) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double below = (at.position.z() - depth_) / width_;
    terms.net_weight -= size() * (stirred_ ? -std::expm1(-std::max(below, 0.0)) : 0.5 * std::erfc(-below));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"depth", depth_}, {"width_m", width_}, {"stirred", stirred_ ? 1.0 : 0.0}, {"step_N", size()}};
  }

 private:
  double depth_;
  bool stirred_;
  double width_;
};

/// Bolted on outside: an arm, a lamp, a bottle. Its drag differs from side to side.
class BoltedOn : public Sized {
 public:
  BoltedOn(const std::string& name, const Craft& craft, const Site&, Random& random) : Sized(name, 0.2, 6.0) {
    const int side = random.below(3);
    at_ = 0.4 * craft.extent.cwiseProduct(
                    Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)));
    at_[side] = random.sign() * random.uniform(0.5, 1.0) * craft.extent[side];
    const bool rod = random.chance(0.5);
    for (int i = 0; i < 3; ++i)
      each_[i] = craft.hull.quadratic[0] * (rod && i == side ? random.uniform(0.05, 0.3) : random.uniform(0.7, 1.4));
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d v = at.nu_r.head<3>() + at.nu_r.tail<3>().cross(at_);
    terms.wrench += at_cleat(at_, -size() * v.norm() * each_.cwiseProduct(v));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"x", at_.x()},
            {"y", at_.y()},
            {"z", at_.z()},
            {"c_x", size() * each_.x()},
            {"c_y", size() * each_.y()},
            {"c_z", size() * each_.z()}};
  }

 private:
  Vector3d at_, each_;
};

}  // namespace

const std::vector<Entry>& further() {
  const Needs single{.thrusters = true}, clock{.clock = true};
  static const std::vector<Entry> list = [&] {
    std::vector<Entry> all{{"centre_of_mass", {}, make<CentreOfMass>},
                           {"current:tide", clock, make<TideTurns>},
                           {"current:turning", clock, make<TurningStream>},
                           {"current:sheared", {}, make<ShearedStream>},
                           {"centre_of_mass:tilting", {.tilting = true}, make<CentreOfMass>},
                           {"tether_tension:astern", {}, make<TetherAstern>},
                           {"tether_tension:astern tilting", {.tilting = true}, make<TetherAstern>},
                           {"tether_drag:astern", {}, make<TowAstern>},
                           {"thruster_delay:two", single, make<TwoDelays>},
                           {"thruster_lag:two", single, make<TwoLags>},
                           {"thruster_lag:shaft", single, make<ShaftLag>},
                           {"thruster_lag:torque", single, make<TorqueLag>},
                           {"thruster_deadband:rounded", single, make<SoftBand>},
                           {"bottom_effect:suction", {}, make<Suction>},
                           {"wall_effect:suction", {}, make<Suction>},
                           {"layered_water", {}, make<Layers>},
                           {"appendage", {}, make<BoltedOn>}};
    for (const auto& part : {interaction_mechanisms(), surface_mechanisms()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return list;
}

}  // namespace fathom::sealed
