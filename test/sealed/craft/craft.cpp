#include "test/sealed/craft/craft.hpp"

#include <algorithm>

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;

Jet horizontal(double x, double y, double z, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return {{x, y, z}, {std::cos(angle), std::sin(angle), 0.0}};
}

Jet vertical(double x, double y, double z) { return {{x, y, z}, {0.0, 0.0, 1.0}}; }

void place_jets(Family family, const Vector3d& extent, Random& random, Craft& craft) {
  const double x = extent.x() * random.uniform(0.28, 0.42), y = extent.y() * random.uniform(0.3, 0.45);
  const double z = extent.z() * random.uniform(-0.08, 0.08);
  auto& jets = craft.jets;
  switch (family) {
    case Family::kAft:  // two aft, one down the middle, one sideways
      jets = {horizontal(-x, -y, z, 0), horizontal(-x, y, z, 0), vertical(0, 0, z),
              horizontal(0.1 * x * random.sign(), 0, z, 90)};
      break;
    case Family::kCross:  // two ahead, two sideways, two down
      jets = {horizontal(0, -y, z, 0),  horizontal(0, y, z, 0), horizontal(x, 0, z, 90),
              horizontal(-x, 0, z, 90), vertical(0, -y, z),     vertical(0, y, z)};
      break;
    case Family::kTriangle:  // three at 120 degrees, one down
      jets = {vertical(0, 0, 0)};
      for (const double place : {60.0, 180.0, 300.0}) {
        const double angle = place * std::numbers::pi / 180.0, radius = 0.5 * (x + y);
        jets.push_back(horizontal(radius * std::cos(angle), radius * std::sin(angle), z, place + 90.0));
      }
      break;
    case Family::kVectored:
    case Family::kHeavy: {
      const double turn = random.uniform(32.0, 52.0);
      jets = {horizontal(x, y, z, -turn), horizontal(x, -y, z, turn), horizontal(-x, y, z, turn),
              horizontal(-x, -y, z, -turn)};
      if (family == Family::kVectored) {
        jets.push_back(vertical(0, y, 0));
        jets.push_back(vertical(0, -y, 0));
      } else {
        for (const double sx : {1.0, -1.0}) {
          for (const double sy : {1.0, -1.0}) jets.push_back(vertical(sx * 0.8 * x, sy * 0.9 * y, 0));
        }
      }
      break;
    }
    case Family::kSlender:  // two main, tunnels at bow and stern, four down
      jets = {horizontal(-x, -1.5 * y, 0, 0), horizontal(-x, 1.5 * y, 0, 0), horizontal(x, 0, 0, 90),
              horizontal(-0.8 * x, 0, 0, 90)};
      for (const double sx : {0.9, -0.9}) {
        for (const double sy : {1.0, -1.0}) jets.push_back(vertical(sx * x, sy * y, 0));
      }
      break;
  }
}

void load_hull(bool slender, bool six, Random& random, Craft& craft) {
  Hull& hull = craft.hull;
  const Vector3d& extent = craft.extent;
  const double volume = extent.prod() * (slender ? 0.7 : random.uniform(0.3, 0.5));  // frames are half water
  hull.mass = craft.density * volume * random.uniform(0.9, 1.0);
  Vector3d square;  // of the extents; chance comes in here, so that a body with these moments can exist
  for (int k = 0; k < 3; ++k) square[k] = extent[k] * extent[k] * random.uniform(0.9, 1.3);
  for (int k = 0; k < 3; ++k) hull.inertia[k] = hull.mass * (square.sum() - square[k]) / 12.0;
  const Vector3d share = slender ? Vector3d(0.1, 0.95, 0.95) : Vector3d(0.5, 0.8, 1.1);
  for (int k = 0; k < 3; ++k) {
    const double face = extent.prod() / extent[k];
    hull.added[k] = hull.mass * share[k] * random.uniform(0.7, 1.4);
    hull.added[3 + k] = hull.inertia[k] * random.uniform(0.4, 1.2) * (slender && k == 0 ? 0.2 : 1.0);
    hull.quadratic[k] = 0.5 * craft.density * face * random.uniform(0.7, 1.3) * (slender && k == 0 ? 0.3 : 0.8);
    hull.linear[k] = hull.quadratic[k] * random.uniform(0.08, 0.35);
    const double a = extent[(k + 1) % 3], b = extent[(k + 2) % 3], arm = std::max(a, b);
    hull.quadratic[3 + k] = 0.5 * craft.density * extent[k] * std::pow(arm, 4) / 32.0 * random.uniform(0.8, 2.0) * 2.0;
    hull.linear[3 + k] = hull.quadratic[3 + k] * random.uniform(0.2, 0.6) + 0.4 * hull.inertia[k];
  }
  if (!six) {  // four degrees of freedom have no numbers for (I_Y - I_X) p q in yaw
    hull.inertia[0] = hull.inertia[1] = std::max(hull.inertia[0], hull.inertia[1]);
    hull.added[4] = hull.added[3];
  }
  hull.net_weight = hull.mass * kGravity * random.uniform(-0.015, 0.006);
  const double lift = hull.mass * kGravity * (six ? random.uniform(0.004, 0.02) : random.uniform(0.03, 0.06));
  const double askew = six ? 0.06 * lift : 0.0;  // four degrees of freedom have no numbers for it
  hull.first_moment = {askew * random.normal(), askew * random.normal(), lift};
}

}  // namespace

Eigen::Matrix<double, 6, Eigen::Dynamic> Craft::allocation() const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, static_cast<Eigen::Index>(jets.size()));
  for (std::size_t i = 0; i < jets.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) << jets[i].axis, jets[i].position.cross(jets[i].axis);
  }
  return columns;
}

Craft draw_craft(Family family, Random& random) {
  constexpr std::array<const char*, kFamilies> kNames{"aft", "cross", "vectored", "triangle", "heavy", "slender"};
  Craft craft;
  craft.family = kNames[static_cast<std::size_t>(family)];
  const bool slender = family == Family::kSlender, six = slender || family == Family::kHeavy;
  craft.density = random.chance(0.5) ? random.uniform(996.0, 1000.0) : random.uniform(1018.0, 1028.0);
  craft.nominal_voltage = std::round(random.uniform(13.0, 25.0));
  const double scale = random.log_uniform(0.75, 1.3);
  craft.extent = slender ? Vector3d(1.5, 0.24, 0.24) * scale : Vector3d(0.48, 0.36, 0.3) * scale;
  for (int k = 0; k < 3; ++k) craft.extent[k] *= random.uniform(0.85, 1.2);
  load_hull(slender, six, random, craft);
  place_jets(family, craft.extent, random, craft);
  craft.actuated = craft.moves = {true, true, true, six, six, true};
  if (six && random.chance(0.25)) {
    craft.states_moments = false;
    craft.hull.first_moment.setZero();
  }
  craft.pace << random.uniform(0.3, 0.6), random.uniform(0.2, 0.4), random.uniform(0.15, 0.3),
      random.uniform(0.15, 0.3), random.uniform(0.12, 0.25), random.uniform(0.3, 0.7);
  if (slender) craft.pace[5] *= 0.5;
  return craft;
}

}  // namespace fathom::sealed
