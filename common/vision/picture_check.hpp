// Is a picture worth looking at? Black, saturated and frozen ones are told before anything is read from them.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/model/lens.hpp"

namespace fathom::vision {

/// Repeated: bit by bit the one before, and so nothing new; frozen: several times in a row.
enum class PictureState { kGood, kOtherSize, kBlack, kSaturated, kRepeated, kFrozen };
[[nodiscard]] const char* name(PictureState state);

class PictureCheck {
 public:
  /// `lens`: its size is the one that is expected; nullptr: any.
  PictureState step(const cv::Mat& grey, const model::Lens* lens);
  void reset() {
    before_.release();
    repeated_ = 0;
  }

 private:
  cv::Mat before_;
  int repeated_{};
};

}  // namespace fathom::vision
