// What each candidate effect would add to the wrench at one instant of measured motion: at a start of its search, and
// per unit change of each of its numbers there. The regression of live_evidence.hpp does the rest.
#pragma once

#include <string>
#include <vector>

#include "common/model/dynamics.hpp"

namespace fathom::diagnosis {

/// One form of an effect ("thruster 3"), whatever its numbers.
struct LiveForm {
  const model::Effect* effect{};
  int variant{};
  std::string variant_name;
  std::vector<model::EffectParameter> parameters{};  ///< as they are on this vehicle
  std::vector<std::size_t> sought{};                 ///< which of them have columns: those that take part
};

/// A form with the numbers around which it is linearised. Its columns follow one another: the wrench at `theta`, then
/// one per number sought, in units of that number's prior sigma.
struct LiveStart {
  int form{};
  std::vector<double> theta;
  Eigen::Index column{};
  Eigen::Index sought{};
  [[nodiscard]] Eigen::Index columns() const { return 1 + sought; }
};

using WrenchColumns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

class LiveCandidates {
 public:
  /// All forms of all registered effects that `scene` admits. `base` supplies drag and masses, for effects that alter
  /// what the hull feels.
  LiveCandidates(const model::Model& base, const model::Scene& scene);

  [[nodiscard]] const std::vector<LiveForm>& forms() const { return forms_; }
  [[nodiscard]] const std::vector<LiveStart>& starts() const { return starts_; }
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  /// Behind the candidates': what a gyro's axes that are turned by a radian about x, y, z of the body's would seem to
  /// add. No effect of the water: it is taken out of all of them.
  static constexpr Eigen::Index kTurns = 3;
  /// Columns that carry inertia as well, the turns' among them.
  [[nodiscard]] const std::vector<Eigen::Index>& inertial() const { return inertial_; }

  /// Memory settles at the next sample.
  void reset() { settled_ = false; }
  /// `motion` as commanded; `middle` is the command halfway since the last sample, `dt` s ago. Fills one wrench per
  /// column and turn, and one momentum (added inertia times nu) per entry of inertial().
  void step(const model::Motion& motion, const model::ActuatorForces& middle, double dt,
            Eigen::Ref<WrenchColumns> wrench, Eigen::Ref<WrenchColumns> momentum);

 private:
  struct Probe {  // one evaluation: a start, or a start with one number moved
    const model::Effect* effect{};
    int variant{};
    Eigen::Index column{};
    double per_step{};  // sigma over step; 0 for the start itself
    std::vector<double> theta;
    std::vector<double> memory;
  };
  void add(int form, const std::vector<double>& theta);
  void turn(const model::Motion& motion, const Vector6d& absent, Eigen::Ref<WrenchColumns> wrench,
            Eigen::Ref<WrenchColumns> momentum) const;

  model::Model base_;
  std::vector<LiveForm> forms_;
  std::vector<LiveStart> starts_;
  std::vector<Probe> probes_;
  std::vector<Eigen::Index> inertial_;
  std::vector<Eigen::Index> momentum_of_;  // column -> entry of inertial_, or -1
  Eigen::Index columns_{};
  bool settled_{false};
};

}  // namespace fathom::diagnosis
