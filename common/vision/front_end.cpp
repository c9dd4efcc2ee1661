#include "common/vision/front_end.hpp"

#include <cmath>
#include <opencv2/core.hpp>

#include "common/base/config.hpp"
#include "common/base/error.hpp"

namespace fathom::vision {

FrontEndSettings FrontEndSettings::from(const Config& config) {
  FrontEndSettings s;
  const auto positive = [](const Config& section, const char* key, const char* unit, double& to) {
    if (section.has(key)) to = section.positive(key, unit);
  };
  if (config.has("tags")) {
    const Config tags = config.section("tags");
    positive(tags, "decimation", "", s.detector.decimation);
    if (s.detector.decimation < 1.0) tags.fail("decimation", "'decimation' is 1 (none) or more");
    positive(tags, "corner_sigma", "", s.locator.corner_sigma);
    positive(tags, "gate", "", s.locator.gate);
    positive(tags, "memory", "s", s.locator.memory);
    positive(tags, "largest_speed", "m/s", s.locator.largest_speed);
    positive(tags, "attitude_sigma", "rad", s.locator.attitude_sigma);
  }
  if (config.has("flow")) {
    const Config flow = config.section("flow");
    positive(flow, "reduction", "", s.flow.reduction);
    if (s.flow.reduction < 1.0) flow.fail("reduction", "'reduction' is 1 (none) or more");
    if (flow.has("most_tracks")) s.flow.most_tracks = flow.integer("most_tracks");
    if (flow.has("least_tracks")) s.flow.least_tracks = flow.integer("least_tracks");
    if (s.flow.least_tracks < 4 || s.flow.most_tracks < s.flow.least_tracks) {
      flow.fail("least_tracks", "'least_tracks' is 4 or more, and 'most_tracks' not below it");
    }
    positive(flow, "least_share", "", s.flow.least_share);
    positive(flow, "there_and_back", "", s.flow.there_and_back);
    positive(flow, "longest_interval", "s", s.flow.longest_interval);
    positive(flow, "rotation_sigma", "rad/s", s.flow.rotation_sigma);
  }
  if (config.has("laser")) {
    const Config laser = config.section("laser");
    positive(laser, "nearest", "m", s.laser.nearest);
    positive(laser, "farthest", "m", s.laser.farthest);
    if (s.laser.farthest <= s.laser.nearest) laser.fail("farthest", "'farthest' must be more than 'nearest'");
    positive(laser, "strip", "", s.laser.strip);
    positive(laser, "least_contrast", "", s.laser.least_contrast);
    positive(laser, "largest", "", s.laser.largest);
    positive(laser, "pixel_sigma", "", s.laser.pixel_sigma);
    positive(laser, "halved_sigma", "", s.laser.halved_sigma);
  }
  return s;
}

FrontEnd::FrontEnd(const model::Site& site, const std::optional<model::Lens>& lens,
                   const std::optional<model::LaserMount>& laser, const FrontEndSettings& settings)
    : site_{site},
      lens_{lens},
      settings_{settings},
      detector_{settings.detector, lens},
      locator_{site, lens, settings.locator},
      loose_locator_{site, std::nullopt, settings.locator},
      floor_{site.floor} {
  check_map(site);
  if (settings.detector.decimation > 1.0) {
    DetectorSettings near = settings.detector;
    near.decimation = 1.0;
    near.coarser = false;
    near_detector_.emplace(near, lens);
  }
  if (lens) tracker_.emplace(*lens, settings.flow);
  if (lens && laser) {
    laser_.emplace(*lens, *laser, settings.laser);
    witness_.emplace(*lens, *laser, settings.laser);
    tracker_->leave_out(laser_->line(), settings.laser.strip + settings.laser.largest);
  }
  if (site.floor <= site.surface && !site.tags.empty()) {  // no water stated: the tags lie on it
    floor_ = 0.0;
    for (const model::Tag& tag : site.tags) floor_ += tag.p_WT.z() / static_cast<double>(site.tags.size());
  }
}

void FrontEnd::reset() {
  locator_.reset();
  if (tracker_) tracker_->reset();
  if (witness_) witness_->reset();
  check_.reset();
  attitude_before_.reset();
  fix_before_.reset();
  range_utime_.reset();
  utime_ = tracked_ = 0;
  last_range_ = 0.0;
}

const std::vector<Track>& FrontEnd::tracks() const {
  static const std::vector<Track> none;
  return tracker_ ? tracker_->tracks() : none;
}

// Tags that must be there and were not found at reduced resolution: looked for at full resolution where they must be.
bool FrontEnd::look_again(const cv::Mat& grey) {
  constexpr double kSmallest = 14.0, kMargin = 0.6;  // px; share of the tag's extent
  constexpr std::size_t kMost = 3;                   // regions in a picture: time
  bool more = false;
  std::size_t looked = 0;
  for (const auto& [printed, corners] : locator_.missing(*sight_.fix, sight_.tags)) {
    Eigen::Vector2d low = corners[0], high = corners[0];
    for (const Eigen::Vector2d& each : corners) {
      low = low.cwiseMin(each);
      high = high.cwiseMax(each);
    }
    if ((high - low).minCoeff() < kSmallest || ++looked > kMost) continue;
    const double margin = kMargin * (high - low).maxCoeff();
    const cv::Rect whole{0, 0, grey.cols, grey.rows};
    const cv::Rect region =
        whole & cv::Rect{cv::Point{static_cast<int>(low.x() - margin), static_cast<int>(low.y() - margin)},
                         cv::Point{static_cast<int>(high.x() + margin) + 1, static_cast<int>(high.y() + margin) + 1}};
    for (const TagSighting& tag : near_detector_->step(grey, region)) {
      if (tag.id != printed.id || !model::same_family(tag.family, printed.family)) continue;
      sight_.tags.push_back(tag);
      more = true;
      break;
    }
  }
  return more;
}

void FrontEnd::find_dot(const Picture& picture, const std::optional<Eigen::Vector3d>& normal_C) {
  witness_->move(sight_.flow);
  constexpr double kBorder = 1.5;  // of a tag's extent: the white border that it is printed on
  paper_.clear();
  for (const TagSighting& tag : sight_.tags) {
    const Eigen::Vector2d middle = 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
    paper_.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) paper_.back()[i] = middle + kBorder * (tag.corners[i] - middle);
  }
  const auto& spots = laser_->look(picture.bgr, picture.grey, picture.halved_colour, paper_);
  std::optional<FloorDistance> by_tags;
  if (sight_.fix && !sight_.fix->ambiguous && floor_ > sight_.fix->pose.p_WC.z()) {
    by_tags = {.distance = floor_ - sight_.fix->pose.p_WC.z(),
               .sigma = std::sqrt(sight_.fix->covariance(2, 2)),
               .lone_tag = sight_.fix->n_tags == 1};
  }
  const Eigen::Vector3d normal = normal_C.value_or(Eigen::Vector3d::UnitZ());
  sight_.laser = witness_->judge(*laser_, picture.bgr, spots, normal, by_tags);
}

// Distance along the axis to the floor. The laser's dot lies elsewhere on it: the floor's normal leads there.
void FrontEnd::find_range(const std::optional<Eigen::Vector3d>& normal_C) {
  if (sight_.laser && sight_.laser->state == LaserState::kFound) {
    const Eigen::Vector3d n = normal_C.value_or(Eigen::Vector3d::UnitZ());
    if (std::abs(n.z()) > 0.2) {
      sight_.range = n.dot(sight_.laser->p_CL) / n.z();
      sight_.range_sigma = sight_.laser->sigma_range;
    }
  }
  if (!sight_.range && sight_.fix && !sight_.fix->ambiguous) {
    const Pose& pose = sight_.fix->pose;
    const double down = pose.R_WC(2, 2), height = floor_ - pose.p_WC.z();
    if (down > 0.2 && height > 0.0) {
      sight_.range = height / down;
      sight_.range_sigma = std::sqrt(sight_.fix->covariance(2, 2)) / down;
    }
  }
  if (sight_.range) {
    last_range_ = *sight_.range;
    last_range_sigma_ = sight_.range_sigma;
    range_utime_ = utime_;
  }
}

// A sensor's rotation was taken between two stamps; each of them errs.
Eigen::Matrix3d FrontEnd::sensor_turn_covariance(const Picture& picture, const Eigen::Matrix3d& turn) const {
  const double interval = std::max(seconds_between(tracked_, picture.utime), 1e-6);
  const Eigen::Vector3d w = rotation_vector_from_quaternion(Eigen::Quaterniond{turn}) / interval;  // rad/s
  const double sensor = settings_.flow.rotation_sigma * interval;
  return sensor * sensor * Eigen::Matrix3d::Identity() +
         2.0 * picture.stamp_sigma * picture.stamp_sigma * w * w.transpose();
}

const Sight& FrontEnd::step(const Picture& picture, const std::optional<Eigen::Matrix3d>& R_WC,
                            const std::optional<Eigen::Matrix3d>& gyro_R_01) {
  const bool same_size = !lens_ || (picture.grey.cols == lens_->width && picture.grey.rows == lens_->height);
  sight_ = {};
  utime_ = picture.utime;
  sight_.picture = check_.step(picture.grey, lens_ ? &*lens_ : nullptr);
  sight_.flow.utime = picture.utime;
  if (sight_.picture == PictureState::kBlack || sight_.picture == PictureState::kSaturated || !same_size) {
    if (tracker_) tracker_->reset();
    if (witness_) witness_->reset();
    attitude_before_.reset();
    fix_before_.reset();
    if (same_size) return sight_;
    sight_.tags = detector_.step(picture.grey);
    static_cast<void>(loose_locator_.step(picture.utime, sight_.tags, std::nullopt));
    return sight_;
  }
  // It was taken before: its tags would be too young, and flow waits for the next one, from the one that was new.
  if (sight_.picture == PictureState::kRepeated || sight_.picture == PictureState::kFrozen) return sight_;
  sight_.tags = detector_.step(picture.grey);
  std::optional<Eigen::Vector3d> down_C;
  if (R_WC) down_C = R_WC->row(2);
  sight_.fix = locator_.step(picture.utime, sight_.tags, down_C);
  if (sight_.fix && !sight_.fix->ambiguous && near_detector_ && look_again(picture.grey)) {
    sight_.fix = locator_.step(picture.utime, sight_.tags, down_C);
  }
  if (!lens_) return sight_;
  std::optional<CameraFix> fixed;
  if (sight_.fix && !sight_.fix->ambiguous) fixed = sight_.fix;
  if (!down_C && fixed) down_C = fixed->pose.R_WC.row(2);

  std::optional<Eigen::Matrix3d> turn, turn_covariance;
  if (gyro_R_01) {
    turn = gyro_R_01;
  } else if (R_WC && attitude_before_) {
    turn = attitude_before_->transpose() * *R_WC;
  } else if (!R_WC && fixed && fix_before_) {
    turn = fix_before_->pose.R_WC.transpose() * fixed->pose.R_WC;
    turn_covariance = fix_before_->covariance.bottomRightCorner<3, 3>() +
                      *turn * fixed->covariance.bottomRightCorner<3, 3>() * turn->transpose();
  }
  attitude_before_ = R_WC;
  fix_before_ = fixed;
  if (turn && !turn_covariance && picture.stamp_sigma > 0.0)
    turn_covariance = sensor_turn_covariance(picture, turn.value());
  sight_.flow = tracker_->step(picture.utime, picture.grey, turn, down_C, turn_covariance);
  tracked_ = picture.utime;
  if (sight_.flow.interval > 0.0) {
    const double share = std::sqrt(2.0) * picture.stamp_sigma / sight_.flow.interval;
    sight_.flow.covariance += share * share * sight_.flow.rate * sight_.flow.rate.transpose();
  }
  if (laser_ && !picture.bgr.empty()) find_dot(picture, down_C);
  find_range(down_C);
  const bool fresh = range_utime_ && seconds_between(*range_utime_, picture.utime) <= settings_.range_memory;
  if (sight_.flow.state == FlowState::kValid && fresh) {
    const double z = last_range_ * sight_.flow.middle_distance;
    sight_.v_C = z * sight_.flow.rate;
    sight_.v_covariance = z * z * sight_.flow.covariance +
                          last_range_sigma_ * last_range_sigma_ * sight_.flow.rate * sight_.flow.rate.transpose();
  }
  return sight_;
}

std::vector<TagPose> FrontEnd::tag_poses(const std::string& camera) const {
  std::vector<TagPose> poses;
  if (!sight_.fix || sight_.fix->ambiguous || sight_.picture != PictureState::kGood) return poses;
  for (const TagSighting& tag : sight_.tags) {
    if (tag.verdict != TagVerdict::kAccepted) continue;
    const auto [p_CT, R_CT] = locator_.in_camera(*sight_.fix, *tag.mapped);
    poses.push_back({.utime = utime_,
                     .camera = camera,
                     .tag = *tag.mapped,
                     .p_CT = p_CT,
                     .q_CT = Eigen::Quaterniond{R_CT},
                     .reprojection_error = tag.reprojection});
  }
  return poses;
}

std::optional<OpticalFlow> FrontEnd::optical_flow(const std::string& camera) const {
  const Flow& flow = sight_.flow;
  if (flow.state != FlowState::kValid || sight_.picture != PictureState::kGood) return {};
  return OpticalFlow{.utime = flow.utime,
                     .camera = camera,
                     .interval = flow.interval,
                     .flow_C = -flow.rate,
                     .covariance = flow.covariance,
                     .n_tracks = flow.n_agreed};
}

std::optional<LaserRange> FrontEnd::laser_range(const std::string& camera) const {
  if (!sight_.laser || sight_.laser->state != LaserState::kFound || sight_.picture != PictureState::kGood) return {};
  return LaserRange{
      .utime = utime_, .camera = camera, .p_CL = sight_.laser->p_CL, .sigma_range = sight_.laser->sigma_range};
}

}  // namespace fathom::vision
