// Things that happen to vehicles and stand in no list that Fathom searches: it must not give them another's name.
#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// Vortices leave the hull alternately: a force across the flow at the Strouhal frequency.
class Vortices : public Sized {
 public:
  Vortices(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.3, 8.0),
        width_(craft.extent.y()),
        drag_(craft.hull.quadratic[1]),
        strouhal_(random.uniform(0.12, 0.25)) {}
  [[nodiscard]] int memory() const override { return 1; }
  void body(const Instant& at, std::span<const double> z, std::span<double> rate, Terms& terms) const override {
    const double speed = std::hypot(at.nu_r[0], at.nu_r[1]);
    rate[0] = 2.0 * std::numbers::pi * strouhal_ * speed / width_;
    const double force = size() * drag_ * speed * std::sin(z[0]);
    terms.wrench[0] -= force * at.nu_r[1];
    terms.wrench[1] += force * at.nu_r[0];
  }
  [[nodiscard]] Numbers parameters() const override { return {{"strouhal", strouhal_}, {"factor", size()}}; }

 private:
  double width_, drag_, strouhal_;
};

/// Warm water from an outfall rises in a column.
class Upwelling : public Sized {
 public:
  Upwelling(const std::string& name, const Craft&, const Site& site, Random& random)
      : Sized(name, 0.05, 0.8), width_(site.half.head<2>().minCoeff() * random.uniform(0.3, 0.7)) {
    at_ = site.centre.head<2>() +
          0.6 * Eigen::Vector2d(random.uniform(-1.0, 1.0) * site.half.x(), random.uniform(-1.0, 1.0) * site.half.y());
  }
  void water(double, const Vector3d& position, Water& water) const override {
    water.velocity.z() -= size() * std::exp(-0.5 * (position.head<2>() - at_).squaredNorm() / (width_ * width_));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"N", at_.x()}, {"E", at_.y()}, {"width", width_}, {"rises", size()}};
  }

 private:
  double width_;
  Eigen::Vector2d at_;
};

/// Play in the drive: thrust follows only after the command has come back by more than the gap.
class Hysteresis : public Sized {
 public:
  Hysteresis(const std::string& name, const Craft& craft, const Site&, Random&)
      : Sized(name, 0.1 * usual_drag(craft)[0], 5.0 * usual_drag(craft)[0]),
        jets_(static_cast<int>(craft.jets.size())) {}
  [[nodiscard]] int memory() const override { return jets_; }
  void thrust(const Instant&, std::span<const double> z, std::span<double> rate,
              Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      double& f = force[static_cast<Eigen::Index>(i)];
      const double ahead = f - z[i];
      rate[i] = (ahead - std::clamp(ahead, -size(), size())) / 0.02;
      f = z[i];
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"gap_N", size()}}; }

 private:
  int jets_;
};

/// One thruster runs in another's wash.
class Interference : public Sized {
 public:
  Interference(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.2, 2.0), from_(draw_jet(craft, random)), full_(2.0 * usual_drag(craft).head<3>().maxCoeff()) {
    do to_ = draw_jet(craft, random);
    while (to_ == from_);
  }
  void thrust(const Instant&, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    force[to_] -= size() * std::min(std::max(force[from_], 0.0) / full_, 1.0) * std::abs(force[to_]);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"from", static_cast<double>(from_ + 1)}, {"to", static_cast<double>(to_ + 1)}, {"factor", size()}};
  }

 private:
  Eigen::Index from_, to_{};
  double full_;
};

/// Air reaches the propellers now and then.
class AirBursts : public Sized {
 public:
  AirBursts(const std::string& name, const Craft& craft, const Site&, Random&)
      : Sized(name, 0.2, 1.0), pushes_(propellers_of(craft)) {}
  void begin_file(double from, double to, Random& random) override { air_.draw(from, to, 9.0, 0.7, 3.0, random); }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    if (!air_.at(at.t)) return;
    for (std::size_t i = 0; i < pushes_.size(); ++i) {
      if (pushes_[i]) force[static_cast<Eigen::Index>(i)] *= 1.0 - size();
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"lost", size()}}; }

 private:
  Episodes air_;
  std::vector<bool> pushes_;
};

/// The velocity log repeats itself now and then.
class Stick : public Sized {
 public:
  Stick(const std::string& name, const Craft&, const Site&, Random&) : Sized(name, 1.0, 8.0) {}
  void sense(Streams& streams, Random& random) const override {
    const double length = static_cast<double>(streams.nu.size()) * streams.dt;
    Episodes held;
    held.draw(0.0, length, 12.0, 0.5 * size(), size(), random);
    for (const auto& [from, to] : held.spans) {
      const auto first = static_cast<std::size_t>(from / streams.dt);
      for (std::size_t k = first + 1; k < streams.nu.size() && static_cast<double>(k) * streams.dt < to; ++k) {
        streams.nu[k].head<3>() = streams.nu[first].head<3>();
      }
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"longest_s", size()}}; }
};

/// The tether winds round the hull with every turn and is dragged along.
class Rope : public Sized {
 public:
  Rope(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.2, 4.0), start_(random.uniform(-std::numbers::pi, std::numbers::pi)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double turns = std::abs(at.euler[2] - start_) / (2.0 * std::numbers::pi);
    terms.drag_factor.array() += size() * turns;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"drag_per_turn", size()}}; }

 private:
  double start_;
};

/// Weed collects: all drag grows with time.
class Fouling : public Sized {
 public:
  Fouling(const std::string& name, const Craft&, const Site&, Random&) : Sized(name, 0.3, 4.0) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.drag_factor.array() += size() * std::max(at.t, 0.0) / 300.0;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"drag_per_300_s", size()}}; }
};

/// A fin lifts and turns the hull in proportion to u v.
class FinLift : public Sized {
 public:
  FinLift(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.3, 8.0),
        unit_(craft.hull.quadratic[1]),
        arm_(random.sign() * random.uniform(0.2, 0.45) * craft.extent.x()) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double lift = -size() * unit_ * std::abs(at.nu_r[0]) * (at.nu_r[1] + arm_ * at.nu_r[5]);
    terms.wrench[1] += lift;
    terms.wrench[5] += arm_ * lift;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"arm", arm_}, {"factor", size()}}; }

 private:
  double unit_, arm_;
};

}  // namespace

const std::vector<Entry>& foreign() {
  static const std::vector<Entry> list{{"vortex_shedding", {}, make<Vortices>},
                                       {"upwelling", {}, make<Upwelling>},
                                       {"thrust_hysteresis", {.thrusters = true}, make<Hysteresis>},
                                       {"thruster_interference", {.thrusters = true}, make<Interference>},
                                       {"air_bursts", {}, make<AirBursts>},
                                       {"sensor_stick", {}, make<Stick>},
                                       {"rope_wrapping", {}, make<Rope>},
                                       {"fouling", {.clock = true}, make<Fouling>},
                                       {"fin_lift", {}, make<FinLift>}};
  return list;
}

}  // namespace fathom::sealed
