#include "common/model/lens.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/config.hpp"
#include "common/model/priors/bounded.hpp"

namespace fathom::model {
namespace {

constexpr double kThickestIndex = 3.0;  // no window's nor water's index comes near

FlatPort port_from(const Config& config) {
  FlatPort port{.distance = bounded::not_negative(config, "distance", "m"),
                .thickness = bounded::not_negative(config, "thickness", "m")};
  const auto index = [&](const char* key, double& to) {
    if (!config.has(key)) return;
    to = bounded::positive(config, key, "");
    if (to < 1.0 || to > kThickestIndex) config.fail(key, std::string{"'"} + key + "' is a refractive index: 1 to 3");
  };
  index("index_window", port.index_window);
  index("index_water", port.index_water);
  return port;
}

}  // namespace

Lens Lens::from(const Config& config) {
  Lens lens{.width = config.integer("width"), .height = config.integer("height")};
  if (lens.width <= 0) config.fail("width", "'width' must be positive");
  if (lens.height <= 0) config.fail("height", "'height' must be positive");
  const std::vector<double> focal = bounded::quantities(config, "focal", "");
  if (focal.size() > 2 || *std::min_element(focal.begin(), focal.end()) <= 0.0) {
    config.fail("focal", "'focal' must be one or two positive numbers of pixels: along the picture, and down it");
  }
  lens.fx = focal.front();
  lens.fy = focal.back();
  lens.cx = 0.5 * (lens.width - 1);
  lens.cy = 0.5 * (lens.height - 1);
  if (config.has("centre")) {
    const std::vector<double> centre = bounded::quantities(config, "centre", "");
    if (centre.size() != 2) config.fail("centre", "'centre' must be two numbers of pixels");
    lens.cx = centre[0];
    lens.cy = centre[1];
  }
  if (config.has("lens")) lens.kind = config.either("lens", "fisheye", "pinhole") ? Kind::kFisheye : Kind::kPinhole;
  if (config.has("distortion")) {
    const std::vector<double> given = bounded::quantities(config, "distortion", "");
    const std::size_t most = lens.kind == Kind::kFisheye ? 4 : kMostCoefficients;
    if (given.size() > most) {
      config.fail("distortion", lens.kind == Kind::kFisheye ? "a fisheye has at most four coefficients: k1 k2 k3 k4"
                                                            : "at most five coefficients are known: k1 k2 p1 p2 k3");
    }
    std::copy(given.begin(), given.end(), lens.distortion.begin());
  }
  if (config.has("port")) lens.port = port_from(config.section("port"));
  return lens;
}

}  // namespace fathom::model
