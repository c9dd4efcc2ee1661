#include "common/vision/laser/beam_witness.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr std::size_t kPictures = 3;  // that are kept
constexpr double kApart = 3.0;        // px by which the floor moved between two of them
constexpr double kOldest = 2.0;       // s, of a picture and of a distance
constexpr double kTold = 13.0;        // errors of a dot's middle by which beam and floor must differ to be told apart
constexpr double kShare = 0.35;       // of that difference within which a spot is where it is expected
constexpr double kFarthest = 5.0;     // px within which it is
constexpr double kGate = 4.0;         // standard deviations
constexpr double kUneven = 0.05;      // of its distance, by which a floor may be elsewhere than tags or flow say
constexpr double kSlope = 0.3;        // m by which it may rise in a metre along it
constexpr std::size_t kMostPaint = 16;

}  // namespace

BeamWitness::BeamWitness(const model::Lens& lens, const model::LaserMount& mount, const LaserSettings& settings)
    : projection_{lens}, mount_{mount}, settings_{settings} {
  const double z = 2.0 / (1.0 / settings.nearest + 1.0 / settings.farthest);
  middle_ = projection_.pixel(mount.p_CE + (z - mount.p_CE.z()) / mount.axis_C.z() * mount.axis_C);
}

void BeamWitness::reset() {
  earlier_.clear();
  paint_.clear();
  known_.reset();
}

std::optional<Eigen::Vector2d> BeamWitness::on_floor(const Eigen::Matrix3d& floor_10,
                                                     const Eigen::Vector2d& pixel) const {
  constexpr double kAhead = 0.1;
  const Eigen::Vector3d to = floor_10 * projection_.normalized(pixel).homogeneous();
  if (to.z() < kAhead) return {};
  const Eigen::Vector2d there = projection_.pixel(to);
  if (!projection_.inside(there, settings_.largest)) return {};
  return there;
}

void BeamWitness::move(const Flow& flow) {
  if (flow.state != FlowState::kValid) return reset();
  for (Earlier& each : earlier_) {
    each.floor_10 = flow.floor_10 * each.floor_10;
    each.nearing *= flow.nearing;
    each.age += flow.interval;
  }
  std::erase_if(earlier_, [](const Earlier& each) { return each.age > kOldest; });
  for (Paint& each : paint_) each.pixel = on_floor(flow.floor_10, each.pixel).value_or(Eigen::Vector2d{-1.0, -1.0});
  std::erase_if(paint_, [](const Paint& each) { return each.pixel.x() < 0.0; });
  if (!known_) return;
  FloorDistance& floor = known_->floor;
  known_->age += flow.interval;
  floor.distance *= flow.nearing;
  const double along = flow.rate.head<2>().norm() * flow.interval;
  const double grown = std::hypot(kSlope * along, std::sqrt(flow.covariance(2, 2)) * flow.interval) * floor.distance;
  floor.sigma = std::hypot(floor.sigma, grown);
  if (known_->age > kOldest) known_.reset();
}

// Backward: where the floor under the spot was in earlier pictures, and where the beam met it. What is found at the one
// place and not at the other says what the spot is.
BeamWitness::Moves BeamWitness::how_it_moves(const LaserFinder& finder, const LaserDot& spot,
                                             const Eigen::Vector3d& normal_C) const {
  int with_beam = 0, with_floor = 0, beside = 0;  // beside: paint that the spot's middle takes in
  for (const Earlier& each : earlier_) {
    const auto on_floor_then = on_floor(each.floor_10.inverse(), spot.pixel);
    if (!on_floor_then) continue;
    const double distance = normal_C.dot(spot.p_CL) / each.nearing;
    const double s = (distance - each.normal_C.dot(mount_.p_CE)) / each.normal_C.dot(mount_.axis_C);
    const Eigen::Vector3d p_CL = mount_.p_CE + s * mount_.axis_C;
    if (!(p_CL.z() > 0.0)) continue;
    const Eigen::Vector2d on_beam_then = projection_.pixel(p_CL);
    const double apart = (on_beam_then - *on_floor_then).norm();
    if (apart < kTold * settings_.pixel_sigma) continue;
    const double near = std::min(kShare * apart, kFarthest);
    const auto found = finder.spot_near(each.bgr, *on_floor_then, spot.contrast);
    const bool on_beam = found && (*found - on_beam_then).norm() < 0.5 * apart;
    if (found && (*found - *on_floor_then).norm() < near) {
      ++with_floor;
    } else if (found && !on_beam && (*found - *on_floor_then).norm() < 2.0 * settings_.largest) {
      ++beside;
    }
    if (!projection_.inside(on_beam_then, settings_.largest)) continue;
    const auto lit = on_beam ? found : finder.spot_near(each.bgr, on_beam_then, spot.contrast);
    with_beam += lit && (*lit - on_beam_then).norm() < near ? 1 : 0;
  }
  if (beside > 0 && with_floor == 0) return Moves::kBoth;
  if (with_floor > 0) return with_beam > 0 ? Moves::kBoth : Moves::kWithFloor;
  return with_beam > 0 ? Moves::kWithBeam : Moves::kUnknown;
}

// Paint that is known is followed as long as it can be seen, on the beam's line and beside it.
void BeamWitness::find_paint_again(const LaserFinder& finder, const cv::Mat& bgr) {
  for (Paint& each : paint_) {
    const auto found = finder.spot_near(bgr, each.pixel, each.contrast);
    if (!found || (*found - each.pixel).norm() > kFarthest) {
      each.contrast = 0.0;
    } else {
      each.pixel = *found;
    }
  }
  std::erase_if(paint_, [](const Paint& each) { return each.contrast == 0.0; });
}

LaserState BeamWitness::verdict(const LaserFinder& finder, const LaserDot& spot, const Eigen::Vector3d& normal_C,
                                const std::optional<FloorDistance>& by_tags, bool& agrees) {
  agrees = false;
  if (spot.state != LaserState::kFound) return spot.state;
  const Moves moves = how_it_moves(finder, spot, normal_C);
  // Nearer than this to paint, the middle of the spot is that of both.
  const double reach = 1.5 * settings_.largest + kFarthest;
  const bool near_paint = std::any_of(paint_.begin(), paint_.end(),
                                      [&](const Paint& each) { return (each.pixel - spot.pixel).norm() < reach; });
  if (moves == Moves::kWithFloor && !near_paint && paint_.size() < kMostPaint) {
    paint_.push_back({.pixel = spot.pixel, .contrast = spot.contrast});
  }
  if (moves == Moves::kWithFloor || moves == Moves::kBoth || near_paint) return LaserState::kPaint;
  const double distance = normal_C.dot(spot.p_CL);
  const auto beyond = [&](const FloorDistance& floor) {
    const double gate = kGate * std::hypot(floor.sigma, spot.sigma_range) + kUneven * floor.distance;
    return std::abs(distance - floor.distance) > gate;
  };
  const bool with_beam = moves == Moves::kWithBeam;
  if (by_tags) {
    // A glint of the beam in its window goes along with it as the dot does: several tags are believed, and a range to
    // what stands on the floor is not told. A lone tag may be in a wrong place, or of a wrong size.
    const bool nearer = by_tags->lone_tag && with_beam && distance < by_tags->distance;
    if (beyond(*by_tags)) return nearer ? spot.state : LaserState::kAgainstTags;
    agrees = true;
    return spot.state;
  }
  if (known_ && beyond(known_->floor) && !with_beam) return LaserState::kJumped;
  agrees = with_beam;
  return spot.state;
}

void BeamWitness::keep(const cv::Mat& bgr, const Eigen::Vector3d& normal_C) {
  if (!earlier_.empty()) {
    const auto moved = on_floor(earlier_.back().floor_10, middle_);
    if (moved && (*moved - middle_).norm() < kApart) return;
  }
  Earlier now;
  if (earlier_.size() == kPictures) {
    now.bgr = earlier_.front().bgr;  // its memory
    earlier_.erase(earlier_.begin());
  }
  bgr.copyTo(now.bgr);
  now.normal_C = normal_C;
  earlier_.push_back(now);
}

LaserDot BeamWitness::judge(LaserFinder& finder, const cv::Mat& bgr, const std::vector<LaserDot>& spots,
                            const Eigen::Vector3d& normal_C, const std::optional<FloorDistance>& by_tags) {
  find_paint_again(finder, bgr);
  std::vector<LaserDot> possible, agreeing;
  LaserDot refused = spots.front();
  for (const LaserDot& spot : spots) {
    bool agrees = false;
    const LaserState state = verdict(finder, spot, normal_C, by_tags, agrees);
    if (agrees) agreeing.push_back(spot);
    if (state == spot.state) {
      possible.push_back(spot);
    } else if (refused.state == LaserState::kFound) {
      refused = spot;
      refused.state = state;
    }
  }
  keep(bgr, normal_C);
  const std::vector<LaserDot>& chosen = agreeing.empty() ? possible : agreeing;
  LaserDot dot = chosen.empty() ? refused : LaserFinder::choose(chosen);
  if (dot.state == LaserState::kFound) known_ = {.floor = {normal_C.dot(dot.p_CL), dot.sigma_range}};
  return dot;
}

}  // namespace fathom::vision
