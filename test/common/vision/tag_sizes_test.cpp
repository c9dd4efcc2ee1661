// Sizes of tags that no map states, and maps that name tags which there are none of.
#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/vision/calibration.hpp"
#include "common/vision/front_end.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

bool refused(const std::vector<std::string>& words, const std::string& because) {
  try {
    static_cast<void>(TagSizes::parse(words));
  } catch (const InputError& error) {
    const std::string text = error.what();
    CHECK_MESSAGE(text.find(because) != std::string::npos, text);
    return text.find('\n') == std::string::npos;
  }
  return false;
}

/// Corners of every tag as a camera above the floor sees them.
std::vector<View> views_of(const model::Site& site, int n) {
  const Projection projection{lens()};
  std::vector<View> views;
  for (int i = 0; i < n; ++i) {
    const Pose camera = pose({0.4 * std::sin(0.9 * i), 0.4 * std::cos(0.7 * i), 0.1 * std::sin(i)},
                             0.2 * std::sin(2.0 * i), 0.2 * std::cos(1.4 * i), 0.3 * i);
    View view{.name = std::to_string(i), .tags = {}};
    for (const model::Tag& tag : site.tags) {
      TagSighting seen{.family = site.family_of(tag), .id = tag.id, .margin = 60.0};
      const double h = 0.5 * tag.size;
      const std::array<Eigen::Vector3d, 4> own{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
      bool inside = true;
      for (std::size_t k = 0; k < 4; ++k) {
        seen.corners[k] = projection.pixel(camera.R_WC.transpose() * (tag.p_WT + tag.R_WT * own[k] - camera.p_WC));
        inside = inside && projection.inside(seen.corners[k], 2.0);
      }
      seen.edge = (seen.corners[1] - seen.corners[0]).norm();
      if (inside) view.tags.push_back(seen);
    }
    views.push_back(view);
  }
  return views;
}

}  // namespace

TEST_CASE("tag sizes: the most particular statement counts, in whatever order they come") {
  const TagSizes sizes = TagSizes::parse({"16h5:3=0.12 m", "0.15", "tag16h5=20cm"});
  CHECK(sizes.of({"tag16h5", 3}).value() == doctest::Approx(0.12));
  CHECK(sizes.of({"tag16h5", 4}).value() == doctest::Approx(0.20));
  CHECK(sizes.of({"tag36h11", 3}).value() == doctest::Approx(0.15));
  CHECK(sizes.largest() == doctest::Approx(0.20));
  const TagSizes one = TagSizes::parse({"36h11:7=80 mm"});
  CHECK(one.of({"tag36h11", 7}).value() == doctest::Approx(0.08));
  CHECK_FALSE(one.of({"tag36h11", 8}));
  CHECK_FALSE(TagSizes{}.of({"tag36h11", 8}));
}

TEST_CASE("tag sizes: what is none is refused in a line") {
  for (const char* word : {"", "large", "=0.1", "16h5=", "16h5:3"}) CHECK(refused({word}, ""));
  CHECK(refused({"0"}, "longer than nothing"));
  CHECK(refused({"-0.1"}, "longer than nothing"));
  CHECK(refused({"nan"}, "longer than nothing"));
  CHECK(refused({"0.1 kg"}, "expected 'm'"));
  CHECK(refused({"17h5=0.1"}, "no family"));
  CHECK(refused({"16h5:30=0.1"}, "0 to 29"));
  CHECK(refused({"16h5:-1=0.1"}, "0 to 29"));
  CHECK(refused({"16h5:3x=0.1"}, "0 to 29"));
  CHECK(refused({"0.1", "0.2"}, "twice"));
  CHECK(refused({"16h5=0.1", "tag16h5=0.2"}, "twice"));
  const model::Site known = site();
  CHECK_THROWS_WITH_AS(TagSizes::parse({"36h11:3=0.1"}).check_against(known), doctest::Contains("in the site's map"),
                       InputError);
  CHECK_THROWS_WITH_AS(TagSizes::parse({"16h5=0.1"}).check_against(known), doctest::Contains("not looked for"),
                       InputError);
}

TEST_CASE("tag sizes: a survey of tags of two sizes finds all of them; one without a size stays outside") {
  model::Site truth = site();
  for (model::Tag& tag : truth.tags) tag.size = tag.id % 2 == 0 ? 0.15 : 0.10;
  model::Site blank;
  blank.lens = lens();
  blank.search = truth.search;
  std::vector<std::string> words{"36h11=0.15"};
  for (int id = 1; id < 25; id += 2) words.push_back("36h11:" + std::to_string(id) + "=10 cm");
  const std::vector<View> views = views_of(truth, 40);
  const Calibration found = calibrate(blank, views, {.lens = false, .sizes = TagSizes::parse(words)});
  REQUIRE(found.site.tags.size() == 25);
  for (const model::Tag& a : found.site.tags) {
    CHECK(a.size == truth.tag(a.id)->size);
    for (const model::Tag& b : found.site.tags) {
      const double wanted = (truth.tag(a.id)->p_WT - truth.tag(b.id)->p_WT).norm();
      CHECK(std::abs((a.p_WT - b.p_WT).norm() - wanted) < 1e-3);
    }
  }
  // All alike, every second one would be half as large again: such a map contradicts itself.
  const Calibration wrong = calibrate(blank, views, {.lens = false, .sizes = TagSizes{0.15}});
  CHECK(wrong.after.median > 10.0 * found.after.median);
  words.erase(words.begin());
  const Calibration half = calibrate(blank, views, {.lens = false, .sizes = TagSizes::parse(words)});
  CHECK(half.site.tags.size() == 12);
}

TEST_CASE("map: a tag that its family does not have is refused: it would never be found") {
  model::Site small = site("tag16h5");
  const auto made = [&] { FrontEnd{small, lens(), std::nullopt, {}}; };
  CHECK_NOTHROW(made());
  small.tags.front().id = 30;
  CHECK_THROWS_WITH_AS(made(), doctest::Contains("tag16h5 has 0 to 29"), InputError);
  small.tags.front().id = -1;
  CHECK_THROWS_AS(made(), InputError);
  CHECK(tags_of("36h11") == 587);
}

}  // namespace fathom::vision
