// What a camera would see of a floor with tags: texture, water, lens, laser's dot and noise, for tests and for the
// simulator. Not modelled: walls and what swims, motion blur within an exposure, shadows, several bounces of light.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "common/vision/camera_pose.hpp"

namespace fathom {
class Config;
}

namespace fathom::vision {

struct RenderSettings {
  double attenuation{0.25};  ///< 1/m, of light on its way from the floor to the lens; the rest is veil
  double blur{0.6};          ///< px, standard deviation of the lens's and the water's blur
  double vignetting{0.35};   ///< share of light that the corners of the picture lack
  double noise{2.0};         ///< brightness, standard deviation
  double caustics{0.15};     ///< share by which the surface's waves modulate light
  double texture{0.25};      ///< contrast of the floor
  double brightness{0.8};    ///< of white paper, of the largest
  double dot{4e-3};          ///< m, radius of the laser's spot on the floor
  double laser{1.5};         ///< brightness of its middle against the largest; above 1 it saturates
  double grain{2e-3};        ///< m, of the floor's picture

  [[nodiscard]] static RenderSettings from(const Config& config);
};

class Renderer {
 public:
  /// The floor is that of the site, or the plane of its tags. InputError for tags that the family does not have.
  Renderer(const model::Site& site, const model::Lens& lens, const std::optional<model::LaserMount>& laser,
           const RenderSettings& settings, std::uint64_t seed);

  /// Colour picture at `t` [s]: time moves the caustics and draws the noise.
  const cv::Mat& step(double t, const Pose& pose);
  /// Where the laser's dot is, in C; nothing when the beam misses the floor or leaves the picture.
  [[nodiscard]] std::optional<Eigen::Vector3d> dot(const Pose& pose) const;

 private:
  void paint_floor(std::uint64_t seed);
  void paint_tag(const model::Tag& tag);
  void map_floor(const Pose& pose);
  void light(double t);
  void add_dot(const Pose& pose);

  model::Site site_;
  Projection projection_;
  std::optional<model::LaserMount> laser_;
  RenderSettings settings_;
  double floor_{};
  Eigen::Vector2d corner_{Eigen::Vector2d::Zero()};  ///< m, in W, of the floor's picture
  std::vector<cv::Mat> floor_pictures_;              ///< each half as large as the one before
  cv::Mat rays_, vignette_, noise_;
  cv::Mat map_, flat_, light_, small_light_, bgr_float_, bgr_;
  double distance_{};
  std::uint64_t seed_{};
};

}  // namespace fathom::vision
