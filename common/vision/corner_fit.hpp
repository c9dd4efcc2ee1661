// Corners of a tag at full resolution: each edge is fitted as a line to where brightness changes fastest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>

#include "common/vision/projection.hpp"

namespace fathom::vision {

/// Moves the corners of a quadrilateral that is dark inside (bright, when `reversed`) to where its edges meet. A corner
/// that cannot be improved, or would move further than the search reaches, stays. Tells which lie on two edges now.
/// `lens`: the one the picture was taken through, where it is known; it bends the edges.
std::array<bool, 4> fit_corners(const cv::Mat& grey, bool reversed, const Projection* lens,
                                std::array<Eigen::Vector2d, 4>& corners);

}  // namespace fathom::vision
