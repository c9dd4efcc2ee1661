// Lenses whose distortion, fitted in the middle of the picture alone, folds back before its corners.
#include <doctest/doctest.h>

#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

model::Lens with(const std::array<double, 5>& distortion) {
  model::Lens l = lens();
  l.fx = l.fy = 400;
  l.distortion = distortion;
  return l;
}

}  // namespace

TEST_CASE("folding lens: usual lenses see everywhere, one that folds back sees up to where it does") {
  for (const std::array<double, 5>& usual :
       {std::array<double, 5>{}, {-0.2, 0.03, 0.001, -0.001, 0.0}, {0.3, 0.1, 0.0, 0.0, 0.0}}) {
    CHECK_FALSE(Projection{with(usual)}.folds());
    CHECK(lens_doubts(with(usual)).empty());
  }
  // r - 0.55 r^3 turns at r = 0.78, where it is 0.52: 208 px from the middle.
  const Projection folding{with({-0.55, 0.0, 0.0, 0.0, 0.0})};
  CHECK(folding.folds());
  CHECK(folding.sees({319.5 + 200.0, 239.5}));
  CHECK_FALSE(folding.sees({319.5 + 216.0, 239.5}));
  // This one comes back beyond its fold: there is a direction for the corner, and it is not the corner's.
  const Projection returning{with({-0.9, 0.35, 0.0, 0.0, 0.0})};
  const Eigen::Vector2d corner{2.0, 2.0};
  CHECK((returning.pixel(returning.ray(corner).direction) - corner).norm() < 1e-3);
  CHECK_FALSE(returning.sees(corner));
  CHECK(lens_doubts(returning.lens()).find("folds back") != std::string::npos);
  // A fisheye's picture may be a disc.
  model::Lens fisheye = lens();
  fisheye.kind = model::Lens::Kind::kFisheye;
  fisheye.fx = fisheye.fy = 180;
  CHECK_FALSE(Projection{fisheye}.sees({2.0, 2.0}));
  CHECK(Projection{fisheye}.sees({319.5 + 200.0, 239.5}));
  CHECK(lens_doubts(fisheye).empty());
}

TEST_CASE("folding lens: a focal length in millimetres is told") {
  for (const double focal : {3.6, 1e-9, 1e9}) {
    model::Lens l = lens();
    l.fx = l.fy = focal;
    CHECK(lens_doubts(l).find("from left to right") != std::string::npos);
  }
}

TEST_CASE("folding lens: what it does not see is in no pose and no flow") {
  const model::Lens folding = with({-0.55, 0.0, 0.0, 0.0, 0.0});
  const Projection projection{folding};
  Renderer renderer{site(), with({}), std::nullopt, {}, 5};  // its pictures fill the corners
  FrontEnd front_end{site(), folding, std::nullopt, {}};
  for (int i = 0; i < 3; ++i) {
    const Pose at = pose({0.02 * i, 0.0, 0.4});
    Picture seen = picture(renderer, i / 30.0, at);
    front_end.step(seen, at.R_WC);
    for (const TagSighting& tag : front_end.sight().tags) {
      const bool whole = std::all_of(tag.corners.begin(), tag.corners.end(),
                                     [&](const Eigen::Vector2d& corner) { return projection.sees(corner); });
      if (!whole) CHECK(tag.verdict != TagVerdict::kGeometry);
    }
    for (const Track& track : front_end.tracks()) CHECK((track.from - Eigen::Vector2d{319.5, 239.5}).norm() < 212.0);
  }
  CHECK(front_end.tracks().size() > 10);
}

}  // namespace fathom::vision
