#include "test/sealed/mechanisms/site_mechanisms.hpp"

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// Where a tether's far end is fixed: above and beside the box.
Vector3d draw_anchor(const Site& site, Random& random) {
  return site.centre + Vector3d(random.sign() * (site.half.x() * random.uniform(0.6, 1.3) + 0.5),
                                random.uniform(-1.0, 1.0) * site.half.y(), -site.half.z() * random.uniform(1.0, 1.4));
}

/// Slack, then a spring toward the anchor.
class TetherTension : public Sized {
 public:
  TetherTension(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.2 * usual_drag(craft)[0], 30.0 * usual_drag(craft)[0]), anchor_(draw_anchor(site, random)) {
    slack_ = (anchor_ - site.centre).norm() * random.uniform(0.8, 1.0);
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d to = anchor_ - at.position;
    const double stretch = to.norm() - slack_;
    if (stretch > 0.0) terms.wrench.head<3>() += at.turn.transpose() * (size() * stretch * to.normalized());
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"k", size()}, {"L", slack_}, {"A_N", anchor_.x()}, {"A_E", anchor_.y()}, {"A_D", anchor_.z()}};
  }

 private:
  Vector3d anchor_;
  double slack_;
};

/// The vehicle tows what is paid out between it and the anchor: quadratic drag in proportion to that length.
class TetherDrag : public Sized {
 public:
  TetherDrag(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.3, 10.0), anchor_(draw_anchor(site, random)) {
    unit_ = craft.hull.quadratic[0] / site.half.norm();
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const Vector3d v = at.nu_r.head<3>();
    terms.wrench.head<3>() -= size() * unit_ * (anchor_ - at.position).norm() * v.norm() * v;
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"c_length", size() * unit_}, {"A_N", anchor_.x()}, {"A_E", anchor_.y()}, {"A_D", anchor_.z()}};
  }

 private:
  Vector3d anchor_;
  double unit_;
};

/// A plane at which the water ends: near it all drag grows, or the vehicle is pushed off it.
class Plane : public Sized {
 public:
  Plane(const std::string& name, const Craft& craft, const Site& site, Random& random)
      : Sized(name, 0.5, 25.0), pushes_(random.chance(0.4)), reach_(random.uniform(0.5, 1.2) * craft.extent.y() + 0.1) {
    const bool surface = name == "surface_effect", level = surface || name == "bottom_effect";
    const int axis = level ? 2 : random.below(2);
    normal_ = Vector3d::Unit(axis) * (surface ? -1.0 : level ? 1.0 : random.sign());  // into what is no water
    place_ = normal_.dot(site.centre) + 0.75 * site.half[axis] + 0.5 * craft.extent.y();
    force_ = usual_drag(craft)[0];
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    const double gap = std::max(place_ - normal_.dot(at.position), 0.02);
    const double near = size() * std::exp(-gap / reach_);
    if (pushes_) {
      terms.wrench.head<3>() -= at.turn.transpose() * (near * force_ * normal_);
    } else {
      terms.drag_factor.head<3>().array() += near;
    }
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"pushes", pushes_ ? 1.0 : 0.0}, {"reach_m", reach_}, {"place_m", place_}, {"factor", size()}};
  }

 private:
  bool pushes_;
  double reach_, place_{}, force_{};
  Vector3d normal_;
};

/// The hull is softer than water: it loses buoyancy with depth.
class Compressibility : public Sized {
 public:
  Compressibility(const std::string& name, const Craft& craft, const Site& site, Random&)
      : Sized(name, 0.1 * usual_drag(craft)[2], 40.0 * usual_drag(craft)[2]), centre_(site.centre.z()) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.net_weight += size() * (at.position.z() - centre_);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"N_per_m", size()}}; }

 private:
  double centre_;
};

/// Something is picked up or dropped at one moment.
class Payload : public Sized {
 public:
  Payload(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.02 * craft.hull.mass, 0.8 * craft.hull.mass),
        when_(random.uniform(60.0, 240.0)),
        sign_(random.chance(0.6) ? 1.0 : -0.4),
        sinking_(1.0 - craft.density / random.uniform(1500.0, 4000.0)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    if (at.t < when_) return;
    terms.mass += sign_ * size();
    terms.net_weight += sign_ * size() * sinking_ * kGravity;
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"t_0", when_}, {"mass", sign_ * size()}, {"weight_in_water", sign_ * size() * sinking_ * kGravity}};
  }

 private:
  double when_, sign_, sinking_;
};

/// Centre of gravity and centre of buoyancy lie apart, and the owner does not know it.
class Restoring : public Sized {
 public:
  Restoring(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.003 * craft.hull.mass * kGravity, 0.3 * craft.hull.mass * kGravity) {
    along_ << 0.25 * random.normal(), 0.25 * random.normal(), 1.0;
  }
  void body(const Instant&, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.first_moment += size() * along_;
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"G_x", size() * along_.x()}, {"G_y", size() * along_.y()}, {"G_z", size() * along_.z()}};
  }

 private:
  Vector3d along_;
};

}  // namespace

std::vector<Entry> site_mechanisms() {
  return {{"tether_tension", {}, make<TetherTension>},
          {"tether_drag", {}, make<TetherDrag>},
          {"restoring_moment", {.tilting = true, .moments = true}, make<Restoring>},
          {"compressibility", {}, make<Compressibility>},
          {"payload_change", {.clock = true}, make<Payload>},
          {"bottom_effect", {}, make<Plane>},
          {"wall_effect", {}, make<Plane>}};
}

std::vector<Entry> surface_mechanisms() { return {{"surface_effect", {}, make<Plane>}}; }

}  // namespace fathom::sealed
