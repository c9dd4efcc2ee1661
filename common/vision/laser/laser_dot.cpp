#include "common/vision/laser/laser_dot.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/vision/laser/bright_spot.hpp"

namespace fathom::vision {
namespace {

constexpr int kSaturated = 250;
constexpr double kRival = 0.6;      // share of the strongest from which anything else on the line is a rival
constexpr double kDimRival = 0.25;  // the same of a spot that could be the dot itself, over a darker floor
constexpr std::size_t kMostSpots = 4;
constexpr double kValley = 0.3;  // of the contrast, by which two peaks in one spot stand above what is between them
constexpr double kOutstanding = 8.0;  // spreads of the strip's excess
constexpr double kReach = 2.5;        // sigmas of a dot's place by colour that its place by brightness may be off
constexpr double kAlone = 2.0;     // times the contrast asked for, where colour is blurred and brightness shows no dot
constexpr double kRoundest = 3.0;  // ratio of a dot's axes; seen slanting it is an ellipse
constexpr double kRound = 1.25;    // the same up to which nothing else is likely to be in it

// How much a pixel is more than daylight: greener than `tint`, the water's share of green, which white paper and dark
// floor have alike, or brighter than the picture's white. The first shows on a floor; on paper the dot clips, JPEG
// smears its colour, and the second remains.
double excess(const cv::Mat& bgr, double tint, double white, int x, int y) {
  const cv::Vec3b c = bgr.at<cv::Vec3b>(std::clamp(y, 0, bgr.rows - 1), std::clamp(x, 0, bgr.cols - 1));
  return std::max(c[1] - tint * std::max(c[0], c[2]), 0.0) + std::max(c[1] - white, 0.0);
}

}  // namespace

const char* name(LaserState state) {
  switch (state) {
    case LaserState::kFound:
      return "found";
    case LaserState::kNoColour:
      return "grey picture";
    case LaserState::kDark:
      return "no green spot";
    case LaserState::kTwo:
      return "more than one spot";
    case LaserState::kNotRound:
      return "not a dot";
    case LaserState::kClipped:
      return "among overexposed pixels";
    case LaserState::kOffLine:
      return "not on the beam";
    case LaserState::kOutOfRange:
      return "out of range";
    case LaserState::kPaint:
      return "moves with the floor";
    case LaserState::kAgainstTags:
      return "not where tags have the floor";
    case LaserState::kJumped:
      return "not where the floor was";
  }
  return "";
}

LaserFinder::LaserFinder(const model::Lens& lens, const model::LaserMount& mount, const LaserSettings& settings)
    : projection_{lens}, mount_{mount}, settings_{settings} {
  // Equal steps of inverse distance are nearly equal steps in the picture.
  constexpr int kSteps = 4000;
  const bool folds = projection_.folds();
  for (int i = 0; i <= kSteps; ++i) {
    const double inverse =
        1.0 / settings.farthest + (1.0 / settings.nearest - 1.0 / settings.farthest) * static_cast<double>(i) / kSteps;
    const double s = (1.0 / inverse - mount.p_CE.z()) / mount.axis_C.z();
    const Eigen::Vector3d p_C = mount.p_CE + s * mount.axis_C;
    if (!(s > 0.0) || !(p_C.z() > 0.0)) continue;
    const Eigen::Vector2d pixel = projection_.pixel(p_C);
    if (!projection_.inside(pixel, 1.0)) continue;
    if (folds && !projection_.sees(pixel)) break;  // nearer, it only seems to come back
    if (line_.empty() || (pixel - line_.back()).norm() >= 1.0) line_.push_back(pixel);
  }
}

// White is what one pixel of a hundred exceeds; the tint is the median share of green along the line. The dot moves
// neither.
void LaserFinder::find_daylight(const cv::Mat& bgr) {
  constexpr int kEvery = 5;
  constexpr double kBrighter = 0.01;
  std::array<int, 256> count{};
  int n = 0;
  for (int y = 0; y < bgr.rows; y += kEvery) {
    const cv::Vec3b* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; x += kEvery, ++n) ++count[row[x][1]];
  }
  int white = 255;
  for (int above = count[255]; white > 0 && above < kBrighter * n;) above += count[static_cast<std::size_t>(--white)];
  white_ = white;
  constexpr double kMost = 3.0, kDark = 8.0;
  sorted_.clear();
  for (const Eigen::Vector2d& p : line_) {
    const cv::Vec3b& c = bgr.at<cv::Vec3b>(static_cast<int>(std::lround(p.y())), static_cast<int>(std::lround(p.x())));
    const double other = std::max(c[0], c[2]);
    if (other > kDark && c[1] < kSaturated) sorted_.push_back(c[1] / other);
  }
  tint_ = 1.0;
  if (sorted_.empty()) return;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  tint_ = std::clamp(*middle, 1.0, kMost);
}

// Brightness that nothing printed exceeds. On a floor without paper a shell is the brightest, and no dot.
double LaserFinder::white_at(const Eigen::Vector2d& pixel) const {
  constexpr double kNone = 1e3;
  if (!paper_) return white_;
  const bool on_paper = std::any_of(paper_->begin(), paper_->end(), [&](const Outline& outline) {
    int to_the_left = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i], to = pixel - outline[i];
      to_the_left += edge.x() * to.y() - edge.y() * to.x() > 0.0 ? 1 : 0;
    }
    return to_the_left == 0 || to_the_left == static_cast<int>(outline.size());
  });
  return on_paper ? white_ : kNone;
}

// Among pixels that are overexposed a dot does not show; what does is its fringe, off its middle.
bool LaserFinder::among_clipped(const cv::Mat& bgr, const Eigen::Vector2d& pixel) const {
  constexpr double kShare = 0.2;
  const double inner = 0.6 * settings_.largest, outer = 1.5 * settings_.largest;
  int clipped = 0, n = 0;
  for (int y = static_cast<int>(pixel.y() - outer); y <= static_cast<int>(pixel.y() + outer); ++y) {
    for (int x = static_cast<int>(pixel.x() - outer); x <= static_cast<int>(pixel.x() + outer); ++x) {
      const double r = (Eigen::Vector2d{x, y} - pixel).norm();
      if (x < 0 || y < 0 || x >= bgr.cols || y >= bgr.rows || r < inner || r > outer) continue;
      ++n;
      const cv::Vec3b& c = bgr.at<cv::Vec3b>(y, x);
      clipped += c[1] >= kSaturated && c[1] - tint_ * std::max(c[0], c[2]) < settings_.least_contrast ? 1 : 0;
    }
  }
  return clipped > kShare * n;
}

void LaserFinder::measure_strip(const cv::Mat& bgr) {
  strip_.clear();
  const int half = static_cast<int>(std::ceil(settings_.strip));
  for (std::size_t i = 0; i < line_.size(); ++i) {
    const Eigen::Vector2d along = (line_[std::min(i + 1, line_.size() - 1)] - line_[i > 0 ? i - 1 : 0]).normalized();
    const Eigen::Vector2d across{-along.y(), along.x()};
    double best = -255.0;
    const double white = white_at(line_[i]);
    Eigen::Vector2d where = line_[i];
    for (int k = -half; k <= half; ++k) {
      const Eigen::Vector2d p = line_[i] + k * across;
      if (!projection_.inside(p, 1.0)) continue;
      const double g =
          excess(bgr, tint_, white, static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
      if (g > best) {
        best = g;
        where = p;
      }
    }
    strip_.push_back({where, best});
  }
}

// Middle of what stands out around the spot, weighted by how much; false when it is no dot.
bool LaserFinder::refine(const cv::Mat& bgr, double white, LaserDot& dot) const {
  const int radius = static_cast<int>(std::lround(1.5 * settings_.largest));
  Eigen::Vector2d middle = dot.pixel;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (int round = 0; round < 3; ++round) {
    const int u = static_cast<int>(std::lround(middle.x())), v = static_cast<int>(std::lround(middle.y()));
    // The surroundings: mean on a ring.
    double ring = 0.0;
    int n_ring = 0;
    for (int k = 0; k < 24; ++k) {
      const double angle = k * 2.0 * M_PI / 24.0;
      const int x = u + static_cast<int>(std::lround(radius * std::cos(angle)));
      const int y = v + static_cast<int>(std::lround(radius * std::sin(angle)));
      if (x < 0 || y < 0 || x >= bgr.cols || y >= bgr.rows) continue;
      ring += excess(bgr, tint_, white, x, y);
      ++n_ring;
    }
    ring = n_ring > 0 ? ring / n_ring : 0.0;
    const double floor = ring + 0.3 * (dot.contrast);
    double sum = 0.0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    for (int y = std::max(v - radius, 0); y <= std::min(v + radius, bgr.rows - 1); ++y) {
      for (int x = std::max(u - radius, 0); x <= std::min(u + radius, bgr.cols - 1); ++x) {
        const double w = excess(bgr, tint_, white, x, y) - floor;
        if (w <= 0.0) continue;
        const Eigen::Vector2d p{x, y};
        sum += w;
        mean += w * p;
        second += w * p * p.transpose();
      }
    }
    if (sum <= 0.0) return false;
    middle = mean / sum;
    spread = second / sum - middle * middle.transpose();
  }
  dot.pixel = middle;
  const double trace = spread.trace(), root = std::sqrt(std::max(0.25 * trace * trace - spread.determinant(), 0.0));
  const double large = 0.5 * trace + root, small = std::max(0.5 * trace - root, 1.0 / 12.0);
  dot.smear = std::sqrt(std::max(large - kRound * kRound * small, 0.0));
  return std::sqrt(large) < 0.5 * settings_.largest && std::sqrt(large / small) < kRoundest;
}

// Where colour is blurred: the dot's middle by colour and by brightness, each as well as it is known. Two that disagree
// by more than both say are both known less. Returns the error along the line [px].
double LaserFinder::sharpen(const cv::Mat& grey, LaserDot& dot) const {
  const double colour = settings_.halved_sigma;
  const auto spot = find_bright_spot(grey, dot.pixel, settings_.largest / 4.0, kReach * colour);
  if (!spot) {
    if (dot.contrast < kAlone * settings_.least_contrast) dot.state = LaserState::kDark;
    return colour;
  }
  const double bright = std::max(spot->sigma, settings_.pixel_sigma);
  const double w_colour = 1.0 / (colour * colour), w_bright = 1.0 / (bright * bright);
  const double chi2 = (spot->pixel - dot.pixel).squaredNorm() / 2.0 / (colour * colour + bright * bright);
  dot.pixel = (w_colour * dot.pixel + w_bright * spot->pixel) / (w_colour + w_bright);
  return std::sqrt(std::max(chi2, 1.0) / (w_colour + w_bright));
}

// Distance along the beam where it comes nearest to the pixel's line of sight.
double LaserFinder::along_beam(const Eigen::Vector2d& pixel) const {
  const Ray ray = projection_.ray(pixel);
  const Eigen::Vector3d between = ray.origin - mount_.p_CE;
  const double cosine = ray.direction.dot(mount_.axis_C);
  const double bottom = 1.0 - cosine * cosine;
  if (bottom < 1e-12) return -1.0;
  return (between.dot(mount_.axis_C) - cosine * between.dot(ray.direction)) / bottom;
}

void LaserFinder::triangulate(double pixel_sigma, LaserDot& dot) const {
  const double s = along_beam(dot.pixel);
  const Eigen::Vector3d p_C = mount_.p_CE + s * mount_.axis_C;
  if (!(s > 0.0) || p_C.z() < settings_.nearest || p_C.z() > settings_.farthest) {
    dot.state = LaserState::kOutOfRange;
    return;
  }
  const Eigen::Vector2d on_line = projection_.pixel(p_C);
  if ((on_line - dot.pixel).norm() > settings_.strip) {
    dot.state = LaserState::kOffLine;
    return;
  }
  const double step = 1e-3 * s;
  const Eigen::Vector2d moved = projection_.pixel(p_C + step * mount_.axis_C);
  dot.p_CL = p_C;
  dot.sigma_range = pixel_sigma * step / std::max((moved - on_line).norm(), 1e-9);
}

// Whether another peak stands so near that the middle of both would be taken for one dot's.
bool LaserFinder::has_a_neighbour(std::size_t peak, double typical, double contrast) const {
  for (const int way : {-1, 1}) {
    double lowest = contrast;
    for (std::size_t i = peak; i < strip_.size(); i += static_cast<std::size_t>(way)) {  // ends at both ends
      if ((strip_[i].pixel - strip_[peak].pixel).norm() > 2.0 * settings_.largest) break;
      const double here = strip_[i].strength - typical;
      lowest = std::min(lowest, here);
      if (here > lowest + std::max(kValley * contrast, settings_.least_contrast)) return true;
    }
  }
  return false;
}

std::optional<Eigen::Vector2d> LaserFinder::spot_near(const cv::Mat& bgr, const Eigen::Vector2d& place,
                                                      double contrast) const {
  LaserDot dot{.pixel = place, .contrast = contrast};
  if (!refine(bgr, white_, dot)) return {};
  return dot.pixel;
}

const std::vector<LaserDot>& LaserFinder::look(const cv::Mat& bgr, const cv::Mat& grey, bool halved_colour,
                                               std::optional<std::span<const Outline>> paper) {
  spots_.assign(1, {});
  paper_ = paper;
  if (bgr.channels() != 3) {
    spots_.front().state = LaserState::kNoColour;
    return spots_;
  }
  if (line_.size() < 2) {
    spots_.front().state = LaserState::kOutOfRange;
    return spots_;
  }
  if (bgr.cols != projection_.lens().width || bgr.rows != projection_.lens().height) return spots_;
  find_daylight(bgr);
  measure_strip(bgr);
  sorted_.clear();
  for (const Spot& each : strip_) sorted_.push_back(each.strength);
  std::sort(sorted_.begin(), sorted_.end());
  const double typical = sorted_[sorted_.size() / 2];
  const double spread = sorted_[sorted_.size() * 3 / 4] - sorted_[sorted_.size() / 4];
  double least = std::max(settings_.least_contrast, kOutstanding * spread / 1.35);
  while (true) {
    std::size_t best = strip_.size();
    for (std::size_t i = 0; i < strip_.size(); ++i) {
      const bool taken = std::any_of(spots_.begin(), spots_.end(), [&](const LaserDot& each) {
        return each.contrast >= least && (each.peak - strip_[i].pixel).norm() <= 2.0 * settings_.largest;
      });
      if (!taken && (best == strip_.size() || strip_[i].strength > strip_[best].strength)) best = i;
    }
    if (best == strip_.size()) break;
    LaserDot dot{.pixel = strip_[best].pixel, .peak = strip_[best].pixel, .contrast = strip_[best].strength - typical};
    const bool first = spots_.front().contrast < least;
    if (dot.contrast < least) {
      if (first) spots_.front() = dot;  // what it is too dark for is told
      break;
    }
    if (first) {
      least = std::max(least, kDimRival * dot.contrast);
      spots_.clear();
    }
    if (!halved_colour && has_a_neighbour(best, typical, dot.contrast)) {  // halved, colour has steps of its own
      dot.state = LaserState::kTwo;
    } else if (!refine(bgr, white_at(dot.pixel), dot)) {
      dot.state = LaserState::kNotRound;
    } else if (among_clipped(bgr, dot.pixel)) {
      dot.state = LaserState::kClipped;
    } else {
      dot.state = LaserState::kFound;
      // What draws a dot out draws its middle away by as much.
      const double sigma = std::hypot(halved_colour ? sharpen(grey, dot) : settings_.pixel_sigma, dot.smear);
      if (dot.state == LaserState::kFound) triangulate(sigma, dot);
    }
    spots_.push_back(dot);
    if (spots_.size() == kMostSpots) break;
  }
  return spots_;
}

LaserDot LaserFinder::choose(std::span<const LaserDot> spots) {
  LaserDot dot = spots.front();
  for (const LaserDot& each : spots.subspan(1)) {
    const bool possible = each.state == LaserState::kFound;
    if (each.contrast > (possible ? kDimRival : kRival) * dot.contrast) dot.state = LaserState::kTwo;
  }
  return dot;
}

LaserDot LaserFinder::step(const cv::Mat& bgr, const cv::Mat& grey, bool halved_colour) {
  return choose(look(bgr, grey, halved_colour));
}

}  // namespace fathom::vision
