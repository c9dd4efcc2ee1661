// Which of the green spots on the beam's line is the laser's dot. What is painted moves with the floor; the dot stays
// on its beam, goes along it only as the floor comes nearer or leans, and the floor under it is dark when it is
// elsewhere. So each spot is sought in earlier pictures: where the floor under it was then, and where the beam was. And
// the floor is where the tags have it, or not far from where it was. All this says nothing while nothing moves, without
// tags, and in a descent along the beam, in which paint in the beam's line does what the dot would do.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/vision/flow/optical_flow.hpp"
#include "common/vision/laser/laser_dot.hpp"

namespace fathom::vision {

/// Distance of the camera to the floor, along the floor's normal.
struct FloorDistance {
  double distance{}, sigma{};  ///< m
  bool lone_tag{false};        ///< told by one tag alone, which nothing confirms
};

class BeamWitness {
 public:
  BeamWitness(const model::Lens& lens, const model::LaserMount& mount, const LaserSettings& settings);

  /// Of every picture, in this order: how the floor moved since the one before; which of its spots is the dot.
  void move(const Flow& flow);
  /// `normal_C`: the floor's, unit, downward. `by_tags`: how far they have the floor.
  LaserDot judge(LaserFinder& finder, const cv::Mat& bgr, const std::vector<LaserDot>& spots,
                 const Eigen::Vector3d& normal_C, const std::optional<FloorDistance>& by_tags);
  void reset();

 private:
  enum class Moves { kUnknown, kWithBeam, kWithFloor, kBoth };
  /// An earlier picture and the floor's motion since.
  struct Earlier {
    cv::Mat bgr;
    Eigen::Matrix3d floor_10{Eigen::Matrix3d::Identity()};
    double nearing{1.0};
    Eigen::Vector3d normal_C{Eigen::Vector3d::UnitZ()};
    double age{};  ///< s
  };
  struct Paint {
    Eigen::Vector2d pixel;
    double contrast{};
  };
  struct Known {
    FloorDistance floor;
    double age{};  ///< s
  };

  [[nodiscard]] Moves how_it_moves(const LaserFinder& finder, const LaserDot& spot,
                                   const Eigen::Vector3d& normal_C) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> on_floor(const Eigen::Matrix3d& floor_10,
                                                        const Eigen::Vector2d& pixel) const;
  void find_paint_again(const LaserFinder& finder, const cv::Mat& bgr);
  [[nodiscard]] LaserState verdict(const LaserFinder& finder, const LaserDot& spot, const Eigen::Vector3d& normal_C,
                                   const std::optional<FloorDistance>& by_tags, bool& agrees);
  void keep(const cv::Mat& bgr, const Eigen::Vector3d& normal_C);

  Projection projection_;
  model::LaserMount mount_;
  LaserSettings settings_;
  std::vector<Earlier> earlier_;  ///< the newest last
  std::vector<Paint> paint_;
  std::optional<Known> known_;                       ///< from the last range that was told
  Eigen::Vector2d middle_{Eigen::Vector2d::Zero()};  ///< px, of the beam's line
};

}  // namespace fathom::vision
