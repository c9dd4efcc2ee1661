// What thrusters do to the hull and the surface to them: listed effects that no number of the benchmark draws
// (--only NAME). None for jets that meet another thruster: no drawn frame has such a pair.
#include "test/sealed/mechanisms/interaction_mechanisms.hpp"

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// A battery tube stands behind one propeller: pushing one way, the jet beats against it.
class BehindIt : public Sized {
 public:
  BehindIt(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.2, 0.9), jet_(draw_jet(craft, random)), way_(random.sign()) {}
  void thrust(const Instant&, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    double& f = force[jet_];
    if (f * way_ > 0.0) f -= size() * f;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"lost", size()}}; }
  [[nodiscard]] std::string form() const override { return jet_name(jet_) + (way_ > 0.0 ? " ahead" : " astern"); }

 private:
  Eigen::Index jet_;
  double way_;
};

/// One propeller's torque, Q = (K_Q / K_T) D T, against its sense of turning.
class Torque : public Sized {
 public:
  Torque(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.01, 0.3 * craft.extent.y()), jet_(draw_jet(craft, random)), sense_(random.sign()) {
    axis_ = craft.jets[static_cast<std::size_t>(jet_)].axis;
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.wrench.tail<3>() += sense_ * size() * (*at.force)[jet_] * axis_;
  }
  [[nodiscard]] Numbers parameters() const override { return {{"K_Q_D_over_K_T", sense_ * size()}}; }
  [[nodiscard]] std::string form() const override { return jet_name(jet_); }

 private:
  Eigen::Index jet_;
  double sense_;
  Vector3d axis_;
};

/// A rotor's angular momentum: while it gains speed the vehicle is turned the other way, about the propeller's axis.
class Rotor : public Sized {
 public:
  Rotor(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.02, 0.5 * craft.extent.y()),
        jet_(draw_jet(craft, random)),
        time_(random.log_uniform(0.2, 1.0)),
        sense_(random.sign()) {
    craft.jets[static_cast<std::size_t>(jet_)].axis.cwiseAbs().maxCoeff(&about_);
  }
  [[nodiscard]] int memory() const override { return 1; }
  void body(const Instant& at, std::span<const double> z, std::span<double> rate, Terms& terms) const override {
    const double f = (*at.force)[jet_];
    rate[0] = (f - z[0]) / time_;
    terms.wrench[3 + about_] += sense_ * size() * (f - z[0]);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"m", sense_ * size()}, {"T", time_}}; }
  [[nodiscard]] std::string form() const override { return jet_name(jet_) + " about " + std::string(1, "xyz"[about_]); }

 private:
  Eigen::Index jet_;
  double time_, sense_;
  Eigen::Index about_{};
};

/// Air reaches whichever propeller is shallow: half of the loss is gone where it is one diameter deeper.
class Air : public Sized {
 public:
  Air(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.4, 0.95),
        top_(site.centre.z() - site.half.z()),
        half_(random.uniform(0.1, 0.35)),
        pushes_(propellers_of(craft)) {
    for (const Jet& jet : craft.jets) places_.push_back(jet.position);
  }
  void thrust(const Instant& at, std::span<const double>, std::span<double>, Eigen::VectorXd& force) const override {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const double below = at.position.z() + (at.turn * places_[i]).z() - top_;
      if (pushes_[i]) force[static_cast<Eigen::Index>(i)] *= 1.0 - std::min(size() * std::exp2(-below / half_), 1.0);
    }
  }
  [[nodiscard]] Numbers parameters() const override { return {{"lost", size()}, {"half_m", half_}}; }

 private:
  double top_, half_;
  std::vector<bool> pushes_;
  std::vector<Vector3d> places_;
};

}  // namespace

std::vector<Entry> interaction_mechanisms() {
  const Needs single{.thrusters = true}, tilting{.thrusters = true, .tilting = true};
  return {{"jet_on_hull", single, make<BehindIt>},
          {"propeller_torque", tilting, make<Torque>},
          {"switching_moment", tilting, make<Rotor>},
          {"ventilation", single, make<Air>}};
}

}  // namespace fathom::sealed
