// Tags in a picture: found by the AprilTag library at reduced resolution, their corners fitted at full resolution.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/model/lens.hpp"
#include "common/model/site.hpp"

namespace fathom::vision {

/// What became of a tag.
enum class TagVerdict {
  kAccepted,
  kLowMargin,    ///< nobody else says it must be there
  kOutsideMap,   ///< the site has no such tag
  kCut,          ///< by the picture's border
  kDoubtful,     ///< the site has two of this number
  kTwice,        ///< seen twice in one picture, and this is not the one that fits
  kGeometry,     ///< not where the others say it must be
  kDisagree,     ///< two or more, each alone possible, and nothing says which is right
  kImplausible,  ///< alone, and far from where the camera was just before
};
[[nodiscard]] const char* name(TagVerdict verdict);

/// One tag in one picture.
struct TagSighting {
  std::string family;
  int id{};
  int hamming{};    ///< bits that were corrected
  double margin{};  ///< decision margin of the library, in brightness
  /// px, middle of the first pixel is (0, 0); in the order of the library: T's (-x, +y), (+x, +y), (+x, -y), (-x, -y).
  std::array<Eigen::Vector2d, 4> corners;
  double edge{};              ///< px, mean length of the edges
  std::optional<int> mapped;  ///< number of the site's tag on which this is printed
  TagVerdict verdict{TagVerdict::kAccepted};
  /// False for a corner that the picture's border cuts off: the library closes the outline somewhere.
  std::array<bool, 4> sound{true, true, true, true};
  double reprojection{-1.0};  ///< px, root mean square over the corners; negative where no pose is known
};

struct DetectorSettings {
  std::vector<std::string> families{"tag36h11"};
  double decimation{2.0};  ///< search in pictures so many times smaller; corners are fitted at full resolution
  bool coarser{false};     ///< and in half of that, and so on: large tags with blurred edges show there alone
  bool refine{true};       ///< fit the edges anew at full resolution
};

class TagDetector {
 public:
  /// InputError for a family that the library does not know. `lens`: of pictures of its size; it bends tags' edges.
  explicit TagDetector(const DetectorSettings& settings, const std::optional<model::Lens>& lens = std::nullopt);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// All tags of a grey picture, in the order of family and number. The reference is good until the next call.
  const std::vector<TagSighting>& step(const cv::Mat& grey);
  /// The same in a part of the picture.
  const std::vector<TagSighting>& step(const cv::Mat& grey, const cv::Rect& region);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// How many tags a family has; their numbers begin at 0. InputError for a family that the library does not know.
[[nodiscard]] int tags_of(const std::string& family);
/// InputError when a map names a tag that its family does not have: it would never be found.
void check_map(const model::Site& site);

/// Decision margin that a tag of this family needs when nothing else supports it: random squares pass for tags of weak
/// families.
[[nodiscard]] double least_margin(const std::string& family);

/// A tag as it is printed: one pixel per cell, 0 or 255, with what of a white border belongs to the family.
struct TagCells {
  cv::Mat cells;
  int border{};  ///< cells along the edge of the square whose corners are detected
};
/// InputError for a family or a number that there is none of.
[[nodiscard]] TagCells tag_cells(const std::string& family, int id);

}  // namespace fathom::vision
