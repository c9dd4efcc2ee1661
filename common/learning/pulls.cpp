#include "common/learning/pulls.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace fathom::learning {
namespace {

constexpr int kBearings = 8;

/// Points about the middle of where it was, places in units of its reach.
class Points {
 public:
  explicit Points(const Room& room) : middle_{room.middle[1], room.middle[2], room.middle[3]}, reach_{room.reach()} {}
  void add(const Eigen::Vector3d& off, double slack) {
    const Eigen::Vector3d point = middle_ + reach_ * off;
    all.push_back(
        {.quantity = model::Quantity::kStretch, .a = point.x(), .b = point.y(), .c = point.z(), .d = reach_ * slack});
  }
  template <typename Use>
  static void around(const Use& use) {
    for (int k = 0; k < kBearings; ++k) {
      const double bearing = 2.0 * std::numbers::pi * k / kBearings;
      use(Eigen::Vector3d{std::cos(bearing), std::sin(bearing), 0.0});
    }
  }
  std::vector<model::Factor> all;

 private:
  Eigen::Vector3d middle_;
  double reach_;  // m
};

}  // namespace

std::vector<model::Factor> stretches_of(const Room& room) {
  Points points{room};
  for (const double slack : {0.0, 0.4, 0.7}) points.add(Eigen::Vector3d::Zero(), slack);
  for (const double down : {-1.5, 1.5}) points.add({0.0, 0.0, down}, 1.0);
  Points::around([&](const Eigen::Vector3d& way) {
    points.add(0.5 * way, 0.7);
    points.add(1.2 * way, 0.0);
    points.add(1.2 * way, 1.2);
  });
  return std::move(points.all);
}

std::vector<model::Factor> distances_of(const Room& room) {
  Points points{room};
  points.add(Eigen::Vector3d::Zero(), 0.0);
  Points::around([&](const Eigen::Vector3d& way) { points.add(way, 0.0); });
  return std::move(points.all);
}

std::vector<model::Factor> plan_distances_of(const Room& room) {
  std::vector<model::Factor> all = distances_of(room);
  for (model::Factor& one : all) one = {.quantity = model::Quantity::kPlanStretch, .a = one.a, .b = one.b, .d = one.d};
  return all;
}

}  // namespace fathom::learning
