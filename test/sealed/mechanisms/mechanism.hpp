// What may happen to a vehicle beyond Fossen's hull, formulated for this benchmark alone: it shares no code with
// common/.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "test/sealed/craft/craft.hpp"

namespace fathom::sealed {

/// The vehicle at one instant, as a mechanism sees it.
struct Instant {
  double t{};  ///< s on the clock that the file shows
  Eigen::Vector3d position, euler;
  Eigen::Matrix3d turn;  ///< body to world
  Vector6 nu, nu_r;
  const Eigen::VectorXd* force{};  ///< N, as the thrusters really push
};

/// Water about the vehicle, in the world.
struct Water {
  Eigen::Vector3d velocity{Eigen::Vector3d::Zero()}, acceleration{Eigen::Vector3d::Zero()};
};

/// What mechanisms add to the equation of motion.
struct Terms {
  Vector6 wrench{Vector6::Zero()};
  Matrix6 added{Matrix6::Zero()};                   ///< to the added mass
  Vector6 drag_factor{Vector6::Ones()};             ///< on the hull's own drag
  double mass{};                                    ///< kg, at the centre of mass
  double net_weight{};                              ///< N
  Eigen::Vector3d centre{Eigen::Vector3d::Zero()};  ///< m, of the hull's mass, from the origin
  Eigen::Vector3d first_moment{Eigen::Vector3d::Zero()};
};

/// Noise-free sensor streams, one entry per sample.
struct Streams {
  double dt{};
  std::vector<Eigen::Vector3d> position, euler;
  std::vector<Vector6> nu;
};

/// Everything a mechanism needs to know of its surroundings when it is drawn.
struct Site {
  Eigen::Vector3d half;  ///< m, the box in which trials stay, about `centre`
  Eigen::Vector3d centre;
};

class Mechanism {
 public:
  explicit Mechanism(std::string name) : name_(std::move(name)) {}
  virtual ~Mechanism() = default;
  Mechanism(const Mechanism&) = delete;
  Mechanism& operator=(const Mechanism&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double size() const { return size_; }
  void set_size(double size) { size_ = size; }
  [[nodiscard]] virtual double first_guess() const = 0;  ///< of the size
  [[nodiscard]] virtual double largest() const = 0;      ///< more is not plausible
  /// Which of an effect's forms it is, as result.json writes it ("X_uu", "T3"); empty: there is one form.
  [[nodiscard]] virtual std::string form() const { return {}; }
  [[nodiscard]] virtual std::map<std::string, double> parameters() const = 0;

  /// A new file begins: random paths are drawn for it.
  virtual void begin_file(double /*from*/, double /*to*/, Random& /*random*/) {}
  [[nodiscard]] virtual int memory() const { return 0; }
  [[nodiscard]] virtual double delay() const { return 0.0; }
  /// What one jet is late beside the others.
  [[nodiscard]] virtual double delay_of(Eigen::Index /*jet*/) const { return 0.0; }
  /// From what was asked to what is delivered; `rate` is that of `z`.
  virtual void thrust(const Instant&, std::span<const double> /*z*/, std::span<double> /*rate*/,
                      Eigen::VectorXd& /*force*/) const {}
  virtual void water(double /*t*/, const Eigen::Vector3d& /*position*/, Water&) const {}
  /// `nu_dot` is not known here; what needs it belongs into `added`.
  virtual void body(const Instant&, std::span<const double> /*z*/, std::span<double> /*rate*/, Terms&) const {}
  virtual void sense(Streams&, Random& /*random*/) const {}
  /// What a voltmeter would show; 0: no opinion.
  [[nodiscard]] virtual double voltage(double /*t*/) const { return 0.0; }

 private:
  std::string name_;
  double size_{};
};

using Mechanisms = std::vector<std::unique_ptr<Mechanism>>;

/// Where a mechanism may be drawn.
struct Needs {
  bool thrusters{false};  ///< single thrusters must be logged
  bool tilting{false};    ///< six degrees of freedom
  bool moments{false};    ///< the owner does not let the first moment be identified
  bool clock{false};      ///< depends on the time of day
  bool windage{false};    ///< something stands above the water
};

struct Entry {
  std::string name;
  Needs needs;
  std::unique_ptr<Mechanism> (*make)(const std::string& name, const Craft&, const Site&, Random&);
};

/// The list in which Fathom promises to find things.
[[nodiscard]] const std::vector<Entry>& catalogue();
/// Things that happen and that it does not list.
[[nodiscard]] const std::vector<Entry>& foreign();
/// Forms and effects that no number draws: only --only names them.
[[nodiscard]] const std::vector<Entry>& further();
/// Things that happen and that neither it nor what it learns from holds, for --learning: drawn by name, or in turn.
[[nodiscard]] const std::vector<Entry>& unlisted();
/// Effects of craft that are no ROVs, of which no ROV is drawn; and things of the kind that stand in no list.
[[nodiscard]] const std::vector<Entry>& surface_entries();
[[nodiscard]] const std::vector<Entry>& surface_foreign();
/// What of the lists may happen to a craft of that class.
[[nodiscard]] std::vector<const Entry*> catalogue_of(CraftClass craft_class);
[[nodiscard]] std::vector<const Entry*> foreign_of(CraftClass craft_class);
/// Coloured noise: not an effect, and never to be named.
[[nodiscard]] const Entry& coloured_noise();
[[nodiscard]] const Entry* find_entry(const std::string& name);

}  // namespace fathom::sealed
