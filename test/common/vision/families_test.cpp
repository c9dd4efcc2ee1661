// Tags of two families whose numbers overlap, each with a map of its own.
#include <doctest/doctest.h>

#include <set>

#include "test/common/vision/scene.hpp"
#include "test/common/vision/two_families.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kPlace = 0.006;  // m: a few tags at 1 m, 0.1 px, and the tilt that goes with it
constexpr double kApart = 1.0;    // m

FrontEnd front_end_of(const model::Site& place) {
  return {place, lens(), std::nullopt, {.detector = {.families = place.search.families}}};
}

}  // namespace

TEST_CASE("two families: each tag is known by family and id, and tells the place of its own") {
  const model::Site place = two_families();
  Renderer renderer{place, lens(), std::nullopt, {}, 41};
  FrontEnd front_end = front_end_of(place);
  double t = 0.0;
  std::set<int> told;
  // Over the first family alone, over both, over the second alone; the last again by who knows nothing of before.
  for (const double x : {-0.9, 0.0, 0.9}) {
    CAPTURE(x);
    const Pose truth = pose({x, 0.05, 0.1}, 0.05, -0.03, 0.4);
    const Picture seen = picture(renderer, t += 0.2, truth);
    const Sight& sight = front_end.step(seen, std::nullopt);
    REQUIRE(sight.fix);
    CHECK_FALSE(sight.fix->ambiguous);
    CHECK((sight.fix->pose.p_WC - truth.p_WC).norm() < kPlace);
    for (const TagSighting& tag : sight.tags) CHECK(tag.verdict == TagVerdict::kAccepted);
    for (const TagPose& each : front_end.tag_poses("down")) {
      const model::Tag* tag = place.tag(each.tag);
      REQUIRE(tag != nullptr);
      CHECK((each.p_CT - truth.R_WC.transpose() * (tag->p_WT - truth.p_WC)).norm() < kPlace);
      told.insert(each.tag);
    }
    FrontEnd fresh = front_end_of(place);
    REQUIRE(fresh.step(seen, std::nullopt).fix);
    CHECK((fresh.sight().fix->pose.p_WC - truth.p_WC).norm() < kPlace);
  }
  CHECK(told.lower_bound(kSecondNumber) != told.begin());
  CHECK(told.lower_bound(kSecondNumber) != told.end());
}

TEST_CASE("two families: who takes the second one's numbers for the first one's would be a metre away") {
  const model::Site place = two_families();
  Renderer renderer{place, lens(), std::nullopt, {}, 41};
  const Pose truth = pose({0.9, 0.05, 0.1}, 0.05, -0.03, 0.4);
  model::Site wrong = place;  // the map of the first family, were it of the second
  std::erase_if(wrong.tags, [](const model::Tag& tag) { return !tag.family.empty(); });
  wrong.search.families = {"tag16h5"};
  FrontEnd front_end = front_end_of(wrong);
  const Sight& sight = front_end.step(picture(renderer, 0.0, truth), std::nullopt);
  REQUIRE(sight.fix);
  CHECK((sight.fix->pose.p_WC - truth.p_WC).norm() > kApart);
}

TEST_CASE("two families: a tag of the map that was not found is looked for by family and id") {
  const model::Site place = two_families();
  Renderer renderer{place, lens(), std::nullopt, {}, 43};
  TagLocator locator{place, lens(), {}};
  const Pose truth = pose({0.0, 0.0, 0.1});
  TagDetector detector{{.families = place.search.families}};
  auto tags = detector.step(grey_of(renderer.step(0.0, truth)));
  const auto fix = locator.step(0, tags, std::nullopt);
  REQUIRE(fix);
  const auto whole = locator.missing(*fix, {});
  REQUIRE(whole.size() >= 4);
  std::erase_if(tags, [](const TagSighting& tag) { return tag.family == "tag16h5"; });
  for (const auto& each : locator.missing(*fix, tags)) CHECK(each.name.family == "tag16h5");
  CHECK(locator.missing(*fix, tags).size() >= 2);
}

}  // namespace fathom::vision
