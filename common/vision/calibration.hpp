// Lens and map of tags from a sequence of pictures: bundle adjustment of every corner that was seen. What is known
// beforehand (a surveyed map, a board, a lens) enters with its own sigma.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/model/site.hpp"
#include "common/vision/camera_pose.hpp"
#include "common/vision/tag_detector.hpp"
#include "common/vision/tag_sizes.hpp"

namespace fathom::vision {

/// What one picture shows.
struct View {
  std::string name;
  std::vector<TagSighting> tags;
};

struct CalibrationSettings {
  bool lens{true};           ///< adjust focal lengths, centre and distortion
  int distortion{2};         ///< coefficients that are adjusted: 0, 2 (k1 k2), 4 (all of a fisheye, k1 k2 p1 p2), 5
  bool map{true};            ///< adjust the tags' places; else they are exact: a board
  bool flat{true};           ///< tags lie in one plane to within flat_sigma and flat_turn
  double map_sigma{1e-2};    ///< m, of the places in the map
  double flat_sigma{3e-3};   ///< m, out of the plane
  double flat_turn{0.02};    ///< rad, of a tag's tilt against the plane
  double corner_sigma{0.3};  ///< px
  /// A lens that is given is kept as far as pictures can be explained by it as well; else it is but a beginning.
  bool given{true};
  double focal_sigma{0.1};    ///< share of the focal length that is given
  double centre_sigma{20.0};  ///< px
  TagSizes sizes{};           ///< of tags that are not in the map; others are left out
};

/// A corner in a picture and what is left of it.
struct Residual {
  std::size_t view{};
  int tag{};             ///< its number in the site
  std::size_t corner{};  ///< in the order of sightings
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()}, error{Eigen::Vector2d::Zero()};
};

/// How well lens and map explain pictures: each picture's pose fitted, nothing else.
struct Reprojection {
  std::vector<double> per_view;  ///< px, root mean square, of pictures with two tags or more
  std::vector<Residual> residuals;
  std::vector<Pose> poses;
  double median{}, high{};  ///< px; `high`: 95 % are below
};

struct Calibration {
  model::Site site;  ///< with lens and tags as adjusted
  Reprojection before, after;
  bool converged{};
  std::string message;
  int n_views{}, n_corners{};
  std::array<double, 4> lens_sigma{};  ///< px, of fx fy cx cy; 0 where not adjusted
  /// The focal length that fits as well as the one that was given and kept, for these pictures cannot tell; else
  /// nothing.
  std::optional<double> undetermined_focal{};
};

/// InputError when there is too little to go by.
[[nodiscard]] Calibration calibrate(const model::Site& site, const std::vector<View>& pictures,
                                    const CalibrationSettings& settings);

/// With lens and map of `site` as they are.
[[nodiscard]] Reprojection reproject(const model::Site& site, const std::vector<View>& views);

}  // namespace fathom::vision
