// What a camera's lens does, as files state it: focal lengths, centre, distortion, and the flat window of a housing.
// The mathematics is in common/vision/projection.
#pragma once

#include <array>
#include <optional>

namespace fathom {
class Config;
}

namespace fathom::model {

/// A flat window square to the optical axis, air behind it, water before it.
struct FlatPort {
  double distance{};          ///< m, from the lens to the window's inner side
  double thickness{};         ///< m, of the window
  double index_window{1.49};  ///< refractive index against air: acrylic
  double index_water{1.333};  ///< refractive index against air
};

struct Lens {
  enum class Kind { kPinhole, kFisheye };
  static constexpr int kMostCoefficients = 5;

  Kind kind{Kind::kPinhole};
  int width{};        ///< px
  int height{};       ///< px
  double fx{}, fy{};  ///< px
  double cx{}, cy{};  ///< px; the middle of the first pixel is (0, 0), as OpenCV counts
  /// Pinhole: k1 k2 p1 p2 k3 (Brown, Conrady); fisheye: k1 k2 k3 k4 (Kannala, Brandt). As OpenCV's calibrations.
  std::array<double, kMostCoefficients> distortion{};
  std::optional<FlatPort> port;  ///< left out: calibrated in the medium it looks through

  /// Keys `width height focal`, and if stated `centre distortion lens port`.
  [[nodiscard]] static Lens from(const Config& config);
  /// No coefficient at all: rendered pictures have such a lens, of real ones those that nobody calibrated.
  [[nodiscard]] bool undistorted() const { return kind == Kind::kPinhole && distortion == decltype(distortion){}; }
  [[nodiscard]] double focal() const { return 0.5 * (fx + fy); }
};

}  // namespace fathom::model
