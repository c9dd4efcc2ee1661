#include "common/vision/threads.hpp"

#include <opencv2/core/utility.hpp>

namespace fathom::vision {

void use_one_core() { cv::setNumThreads(1); }

}  // namespace fathom::vision
