// The site file that `fathom calibrate` writes.
#pragma once

#include <string>

#include "common/vision/calibration.hpp"

namespace fathom::pictures {

/// Camera and tags, readable as a site for pictures.
void write_site(const std::string& path, const vision::Calibration& calibration, const std::string& source);

}  // namespace fathom::pictures
