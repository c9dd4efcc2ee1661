// Poses of the site's tags that lie whole in the picture. Errors follow from the corners' error in pixels: with n = f s
// / z pixels along the edge, across the view z sigma / (2 f), along it z sigma / (sqrt(2) n), about the view sigma / n,
// and tilt sigma / n times the weak perspective's z / s, at most kMostTilt (near square tags turn over rather than
// grow). Not modelled: refraction and distortion left by the calibration beyond one scale error per run, motion blur.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/camera_view.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

constexpr double kMostTilt = 0.1;       // rad, standard deviation
constexpr double kSteepest = 0.34;      // cosine of the view onto the tag: flatter, no detector finds it
constexpr double kSmallestEdge = 20.0;  // px

class TagPoseSensor final : public Sensor {
 public:
  TagPoseSensor(const Config& config, const Surroundings& around)
      : camera_{around.vehicle->mounts.cameras.front()},
        site_{around.site},
        noise_{config.positive("corner_noise", "")},
        loss_{probability(config, "loss")},
        outlier_{probability(config, "outlier")},
        outlier_size_{config.not_negative("outlier_size", "m")},
        farthest_{config.positive("farthest", "m")},
        stream_{around.seed, "tag_pose"} {
    scale_ = config.not_negative("scale_error", "") * stream_.normal();
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const CameraView view{camera_, moment};
    for (const model::Tag& tag : site_->tags) {
      const Eigen::Vector3d p_CT = view.in_camera(tag.p_WT);
      if (!view.sees(p_CT) || p_CT.norm() > farthest_) continue;
      const Eigen::Matrix3d R_CT = view.R_WC.transpose() * tag.R_WT;
      if (R_CT.col(2).dot(p_CT) < kSteepest * p_CT.norm() || !whole(view, tag, p_CT, R_CT)) continue;
      const double edge = camera_.focal * tag.size / p_CT.z();
      if (edge < kSmallestEdge) continue;
      see(moment, tag, p_CT, R_CT, edge, samples);
    }
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override { return {{"scale_error", scale_}}; }

 private:
  [[nodiscard]] static bool whole(const CameraView& view, const model::Tag& tag, const Eigen::Vector3d& p_CT,
                                  const Eigen::Matrix3d& R_CT) {
    constexpr std::array<std::array<double, 2>, 4> kCorners{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
    return std::all_of(kCorners.begin(), kCorners.end(), [&](const auto& corner) {
      return view.sees(p_CT + R_CT * Eigen::Vector3d{corner[0] * tag.size, corner[1] * tag.size, 0.0});
    });
  }

  void see(const Moment& moment, const model::Tag& tag, const Eigen::Vector3d& p_CT, const Eigen::Matrix3d& R_CT,
           double edge, std::vector<Sample>& samples) {
    const double z = p_CT.z();
    const double across = 0.5 * z * noise_ / camera_.focal, along = z * noise_ / (std::sqrt(2.0) * edge);
    const double about = noise_ / edge, tilt = std::min(kMostTilt, about * z / tag.size);
    Eigen::Vector3d p = p_CT * (1.0 + scale_ + along / z * stream_.normal());
    p.x() += across * stream_.normal();
    p.y() += across * stream_.normal();
    const Eigen::Vector3d turn{tilt * stream_.normal(), tilt * stream_.normal(), about * stream_.normal()};
    const bool lost = stream_.chance(loss_), wild = stream_.chance(outlier_);
    const Eigen::Vector3d astray{stream_.uniform(-1.0, 1.0), stream_.uniform(-1.0, 1.0), stream_.uniform(-1.0, 1.0)};
    const double error = noise_ * std::sqrt(stream_.uniform(0.5, 1.5));
    if (lost) return;
    if (wild) p += outlier_size_ * astray;
    samples.emplace_back(
        TagPose{.utime = moment.utime,
                .camera = camera_.name,
                .tag = tag.number(),
                .p_CT = p,
                .q_CT = (quaternion_from_rotation_vector(turn) * Eigen::Quaterniond{R_CT}).normalized(),
                .reprojection_error = wild ? 5.0 * error : error});
  }

  model::CameraMount camera_;
  const model::Site* site_;
  double noise_, loss_, outlier_, outlier_size_, farthest_;
  RandomStream stream_;
  double scale_{};
};

}  // namespace

std::unique_ptr<Sensor> make_tag_pose(const Config& config, const Surroundings& around) {
  if (around.vehicle->mounts.cameras.empty()) config.fail("rate", "the vehicle file has no sensors.cameras");
  auto sensor = std::make_unique<TagPoseSensor>(config, around);  // reads its section in any case
  if (around.site->tags.empty()) return nullptr;
  return sensor;
}

}  // namespace fathom::simulation
