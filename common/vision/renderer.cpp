#include "common/vision/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/base/config.hpp"
#include "common/vision/tag_detector.hpp"

namespace fathom::vision {
namespace {

// Green water: how much of white light each colour keeps, and what scatters back into the lens. Blue, green, red.
const cv::Scalar kTint{0.75, 1.0, 0.55}, kVeil{70.0, 95.0, 45.0};
constexpr double kMargin = 1.5;   // m of floor beyond the last tag where there are no walls
constexpr double kFloor = 0.45;   // albedo of the floor against white paper
constexpr int kNoiseSide = 1024;  // px of the noise that every picture gets a piece of

}  // namespace

RenderSettings RenderSettings::from(const Config& config) {
  RenderSettings s;
  std::vector<std::string> known{"grain"};
  const auto read = [&](const char* key, const char* unit, double& to) {
    known.emplace_back(key);
    if (config.has(key)) to = config.not_negative(key, unit);
  };
  read("attenuation", "m^-1", s.attenuation);
  read("blur", "", s.blur);
  read("vignetting", "", s.vignetting);
  read("noise", "", s.noise);
  read("caustics", "", s.caustics);
  read("texture", "", s.texture);
  read("brightness", "", s.brightness);
  read("dot", "m", s.dot);
  read("laser", "", s.laser);
  if (config.has("grain")) s.grain = config.positive("grain", "m");
  for (const std::string& key : config.keys()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) config.fail(key, "unknown key '" + key + "'");
  }
  return s;
}

Renderer::Renderer(const model::Site& site, const model::Lens& lens, const std::optional<model::LaserMount>& laser,
                   const RenderSettings& settings, std::uint64_t seed)
    : site_{site}, projection_{lens}, laser_{laser}, settings_{settings}, floor_{site.floor}, seed_{seed} {
  if (site.floor <= site.surface && !site.tags.empty()) floor_ = site.tags.front().p_WT.z();
  paint_floor(seed);
  for (const model::Tag& tag : site_.tags) paint_tag(tag);
  for (int i = 0; i < 4; ++i) {
    cv::Mat half;
    cv::resize(floor_pictures_.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    floor_pictures_.push_back(half);
  }
  // Rays do not move with the camera: once is enough.
  rays_.create(lens.height, lens.width, CV_32FC3);
  vignette_.create(lens.height, lens.width, CV_32FC1);
  const double corner = std::hypot(0.5 * lens.width, 0.5 * lens.height);
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) {
      const Eigen::Vector3d d = projection_.ray({x, y}).direction;
      rays_.at<cv::Vec3f>(y, x) = cv::Vec3d{d.x(), d.y(), d.z()};
      const double r = std::hypot(x - 0.5 * lens.width, y - 0.5 * lens.height) / corner;
      vignette_.at<float>(y, x) = static_cast<float>(1.0 - settings.vignetting * r * r);
    }
  }
  cv::RNG random{seed * 2 + 1};
  noise_.create(kNoiseSide, kNoiseSide, CV_32FC3);
  random.fill(noise_, cv::RNG::NORMAL, 0.0, settings.noise);
}

// Blotches of several sizes, as sand, paint and growth make them.
void Renderer::paint_floor(std::uint64_t seed) {
  Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
  for (const model::Tag& tag : site_.tags) {
    low = low.cwiseMin(tag.p_WT.head<2>());
    high = high.cwiseMax(tag.p_WT.head<2>());
  }
  if (site_.tags.empty()) low = high = Eigen::Vector2d::Zero();
  low.array() -= kMargin;
  high.array() += kMargin;
  if (std::isfinite(site_.south)) low.x() = std::min(low.x(), site_.south);
  if (std::isfinite(site_.north)) high.x() = std::max(high.x(), site_.north);
  if (std::isfinite(site_.west)) low.y() = std::min(low.y(), site_.west);
  if (std::isfinite(site_.east)) high.y() = std::max(high.y(), site_.east);
  corner_ = low;
  const Eigen::Vector2d extent = (high - low) / settings_.grain;
  const cv::Size size{static_cast<int>(extent.x()) + 1, static_cast<int>(extent.y()) + 1};  // columns along x of W
  cv::RNG random{seed * 2 + 2};
  cv::Mat sum = cv::Mat::zeros(size, CV_32FC1);
  for (const double blotch : {0.4, 0.1, 0.03, 0.01}) {  // m
    const cv::Size coarse{std::max(static_cast<int>(size.width * settings_.grain / blotch), 2),
                          std::max(static_cast<int>(size.height * settings_.grain / blotch), 2)};
    cv::Mat layer(coarse, CV_32FC1), fine;
    random.fill(layer, cv::RNG::UNIFORM, -0.5, 0.5);
    cv::resize(layer, fine, size, 0.0, 0.0, cv::INTER_CUBIC);
    sum += fine;
  }
  cv::Mat picture;
  sum.convertTo(picture, CV_8U, 255.0 * settings_.brightness * kFloor * settings_.texture,
                255.0 * settings_.brightness * kFloor);
  floor_pictures_.assign(1, picture);
}

void Renderer::paint_tag(const model::Tag& tag) {
  const TagCells printed = tag_cells(site_.family_of(tag), tag.id);
  const double cell = tag.size / printed.border;
  const double half = 0.5 * cell * (printed.cells.cols + 2);  // a white cell more all around
  const Eigen::Matrix2d R_TW = tag.R_WT.topLeftCorner<2, 2>().transpose();
  const double reach = 1.5 * half / settings_.grain;
  const Eigen::Vector2d middle = (tag.p_WT.head<2>() - corner_) / settings_.grain;
  cv::Mat& picture = floor_pictures_.front();
  constexpr int kFine = 4;
  const double pixel = 0.75 * settings_.grain;  // m, more than half of a pixel's diagonal: within it the pixel lies
  const auto cell_at = [&](double x, int cells) { return static_cast<int>(std::floor(x / cell + 0.5 * cells)); };
  const auto value = [&](int u, int v) {
    const bool outside = u < 0 || v < 0 || u >= printed.cells.cols || v >= printed.cells.rows;
    return 255.0 * settings_.brightness * (outside || printed.cells.at<std::uint8_t>(v, u) > 127 ? 1.0 : 0.06);
  };
  for (int y = static_cast<int>(middle.y() - reach); y <= static_cast<int>(middle.y() + reach); ++y) {
    for (int x = static_cast<int>(middle.x() - reach); x <= static_cast<int>(middle.x() + reach); ++x) {
      if (x < 0 || y < 0 || x >= picture.cols || y >= picture.rows) continue;
      const Eigen::Vector2d p_TX = R_TW * (corner_ + settings_.grain * Eigen::Vector2d{x, y} - tag.p_WT.head<2>());
      const double farthest = p_TX.cwiseAbs().maxCoeff();
      if (farthest > half + pixel) continue;
      // Most pixels lie in one cell, and only those on a border are sampled more finely.
      const int u0 = cell_at(p_TX.x() - pixel, printed.cells.cols), v0 = cell_at(p_TX.y() - pixel, printed.cells.rows);
      if (farthest < half - pixel && u0 == cell_at(p_TX.x() + pixel, printed.cells.cols) &&
          v0 == cell_at(p_TX.y() + pixel, printed.cells.rows)) {
        picture.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value(u0, v0));
        continue;
      }
      double sum = 0.0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const int row = k / kFine, column = k % kFine;
        const Eigen::Vector2d fine{(column + 0.5) / kFine - 0.5, (row + 0.5) / kFine - 0.5};
        const Eigen::Vector2d p_W = corner_ + settings_.grain * (Eigen::Vector2d{x, y} + fine);
        const Eigen::Vector2d p_T = R_TW * (p_W - tag.p_WT.head<2>());
        if (p_T.cwiseAbs().maxCoeff() > half) {
          sum += picture.at<std::uint8_t>(y, x);
          continue;
        }
        sum += value(cell_at(p_T.x(), printed.cells.cols), cell_at(p_T.y(), printed.cells.rows));
      }
      picture.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(sum / (kFine * kFine));
    }
  }
}

// Where in the floor's picture each pixel looks. A port's offset of the rays is neglected: millimetres.
void Renderer::map_floor(const Pose& pose) {
  const double height = floor_ - pose.p_WC.z();
  distance_ = std::max(height / std::max(pose.R_WC(2, 2), 0.1), 0.01);
  // The level whose pixels are about as large as the camera's on the floor.
  const double footprint = distance_ / projection_.lens().focal() / settings_.grain;
  const auto most = static_cast<int>(floor_pictures_.size()) - 1;
  const int level = std::clamp(static_cast<int>(std::lround(std::log2(std::max(footprint, 1.0)))), 0, most);
  const double grain = settings_.grain * std::pow(2.0, level);
  const cv::Mat& floor = floor_pictures_[static_cast<std::size_t>(level)];
  // Middles of pixels: those of a coarse level lie between those of the finest.
  const double shift = 0.5 * settings_.grain * (std::pow(2.0, level) - 1.0);
  map_.create(rays_.size(), CV_32FC2);
  const Eigen::Matrix3f R = pose.R_WC.cast<float>();
  const auto x0 = static_cast<float>((pose.p_WC.x() - corner_.x() - shift) / grain);
  const auto y0 = static_cast<float>((pose.p_WC.y() - corner_.y() - shift) / grain);
  const auto h = static_cast<float>(height / grain);
  for (int y = 0; y < rays_.rows; ++y) {
    const cv::Vec3f* ray = rays_.ptr<cv::Vec3f>(y);
    cv::Vec2f* to = map_.ptr<cv::Vec2f>(y);
    for (int x = 0; x < rays_.cols; ++x) {
      const cv::Vec3f& d = ray[x];
      const float down = R(2, 0) * d[0] + R(2, 1) * d[1] + R(2, 2) * d[2];
      if (down < 0.05F || h <= 0.0F) {
        to[x] = {-1e4F, -1e4F};
        continue;
      }
      const float s = h / down;
      to[x] = {x0 + s * (R(0, 0) * d[0] + R(0, 1) * d[1] + R(0, 2) * d[2]),
               y0 + s * (R(1, 0) * d[0] + R(1, 1) * d[1] + R(1, 2) * d[2])};
    }
  }
  cv::remap(floor, flat_, map_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar{60.0});
  if (settings_.blur > 0.0) cv::GaussianBlur(flat_, flat_, {}, settings_.blur);
  map_ *= static_cast<float>(grain);  // m on the floor, for the caustics
}

// Waves on the surface focus light: bright lines that move over the floor.
void Renderer::light(double t) {
  vignette_.copyTo(light_);
  if (settings_.caustics <= 0.0) return;
  constexpr int kCoarse = 8;
  small_light_.create((map_.rows + kCoarse - 1) / kCoarse, (map_.cols + kCoarse - 1) / kCoarse, CV_32FC1);
  for (int y = 0; y < small_light_.rows; ++y) {
    for (int x = 0; x < small_light_.cols; ++x) {
      const cv::Vec2f p =
          map_.at<cv::Vec2f>(std::min(y * kCoarse, map_.rows - 1), std::min(x * kCoarse, map_.cols - 1));
      const double u = p[0], v = p[1];
      const double a = std::sin(9.0 * u + 3.0 * v + 2.1 * t) + std::sin(-4.0 * u + 8.0 * v + 1.7 * t) +
                       std::sin(6.0 * u - 7.0 * v - 2.6 * t);
      small_light_.at<float>(y, x) = static_cast<float>(1.0 + settings_.caustics * (std::exp(-a * a) * 2.0 - 1.0));
    }
  }
  cv::Mat large;
  cv::resize(small_light_, large, light_.size(), 0.0, 0.0, cv::INTER_LINEAR);
  cv::multiply(light_, large, light_);
}

std::optional<Eigen::Vector3d> Renderer::dot(const Pose& pose) const {
  if (!laser_) return {};
  const Eigen::Vector3d p_WE = pose.p_WC + pose.R_WC * laser_->p_CE, axis_W = pose.R_WC * laser_->axis_C;
  if (axis_W.z() < 0.05) return {};
  const double s = (floor_ - p_WE.z()) / axis_W.z();
  const Eigen::Vector3d p_CL = laser_->p_CE + s * laser_->axis_C;
  if (!(s > 0.0) || !(p_CL.z() > 0.0) || !projection_.inside(projection_.pixel(p_CL))) return {};
  return p_CL;
}

void Renderer::add_dot(const Pose& pose) {
  const auto p_CL = dot(pose);
  if (!p_CL) return;
  const Eigen::Vector2d at = projection_.pixel(*p_CL);
  const double sigma = std::hypot(settings_.dot * projection_.lens().focal() / p_CL->z() * 0.5, settings_.blur);
  const double power = 255.0 * settings_.laser * std::exp(-settings_.attenuation * p_CL->z());
  const int reach = static_cast<int>(std::ceil(6.0 * sigma)) + 1;
  const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
  for (int y = std::max(v - reach, 0); y <= std::min(v + reach, bgr_float_.rows - 1); ++y) {
    for (int x = std::max(u - reach, 0); x <= std::min(u + reach, bgr_float_.cols - 1); ++x) {
      const double r2 = (Eigen::Vector2d{x, y} - at).squaredNorm() / (2.0 * sigma * sigma);
      const auto g = static_cast<float>(power * std::exp(-r2));
      bgr_float_.at<cv::Vec3f>(y, x) += cv::Vec3f{0.25F * g, g, 0.12F * g};
    }
  }
}

const cv::Mat& Renderer::step(double t, const Pose& pose) {
  if (!pose.p_WC.allFinite() || !pose.R_WC.allFinite()) {  // nobody knows what it sees
    bgr_ = cv::Mat::zeros(rays_.size(), CV_8UC3);
    return bgr_;
  }
  map_floor(pose);
  light(t);
  cv::Mat lit;
  flat_.convertTo(lit, CV_32F);
  cv::multiply(lit, light_, lit);
  const double clear = std::exp(-settings_.attenuation * distance_);
  bgr_float_.create(lit.size(), CV_32FC3);
  // Every picture its own piece of the noise.
  const auto number = static_cast<std::uint64_t>(std::llround(t * 1e3)) + seed_;
  const std::uint64_t mixed = (number + 0x9e3779b97f4a7c15ULL) * 0xbf58476d1ce4e5b9ULL;
  const int dx = static_cast<int>((mixed >> 20U) % kNoiseSide), dy = static_cast<int>((mixed >> 40U) % kNoiseSide);
  cv::Vec3f kept, veil;  // of what comes from the floor, and of what scatters back, per colour
  for (int c = 0; c < 3; ++c) {
    kept[c] = static_cast<float>(clear * kTint[c]);
    veil[c] = static_cast<float>((1.0 - clear) * kVeil[c]);
  }
  for (int y = 0; y < lit.rows; ++y) {
    const float* from = lit.ptr<float>(y);
    const float* shade = vignette_.ptr<float>(y);
    const cv::Vec3f* grain = noise_.ptr<cv::Vec3f>((y + dy) % kNoiseSide);
    cv::Vec3f* to = bgr_float_.ptr<cv::Vec3f>(y);
    for (int begin = 0; begin < lit.cols;) {  // pieces within which the noise does not wrap around
      const int first = (begin + dx) % kNoiseSide, end = std::min(lit.cols, begin + kNoiseSide - first);
      for (int x = begin; x < end; ++x) {
        const cv::Vec3f& n = grain[first + x - begin];
        to[x] = {kept[0] * from[x] + veil[0] * shade[x] + n[0], kept[1] * from[x] + veil[1] * shade[x] + n[1],
                 kept[2] * from[x] + veil[2] * shade[x] + n[2]};
      }
      begin = end;
    }
  }
  add_dot(pose);
  bgr_float_.convertTo(bgr_, CV_8U);
  return bgr_;
}

}  // namespace fathom::vision
