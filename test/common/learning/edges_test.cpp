#include "common/learning/edges.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/model/learned/factors/factor_kind.hpp"

using namespace fathom;
using namespace fathom::learning;

namespace {

model::Scene box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  model::Scene scene;
  scene.position = true;
  scene.p_low = low;
  scene.p_high = high;
  return scene;
}

}  // namespace

TEST_CASE("edges: the corners of where it was lie on them, the middle lies half a width inside") {
  const Eigen::Vector3d low{-1.0, 2.0, 0.5}, high{5.0, 4.0, 1.5};
  const std::vector<Edge> edges = edges_of(box(low, high));
  REQUIRE(edges.size() == 10);
  for (const Edge& edge : edges) {
    CAPTURE(edge.words);
    const double reach = 0.25 * edge.width;
    const auto value = [&](const Eigen::Vector3d& at) {
      model::FeatureState state;
      state.p_WB = at;
      return model::kind_of(model::Quantity::kNear).value(near(edge, reach), state);
    };
    double most = 0.0, least = 1.0;
    for (const double x : {low.x(), high.x()}) {
      for (const double y : {low.y(), high.y()}) {
        for (const double z : {low.z(), high.z()}) {
          most = std::max(most, value({x, y, z}));
          least = std::min(least, value({x, y, z}));
        }
      }
    }
    CHECK(most == doctest::Approx(1.0));
    CHECK(least == doctest::Approx(std::exp(-4.0)));
    CHECK(value(0.5 * (low + high)) == doctest::Approx(std::exp(-2.0)));
    CHECK(edge.along.c != 0.0);  // a file refuses a width of nothing
  }
}

TEST_CASE("edges: none across which the craft has not moved, and none where nobody knows where it was") {
  const std::vector<Edge> level = edges_of(box({0.0, 0.0, 1.0}, {4.0, 4.0, 1.05}));
  CHECK(level.size() == 8);
  model::Scene nowhere = box({0.0, 0.0, 0.0}, {4.0, 4.0, 2.0});
  nowhere.position = false;
  CHECK(edges_of(nowhere).empty());
}
