// The site file that `fathom calibrate` writes.
#pragma once

#include <string>

#include "common/vision/calibration.hpp"

namespace fathom::pictures {

/// `original` with its camera and tags as adjusted; all else in it stays as it is. Empty: a site for pictures alone.
/// `source`: where the pictures came from. InputError when it cannot be written.
void write_site(const std::string& path, const vision::Calibration& calibration, const std::string& source,
                const std::string& original);

/// The keys of a camera, as sites and vehicle files state them, in one line.
[[nodiscard]] std::string lens_keys(const model::Lens& lens);

}  // namespace fathom::pictures
