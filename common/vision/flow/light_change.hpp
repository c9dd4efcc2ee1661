// Tracks are found as if light stayed as it was. Where it changes, as under waves, brightness that moves over a feature
// pulls at it. Here a track's end is found anew with the light of its window free, as far as it changes by a factor and
// a plane over it: I_1(to + x) = (1 + g) I_0(from + x) + o + r x (after Jin, Favaro and Soatto 2001).
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace fathom::vision {

struct TrackEnd {
  cv::Point2f at;
  bool near{};  ///< within half a pixel of where it was looked for: farther ones are found by chance
};

/// `from`, `to`: px of `before` and `now` (float). Nothing when the window leaves a picture or has no texture beside
/// what light could have made.
[[nodiscard]] std::optional<TrackEnd> end_in_changed_light(const cv::Mat& before, const cv::Mat& now,
                                                           const cv::Point2f& from, const cv::Point2f& to);

/// Ends that are kept because they are near are drawn to where they were looked for: of its distance from their true
/// mean this share is seen, 1 for `spread` [px, per axis] of 0, and 0 where they lie about as they would by chance.
[[nodiscard]] double share_seen_near(double spread);

}  // namespace fathom::vision
