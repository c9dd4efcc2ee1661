#include "common/vision/tag_detector.hpp"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
}

#include <algorithm>
#include <cstdlib>
#include <map>
#include <tuple>

#include "common/base/error.hpp"
#include "common/vision/corner_fit.hpp"
#include "common/vision/projection.hpp"

namespace fathom::vision {
namespace {

struct Family {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
  int correctable;  // bits; more than the library's own limit of 2 costs memory and lets false tags pass
  double least_margin;
};

constexpr std::array<Family, 9> kFamilies{{
    {"tag16h5", tag16h5_create, tag16h5_destroy, 0, 11.0},
    {"tag25h9", tag25h9_create, tag25h9_destroy, 1, 6.0},
    {"tag36h10", tag36h10_create, tag36h10_destroy, 1, 3.0},
    {"tag36h11", tag36h11_create, tag36h11_destroy, 2, 3.0},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy, 0, 11.0},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy, 1, 3.0},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy, 1, 3.0},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy, 1, 3.0},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy, 1, 3.0},
}};

// As the library names them, or with its part before the digits left out: "36h11".
const Family* family(const std::string& name) {
  const auto found = std::find_if(kFamilies.begin(), kFamilies.end(), [&](const Family& each) {
    return each.name == name || std::string{each.name} == "tag" + name;
  });
  return found == kFamilies.end() ? nullptr : &*found;
}

const Family* need_family(const std::string& wanted) {
  const Family* known = family(wanted);
  if (known != nullptr) return known;
  std::string all;
  for (const Family& each : kFamilies) all += (all.empty() ? "" : ", ") + std::string{each.name};
  throw InputError("no family of tags is called '" + wanted + "'; known are " + all);
}

// The library closes the outline of a tag that leaves the picture with a corner at the border, pixels from the true
// one. Such a corner lies on no edges that can be fitted anew; a true one does, even just outside the picture.
bool near_border(const cv::Mat& grey, const TagSighting& tag) {
  constexpr double kNear = 8.0, kShare = 0.2;  // px; of an edge: such corners lie up to a cell inside
  return std::any_of(tag.corners.begin(), tag.corners.end(), [&](const Eigen::Vector2d& p) {
    const double inside = std::min({p.x(), p.y(), grey.cols - 1.0 - p.x(), grey.rows - 1.0 - p.y()});
    return inside < std::max(kNear, kShare * tag.edge);
  });
}

double mean_edge(const std::array<Eigen::Vector2d, 4>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += (corners[(i + 1) % 4] - corners[i]).norm();
  return 0.25 * sum;
}

}  // namespace

const char* name(TagVerdict verdict) {
  switch (verdict) {
    case TagVerdict::kAccepted:
      return "accepted";
    case TagVerdict::kLowMargin:
      return "low margin";
    case TagVerdict::kOutsideMap:
      return "outside the map";
    case TagVerdict::kCut:
      return "cut off";
    case TagVerdict::kDoubtful:
      return "twice in the map";
    case TagVerdict::kTwice:
      return "seen twice";
    case TagVerdict::kGeometry:
      return "inconsistent geometry";
    case TagVerdict::kDisagree:
      return "tags disagree";
    case TagVerdict::kImplausible:
      return "implausible pose";
  }
  return "";
}

double least_margin(const std::string& name) {
  const Family* known = family(name);
  return known == nullptr ? 0.0 : known->least_margin;
}

int tags_of(const std::string& name) {
  const Family* known = need_family(name);
  apriltag_family_t* made = known->create();
  const auto count = static_cast<int>(made->ncodes);
  known->destroy(made);
  return count;
}

void check_map(const model::Site& site) {
  std::map<std::string, int> counts;
  for (const model::Tag& tag : site.tags) {
    const std::string& name = site.family_of(tag);
    if (!counts.contains(name)) counts[name] = tags_of(name);
    if (tag.id >= 0 && tag.id < counts[name]) continue;
    throw InputError("the site's map has a tag " + std::to_string(tag.id) + ", and " + name + " has 0 to " +
                     std::to_string(counts[name] - 1) + " alone; 'tag_search' of the site names another family");
  }
}

struct TagDetector::State {
  apriltag_detector_t* detector{};
  std::vector<std::pair<const Family*, apriltag_family_t*>> families;
  DetectorSettings settings;
  std::optional<Projection> projection;
  std::vector<TagSighting> found;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (detector != nullptr) apriltag_detector_destroy(detector);
    for (const auto& [known, made] : families) known->destroy(made);
  }

  // What was found before at a finer scale stays as it is: its corners are better.
  [[nodiscard]] bool is_new(const TagSighting& tag) const {
    const auto middle = [](const TagSighting& each) {
      return Eigen::Vector2d{0.25 * (each.corners[0] + each.corners[1] + each.corners[2] + each.corners[3])};
    };
    return std::none_of(found.begin(), found.end(), [&](const TagSighting& each) {
      return each.id == tag.id && each.family == tag.family && (middle(each) - middle(tag)).norm() < 0.5 * each.edge;
    });
  }

  void look(const cv::Mat& grey, const cv::Rect& region, double decimation) {
    const bool fits = projection && projection->lens().width == grey.cols && projection->lens().height == grey.rows;
    const Projection* lens = fits ? &*projection : nullptr;
    const Eigen::Vector2d origin{region.x - 0.5, region.y - 0.5};  // the library counts from a pixel's outer corner
    const cv::Mat part = region.size() == grey.size() ? grey : grey(region).clone();
    detector->quad_decimate = static_cast<float>(decimation);
    image_u8_t image{part.cols, part.rows, static_cast<int32_t>(part.step), part.data};
    zarray_t* detections = apriltag_detector_detect(detector, &image);
    for (int i = 0; i < zarray_size(detections); ++i) {
      apriltag_detection_t* each = nullptr;
      zarray_get(detections, i, static_cast<void*>(&each));
      TagSighting tag;
      tag.family = each->family->name;
      tag.id = each->id;
      tag.hamming = each->hamming;
      tag.margin = static_cast<double>(each->decision_margin);
      for (std::size_t k = 0; k < 4; ++k) tag.corners[k] = origin + Eigen::Vector2d{each->p[k][0], each->p[k][1]};
      tag.edge = mean_edge(tag.corners);
      if (!is_new(tag)) continue;
      if (settings.refine) {
        const auto fitted = fit_corners(grey, each->family->reversed_border, lens, tag.corners);
        if (near_border(grey, tag)) tag.sound = fitted;
      }
      found.push_back(tag);
    }
    apriltag_detections_destroy(detections);
  }
};

TagDetector::TagDetector(const DetectorSettings& settings, const std::optional<model::Lens>& lens)
    : state_{std::make_unique<State>()} {
  if (lens && (!lens->undistorted() || lens->port)) state_->projection.emplace(*lens);
  state_->detector = apriltag_detector_create();
  state_->detector->nthreads = 1;
  state_->settings = settings;
  for (const std::string& wanted : settings.families) {
    const Family* known = need_family(wanted);
    const bool twice = std::any_of(state_->families.begin(), state_->families.end(),
                                   [&](const auto& each) { return each.first == known; });
    if (twice) continue;
    state_->families.emplace_back(known, known->create());
    apriltag_detector_add_family_bits(state_->detector, state_->families.back().second, known->correctable);
  }
}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

const std::vector<TagSighting>& TagDetector::step(const cv::Mat& grey) {
  return step(grey, {0, 0, grey.cols, grey.rows});
}

const std::vector<TagSighting>& TagDetector::step(const cv::Mat& grey, const cv::Rect& region) {
  State& state = *state_;
  state.found.clear();
  constexpr int kSmallest = 16;  // px: below, no family's cells are pixels any more, and the library's tiles break
  if (region.width < kSmallest || region.height < kSmallest) return state.found;
  constexpr double kLeastSide = 240.0;  // px, of the reduced picture
  double decimation = state.settings.decimation;
  do {
    state.look(grey, region, decimation);
    decimation *= 2.0;
  } while (state.settings.coarser && std::min(region.width, region.height) >= kLeastSide * decimation);
  std::sort(state.found.begin(), state.found.end(), [](const TagSighting& a, const TagSighting& b) {
    return std::tie(a.family, a.id, b.margin) < std::tie(b.family, b.id, a.margin);
  });
  return state.found;
}

TagCells tag_cells(const std::string& name, int id) {
  const Family* known = need_family(name);
  apriltag_family_t* made = known->create();
  TagCells tag{.border = made->width_at_border};
  if (id < 0 || id >= static_cast<int>(made->ncodes)) {
    known->destroy(made);
    throw InputError(std::string{known->name} + " has no tag of number " + std::to_string(id));
  }
  image_u8_t* image = apriltag_to_image(made, id);
  tag.cells.create(image->height, image->width, CV_8UC1);
  for (int y = 0; y < image->height; ++y) {
    std::copy_n(image->buf + y * image->stride, image->width, tag.cells.ptr<std::uint8_t>(y));
  }
  std::free(image->buf);  // the library exports no destructor of it
  std::free(image);
  known->destroy(made);
  return tag;
}

}  // namespace fathom::vision
