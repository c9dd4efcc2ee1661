// The dot of a green laser: looked for along the line in the picture where the beam can be, told from everything else
// that is green or bright, and triangulated.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "common/model/mounts.hpp"
#include "common/vision/projection.hpp"

namespace fathom::vision {

struct LaserSettings {
  double nearest{0.2};          ///< m, of the dot along the camera's axis
  double farthest{4.0};         ///< m
  double strip{4.0};            ///< px to either side of the beam's line that are searched
  double least_contrast{18.0};  ///< above what daylight shows along the beam's line, in brightness
  double largest{9.0};          ///< px, radius of a dot
  double pixel_sigma{0.3};      ///< px, error of its middle along the line
  double halved_sigma{0.9};     ///< px, the same by its colour alone, where colour has half the picture's resolution
};

enum class LaserState {
  kFound,
  kNoColour,
  kDark,
  kTwo,
  kNotRound,
  kClipped,  ///< among pixels that are overexposed
  kOffLine,
  kOutOfRange,
  kPaint,        ///< it moves with the floor
  kAgainstTags,  ///< the floor is elsewhere
  kJumped,       ///< the floor was elsewhere just before
};
[[nodiscard]] const char* name(LaserState state);

struct LaserDot {
  LaserState state{LaserState::kDark};
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  Eigen::Vector3d p_CL{Eigen::Vector3d::Zero()};  ///< m, the dot in C
  double sigma_range{};                           ///< m, along the line of sight
  Eigen::Vector2d peak{Eigen::Vector2d::Zero()};  ///< where it is strongest along the line
  double contrast{};
  double smear{};  ///< px, by which it is longer than a round one
};

class LaserFinder {
 public:
  LaserFinder(const model::Lens& lens, const model::LaserMount& mount, const LaserSettings& settings);
  /// `bgr`: colours in OpenCV's order; a grey picture has no green. `grey`: the same picture's brightness.
  /// `halved_colour`: the picture came with colour at half resolution; brightness, which has all of it, then says where
  /// the dot is that colour found.
  LaserDot step(const cv::Mat& bgr, const cv::Mat& grey, bool halved_colour);

  /// The same in two steps, for who knows more than the picture: every spot on the line, the strongest first (kFound:
  /// it could be the dot; one that says why there is none when there are none), and which of them is the dot.
  /// `paper`: outlines of what is printed on white paper; a spot elsewhere must be green, to be bright is not enough.
  /// Left out: paper may be anywhere.
  using Outline = std::array<Eigen::Vector2d, 4>;  ///< px
  [[nodiscard]] const std::vector<LaserDot>& look(const cv::Mat& bgr, const cv::Mat& grey, bool halved_colour,
                                                  std::optional<std::span<const Outline>> paper = std::nullopt);
  [[nodiscard]] static LaserDot choose(std::span<const LaserDot> spots);
  /// Middle of a spot as strong as `contrast`, about, near a place in some picture of the same light.
  [[nodiscard]] std::optional<Eigen::Vector2d> spot_near(const cv::Mat& bgr, const Eigen::Vector2d& place,
                                                         double contrast) const;
  [[nodiscard]] const std::vector<Eigen::Vector2d>& line() const { return line_; }

 private:
  struct Spot {
    Eigen::Vector2d pixel;
    double strength{};
  };
  void find_daylight(const cv::Mat& bgr);
  void measure_strip(const cv::Mat& bgr);
  [[nodiscard]] double white_at(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool refine(const cv::Mat& bgr, double white, LaserDot& dot) const;
  [[nodiscard]] bool among_clipped(const cv::Mat& bgr, const Eigen::Vector2d& pixel) const;
  double sharpen(const cv::Mat& grey, LaserDot& dot) const;
  void triangulate(double pixel_sigma, LaserDot& dot) const;
  [[nodiscard]] bool has_a_neighbour(std::size_t peak, double typical, double contrast) const;
  [[nodiscard]] double along_beam(const Eigen::Vector2d& pixel) const;

  Projection projection_;
  model::LaserMount mount_;
  LaserSettings settings_;
  std::vector<Eigen::Vector2d> line_;  ///< px, from far to near, a pixel apart
  std::vector<Spot> strip_;
  std::vector<LaserDot> spots_;
  std::vector<double> sorted_;
  std::optional<std::span<const Outline>> paper_;  ///< of this picture
  double white_{255.0};                            ///< brightness in green
  double tint_{1.0};  ///< green over the stronger other colour of what daylight shows in this water
};

}  // namespace fathom::vision
