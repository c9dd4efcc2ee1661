// Short dives over a rendered floor on which something else looks like the laser's dot: paint, a second beam, nothing.
#pragma once

#include <cmath>
#include <random>

#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision::test_scene {

enum class Moving { kRest, kAlong, kDown, kAll };
enum class Rival { kNone, kPaint, kPaintAlone, kSecondBeam };  // alone: the laser is off

struct Setting {
  bool tags{false};
  Moving moving{Moving::kAll};
  Rival rival{Rival::kNone};
  RenderSettings look{};
  int quality{0};  // of JPEG with colour at half resolution; 0: the picture as it was rendered
};

struct Tally {
  int looked{};  // pictures with a dot in them
  int found{};   // ranges published in those
  int wrong{};   // ranges beyond three times what they state, or without a dot
  int late{};    // those of them after the paint, or the floor, had moved by some pixels
  int dives_wrong{};
};

inline model::Site bare_site() {
  model::Site place = site();
  place.tags.clear();
  return place;
}

/// A spot like the laser's of `sigma` [px]; `power` 1: as bright as white.
inline void add_spot(cv::Mat& bgr, const Eigen::Vector2d& at, double sigma, double power) {
  const int reach = static_cast<int>(std::ceil(5.0 * sigma)) + 1;
  const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
  for (int y = std::max(v - reach, 0); y <= std::min(v + reach, bgr.rows - 1); ++y) {
    for (int x = std::max(u - reach, 0); x <= std::min(u + reach, bgr.cols - 1); ++x) {
      const double g = 255.0 * power * std::exp(-(Eigen::Vector2d{x, y} - at).squaredNorm() / (2.0 * sigma * sigma));
      cv::Vec3b& c = bgr.at<cv::Vec3b>(y, x);
      c = {cv::saturate_cast<std::uint8_t>(c[0] + 0.25 * g), cv::saturate_cast<std::uint8_t>(c[1] + g),
           cv::saturate_cast<std::uint8_t>(c[2] + 0.12 * g)};
    }
  }
}

/// Dives of `pictures` each, drawn at random; the attitude sensor leans by half a degree and shakes.
inline Tally dive(const Setting& setting, int dives, int pictures, unsigned seed) {
  constexpr double kPeriod = 1.0 / 30.0, kLeaning = 0.01, kShaking = 3e-4;  // s, rad, rad
  constexpr double kDarkest = 0.3, kBrightest = 2.0;                        // of a rival, of the dot's brightness
  constexpr double kMoved = 8.0;                                            // px
  Tally tally;
  std::mt19937 generator{seed};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  std::normal_distribution<double> normal;
  const model::Site place = setting.tags ? site() : bare_site();
  RenderSettings look = setting.look;
  if (setting.rival == Rival::kPaintAlone) look.laser = 0.0;
  const Projection projection{lens()};
  for (int n = 0; n < dives; ++n) {
    Renderer renderer{place, lens(), laser(), look, seed + static_cast<unsigned>(n)};
    FrontEnd front_end{place, lens(), laser(), {}};
    Eigen::Vector3d v_W{0.25 * any(generator), 0.25 * any(generator), 0.12 * any(generator)};
    const double swing = any(generator), start_swing = 3.0 * any(generator), yaw = 3.0 * any(generator);
    if (setting.moving == Moving::kRest) v_W.setZero();
    if (setting.moving == Moving::kAlong) v_W.z() = 0.0;
    if (setting.moving == Moving::kDown) v_W.head<2>().setZero();
    const double turning = setting.moving == Moving::kAll ? 0.3 * swing : 0.0;
    const Eigen::Vector3d middle{0.4 * any(generator), 0.4 * any(generator), 0.55 + 0.4 * any(generator)};
    const auto at = [&](double t) {
      const double leaning = 0.05 * std::sin(start_swing + (turning != 0.0 ? 2.0 * t : 0.0));
      return pose(middle + (t - 0.5 * pictures * kPeriod) * v_W, leaning, 0.7 * leaning, yaw + turning * t);
    };
    // Paint where the beam's line goes at some moment.
    const double moment = kPeriod * pictures * 0.5 * (1.0 + 0.8 * any(generator));
    const double apparent = 1.0 / (0.55 + 0.45 * any(generator) + 0.5);  // m along the axis, of the spot on the line
    const Pose there = at(moment);
    const double height = place.floor - there.p_WC.z();
    const Eigen::Vector3d ray =
        there.R_WC * Eigen::Vector3d{laser().p_CE.x() / apparent, 2.0 / 540 * any(generator), 1.0};
    const Eigen::Vector3d paint_W = there.p_WC + height / ray.z() * ray;
    model::LaserMount second = laser();
    second.p_CE.x() *= 1.0 + 0.5 * any(generator);
    if (std::abs(second.p_CE.x() - laser().p_CE.x()) < 5e-3) second.p_CE.x() += 1e-2;
    const double bright = std::exp(0.5 * (std::log(kDarkest) + std::log(kBrightest)) +
                                   0.5 * any(generator) * std::log(kBrightest / kDarkest));
    const double size = 1.0 + 0.4 * any(generator);
    const Eigen::Vector3d leaning = 0.5 * kLeaning * Eigen::Vector3d{any(generator), any(generator), 0.0};
    int wrong = 0;
    for (int i = 0; i < pictures; ++i) {
      const double t = i * kPeriod;
      const Pose now = at(t);
      cv::Mat bgr = renderer.step(t, now).clone();
      const double down = place.floor - now.p_WC.z();
      const double sigma = size * std::hypot(setting.look.dot * 540.0 / down * 0.5, setting.look.blur);
      const double power = bright * setting.look.laser * std::exp(-setting.look.attenuation * down);
      if (setting.rival == Rival::kPaint || setting.rival == Rival::kPaintAlone) {
        const Eigen::Vector3d p_C = now.R_WC.transpose() * (paint_W - now.p_WC);
        if (p_C.z() > 0.1) add_spot(bgr, projection.pixel(p_C), sigma, power);
      } else if (setting.rival == Rival::kSecondBeam) {
        const double s = down / now.R_WC.col(2).z() - (now.R_WC * second.p_CE).z() / now.R_WC.col(2).z();
        add_spot(bgr, projection.pixel(second.p_CE + s * second.axis_C), sigma, power);
      }
      Picture seen{.utime = utime_after(1'000'000, t)};
      if (setting.quality > 0) {
        const std::vector<std::uint8_t> bytes = encode_jpeg(bgr, setting.quality, true);
        if (!decode_jpeg(bytes, true, seen.grey, seen.bgr).empty()) continue;
        seen.halved_colour = halves_colour(bytes);
      } else {
        seen.bgr = bgr;
        seen.grey = grey_of(bgr);
      }
      const Eigen::Vector3d shake =
          leaning + kShaking * Eigen::Vector3d{normal(generator), normal(generator), normal(generator)};
      const Eigen::Matrix3d R_WC = now.R_WC * quaternion_from_rotation_vector(shake).toRotationMatrix();
      front_end.step(seen, R_WC);
      const auto range = front_end.laser_range("down");
      const auto truth = look.laser > 0.0 ? renderer.dot(now) : std::nullopt;
      if (truth) ++tally.looked;
      if (!range) continue;
      if (truth) ++tally.found;
      if (truth && std::abs(range->p_CL.z() - truth->z()) <= 3.0 * range->sigma_range) continue;
      ++wrong;
      const Eigen::Vector3d p_C = now.R_WC.transpose() * (paint_W - now.p_WC);
      const Eigen::Vector3d first = at(0.0).R_WC.transpose() * (paint_W - at(0.0).p_WC);
      if ((projection.pixel(p_C) - projection.pixel(first)).norm() > kMoved) ++tally.late;
    }
    tally.wrong += wrong;
    tally.dives_wrong += wrong > 0 ? 1 : 0;
  }
  return tally;
}

}  // namespace fathom::vision::test_scene
