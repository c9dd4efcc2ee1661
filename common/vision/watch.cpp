#include "common/vision/watch.hpp"

#include <algorithm>
#include <cmath>

#include "common/vision/drawing.hpp"
#include "common/vision/jpeg.hpp"

namespace fathom::vision {
namespace {

FrontEndSettings with_families(FrontEndSettings settings, const model::Site& site) {
  settings.detector.families = site.search.families;
  return settings;
}

}  // namespace

Watch::Watch(const model::Site& site, const model::CameraMount& camera, const std::optional<model::LaserMount>& laser,
             FrontEndSettings settings)
    : camera_{camera},
      map_complaint_{site.doubts()},
      front_end_{site, camera.lens, laser, with_families(std::move(settings), site)},
      complaint_{map_complaint_} {}

bool Watch::see(const Camera& sample) {
  ++counts_["pictures"];
  const bool colour = front_end_.laser() != nullptr;
  std::string problem = decode_jpeg(sample.jpeg, colour, picture_.grey, picture_.bgr);
  picture_.halved_colour = colour && halves_colour(sample.jpeg);
  readable_ = problem.empty();
  if (!readable_) {
    ++counts_["corrupt"];
    complaint_ = problem + "; see the camera's line and driver";
    front_end_.skip();
    return false;
  }
  if (sample.utime <= last_) {
    ++counts_["out of order"];
    front_end_.skip();
    return true;
  }
  std::optional<Eigen::Matrix3d> R_WC, turned;
  const Eigen::Matrix3d& R_BC = camera_.mount.R_BS;
  if (const auto turn = attitudes_.turn(tracked_, sample.utime))
    turned = R_BC.transpose() * turn->toRotationMatrix() * R_BC;
  last_ = sample.utime;
  picture_.utime = sample.utime;
  scatter_.step(sample.utime);
  picture_.stamp_sigma = scatter_.sigma();
  judge_stamps();
  if (const auto q_WB = attitudes_.at(sample.utime)) R_WC = q_WB->toRotationMatrix() * R_BC;
  const Sight& sight = front_end_.step(picture_, R_WC, turned);
  const bool again = sight.picture == PictureState::kRepeated || sight.picture == PictureState::kFrozen;
  if (!again) tracked_ = sample.utime;
  complaint_ = map_complaint_.empty() ? scatter_complaint_ : map_complaint_;
  if (sight.picture == PictureState::kOtherSize) {
    complaint_ = "pictures have " + std::to_string(picture_.grey.cols) + " x " + std::to_string(picture_.grey.rows) +
                 " pixels, camera '" + camera_.name + "' of the vehicle file " + std::to_string(camera_.width) + " x " +
                 std::to_string(camera_.height);
  } else if (sight.picture != PictureState::kGood && sight.picture != PictureState::kRepeated) {
    complaint_ = std::string{"pictures of camera '"} + camera_.name + "' are " + name(sight.picture);
  }
  count();
  return true;
}

// Flow's scale errs by twice the square of what stamps err, in intervals: 1 % where they err by 7 %.
void Watch::judge_stamps() {
  constexpr double kScatter = 0.07, kQuiet = 0.05;  // of an interval
  const double share = scatter_.sigma() / std::max(scatter_.interval(), 1e-6);
  if (share < kQuiet) {
    scatter_complaint_.clear();
  } else if (share > kScatter && scatter_complaint_.empty()) {
    scatter_complaint_ =
        "stamps of camera '" + camera_.name + "' scatter by " + std::to_string(std::lround(1e3 * scatter_.sigma())) +
        " ms: speeds by optical flow err with them; state 'rate' or 'stamp: kernel' of camera_driver, or "
        "relieve its host";
  }
}

void Watch::count() {
  const Sight& sight = front_end_.sight();
  if (sight.picture != PictureState::kGood) ++counts_[name(sight.picture)];
  for (const TagSighting& tag : sight.tags) ++counts_[std::string{"tags "} + name(tag.verdict)];
  if (sight.fix) ++counts_[sight.fix->ambiguous ? "poses ambiguous" : "poses"];
  ++counts_[std::string{"flow "} + name(sight.flow.state)];
  if (sight.laser) ++counts_[std::string{"laser "} + name(sight.laser->state)];
}

void Watch::reset() {
  front_end_.reset();
  attitudes_.reset();
  scatter_.reset();
  last_ = 0;
  tracked_ = 0;
}

std::optional<Camera> Watch::drawing(int quality) const {
  if (!readable_) return {};
  const cv::Mat drawn = draw(picture_, front_end_);
  return Camera{.utime = picture_.utime,
                .camera = camera_.name,
                .width = drawn.cols,
                .height = drawn.rows,
                .jpeg = encode_jpeg(drawn, quality)};
}

std::string Watch::counts() const {
  std::string text;
  for (const auto& [what, n] : counts_) text += (text.empty() ? "" : ", ") + what + " " + std::to_string(n);
  return text;
}

}  // namespace fathom::vision
