// What happens to vehicles and nobody has listed, for what is learned: written from physics alone. Drawn by name, or
// one after the other with --only unlisted.
#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

double usual_thrust(const Craft& craft) { return 2.0 * usual_drag(craft).head<3>().maxCoeff(); }

/// A housing leaks: water comes in while the pressure drives it, until it is full.
class LeakingHull : public Sized {
 public:
  LeakingHull(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.5 * usual_drag(craft)[2], 40.0 * usual_drag(craft)[2]), fills_(random.uniform(200.0, 600.0)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.net_weight += size() * -std::expm1(-std::max(at.t, 0.0) / fills_);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"full_N", size()}, {"time", fills_}}; }

 private:
  double fills_;
};

/// A heavy cable hangs from the vehicle to a point on the surface: the further away, the more of it is carried.
class HangingCable : public Sized {
 public:
  HangingCable(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, usual_drag(craft)[2] / site.half.x(), 60.0 * usual_drag(craft)[2] / site.half.x()) {
    from_ = site.centre + Vector3d(random.uniform(-1.0, 1.0) * site.half.x(), random.sign() * site.half.y(), 0.0);
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.net_weight += size() * (at.position - from_).head<2>().norm();
  }
  [[nodiscard]] Numbers parameters() const override { return {{"N_per_m", size()}}; }

 private:
  Vector3d from_;
};

/// Motors warm with the power they give and weaken.
class WarmMotors : public Sized {
 public:
  WarmMotors(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.3, 3.0),
        jets_(static_cast<int>(craft.jets.size())),
        usual_(usual_thrust(craft)),
        time_(random.uniform(15.0, 80.0)) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      rate[i] = (std::pow(std::abs(f) / usual_, 1.5) - z[i]) / time_;
      f /= 1.0 + size() * std::max(z[i], 0.0);
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"weaker", size()}, {"time", time_}}; }

 private:
  int jets_;
  double usual_, time_;
};

/// In reverse a propeller's wash hits the hull and pushes it aside.
class ReverseWalk : public Sized {
 public:
  ReverseWalk(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1, 2.0), jet_(draw_jet(craft, random)) {
    aside_ = craft.jets[static_cast<std::size_t>(jet_)].axis.cross(Vector3d::UnitZ());
    if (aside_.norm() < 0.3) aside_ = Vector3d::UnitY();
    aside_.normalize();
    at_ = craft.jets[static_cast<std::size_t>(jet_)].position;
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d push = size() * std::max(-(*at.force)[jet_], 0.0) * aside_;
    terms.wrench.head<3>() += push;
    terms.wrench.tail<3>() += at_.cross(push);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"share", size()}, {"jet", static_cast<double>(jet_ + 1)}};
  }

 private:
  Eigen::Index jet_;
  Vector3d aside_, at_;
};

/// Near the surface the hull makes waves and pays for them.
class WaveMaking : public Sized {
 public:
  WaveMaking(const std::string& name, const Craft&, const Site& site, Random& random)
      : Sized(name, 0.5, 30.0),
        reach_(random.uniform(0.25, 0.6) * site.half.z()),
        top_(site.centre.z() - site.half.z()) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.drag_factor.head<2>().array() += size() * std::exp(-std::max(at.position.z() - top_, 0.0) / reach_);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"factor", size()}, {"reach", reach_}}; }

 private:
  double reach_, top_;
};

/// Thrusters that push aside lose thrust as the vehicle makes way ahead.
class WashedOut : public Sized {
 public:
  WashedOut(const std::string& name, const Craft& craft, const Site&, Random&)
      : Sized(name, 0.3, 1.5), pace_(std::max(craft.pace[0], 0.05)) {
    for (const Jet& jet : craft.jets) aside_.push_back(1.0 - std::abs(jet.axis.x()));
  }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    const double way = std::min(std::abs(at.nu_r[0]) / pace_, 1.5);
    for (Eigen::Index i = 0; i < force.size(); ++i)
      force[i] *= std::max(0.0, 1.0 - size() * way * aside_[static_cast<std::size_t>(i)]);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"lost_at_pace", size()}}; }

 private:
  double pace_;
  std::vector<double> aside_;
};

/// At some moment a plastic bag is caught and stays.
class CaughtBag : public Sized {
 public:
  CaughtBag(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.5, 8.0), axis_(draw_axis(craft, random, 3)), at_(random.uniform(80.0, 250.0)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    if (at.t > at_) terms.drag_factor[axis_] += size();
  }
  [[nodiscard]] Numbers parameters() const override { return {{"factor", size()}, {"caught_at", at_}}; }

 private:
  int axis_;
  double at_;
};

/// An outlet in the tank's wall blows into one part of it.
class Outlet : public Sized {
 public:
  Outlet(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.5 * usual_drag(craft).head<2>().maxCoeff(), 40.0 * usual_drag(craft).head<2>().maxCoeff()),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)),
        width_(0.6 * site.half.head<2>().mean()) {
    at_ = site.centre + site.half.cwiseProduct(Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 0.0));
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double away = (at.position - at_).head<2>().squaredNorm() / (width_ * width_);
    const Vector3d along(std::cos(heading_), std::sin(heading_), 0.0);
    terms.wrench.head<3>() += at.turn.transpose() * (size() * std::exp(-0.5 * away) * along);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"N", size()}, {"width", width_}}; }

 private:
  double heading_, width_;
  Vector3d at_;
};

/// Propellers run up more slowly than they run down.
class SlowRunUp : public Sized {
 public:
  SlowRunUp(const std::string& name, const Craft& craft, const Site&, Random&)
      : Sized(name, 0.15, 3.0), jets_(static_cast<int>(craft.jets.size())) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      const bool up = f * z[i] >= 0.0 && std::abs(f) > std::abs(z[i]);
      rate[i] = (f - z[i]) / std::max(up ? size() : 0.25 * size(), 0.004);
      f = z[i];
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"T_up", size()}}; }

 private:
  int jets_;
};

/// A ballast pump takes water in and gives it off again, by a clock.
class BallastPump : public Sized {
 public:
  BallastPump(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.4 * usual_drag(craft)[2], 40.0 * usual_drag(craft)[2]), period_(random.uniform(25.0, 60.0)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double x = at.t / period_ - std::floor(at.t / period_);
    terms.net_weight += size() * (x < 0.5 ? 4.0 * x - 1.0 : 3.0 - 4.0 * x);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"N", size()}, {"period", period_}}; }

 private:
  double period_;
};

}  // namespace

const std::vector<Entry>& unlisted() {
  const Needs single{.thrusters = true}, clock{.clock = true};
  static const std::vector<Entry> list{
      {"leaking_hull", clock, make<LeakingHull>}, {"hanging_cable", {}, make<HangingCable>},
      {"warm_motors", single, make<WarmMotors>},  {"reverse_walk", single, make<ReverseWalk>},
      {"wave_making", {}, make<WaveMaking>},      {"washed_out", single, make<WashedOut>},
      {"caught_bag", clock, make<CaughtBag>},     {"outlet", {}, make<Outlet>},
      {"slow_run_up", single, make<SlowRunUp>},   {"ballast_pump", clock, make<BallastPump>}};
  return list;
}

}  // namespace fathom::sealed
