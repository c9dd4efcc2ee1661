#include "common/vision/picture_check.hpp"

#include <cstring>
#include <opencv2/core.hpp>

namespace fathom::vision {
namespace {

constexpr int kEvery = 4;            // rows and columns that are looked at
constexpr double kDark = 6.0;        // brightness that nothing may exceed in a black picture
constexpr double kBright = 250.0;    // and that saturated pixels reach
constexpr double kMostBright = 0.6;  // share of saturated pixels
constexpr int kRepeats = 3;          // so often in a row is no hiccup; a camera's noise makes no two pictures the same

bool same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

}  // namespace

const char* name(PictureState state) {
  switch (state) {
    case PictureState::kGood:
      return "good";
    case PictureState::kOtherSize:
      return "other size than the calibration";
    case PictureState::kBlack:
      return "black";
    case PictureState::kSaturated:
      return "saturated";
    case PictureState::kRepeated:
      return "the same again";
    case PictureState::kFrozen:
      return "frozen";
  }
  return "";
}

PictureState PictureCheck::step(const cv::Mat& grey, const model::Lens* lens) {
  repeated_ = same(grey, before_) ? repeated_ + 1 : 0;
  if (repeated_ == 0) grey.copyTo(before_);
  if (lens != nullptr && (grey.cols != lens->width || grey.rows != lens->height)) return PictureState::kOtherSize;
  int dark = 0, bright = 0, n = 0;
  for (int y = kEvery / 2; y < grey.rows; y += kEvery) {
    const std::uint8_t* row = grey.ptr<std::uint8_t>(y);
    for (int x = kEvery / 2; x < grey.cols; x += kEvery, ++n) {
      dark += row[x] <= kDark ? 1 : 0;
      bright += row[x] >= kBright ? 1 : 0;
    }
  }
  constexpr double kAll = 0.998;  // hot pixels shine in the dark too
  if (dark >= kAll * n) return PictureState::kBlack;
  if (bright >= kMostBright * n) return PictureState::kSaturated;
  if (repeated_ == 0) return PictureState::kGood;
  return repeated_ >= kRepeats ? PictureState::kFrozen : PictureState::kRepeated;
}

}  // namespace fathom::vision
