// What was read from a picture, drawn into it: tags with their axes or the reason of their refusal, flow, laser.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/front_end.hpp"

namespace fathom::vision {

/// A colour picture of the front end's last step.
[[nodiscard]] cv::Mat draw(const Picture& picture, const FrontEnd& front_end);

}  // namespace fathom::vision
