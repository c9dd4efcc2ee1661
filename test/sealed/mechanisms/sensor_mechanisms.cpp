#include "test/sealed/mechanisms/sensor_mechanisms.hpp"

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

/// x(t - late), by straight lines.
template <class Value>
void make_late(std::vector<Value>& x, double late, double dt) {
  const std::vector<Value> old = x;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double place = std::max(static_cast<double>(k) - late / dt, 0.0);
    const auto i = static_cast<std::size_t>(place), j = std::min(i + 1, x.size() - 1);
    const double share = place - static_cast<double>(i);
    x[k] = (1.0 - share) * old[i] + share * old[j];
  }
}

class Latency : public Sized {
 public:
  Latency(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.1, 1.0), group_(random.below(3)) {}
  void sense(Streams& streams, Random&) const override {
    if (group_ == 2) {  // pose
      make_late(streams.position, size(), streams.dt);
      make_late(streams.euler, size(), streams.dt);
      return;
    }
    std::vector<Vector6> late = streams.nu;
    make_late(late, size(), streams.dt);
    for (std::size_t k = 0; k < late.size(); ++k) {
      streams.nu[k].segment<3>(3 * group_) = late[k].segment<3>(3 * group_);  // velocity log or gyro
    }
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"latency", size()}, {"group", static_cast<double>(group_)}};
  }

 private:
  int group_;
};

class Scale : public Sized {
 public:
  Scale(const std::string& name, const Craft&, const Site&, Random& random)
      : Sized(name, 0.05, 0.3), gyro_(random.chance(0.35)), sign_(random.sign()) {}
  void sense(Streams& streams, Random&) const override {
    for (Vector6& nu : streams.nu) nu.segment<3>(gyro_ ? 3 : 0) *= 1.0 + sign_ * size();
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"scale", sign_ * size()}, {"of_gyro", gyro_ ? 1.0 : 0.0}};
  }

 private:
  bool gyro_;
  double sign_;
};

/// The velocity log sits away from the origin and nobody corrected for it.
class LeverArm : public Sized {
 public:
  LeverArm(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1, 1.5),
        along_(random.normal(), random.normal(), craft.actuated[3] ? 0.5 * random.normal() : 0.0) {
    along_.normalize();
  }
  void sense(Streams& streams, Random&) const override {
    for (Vector6& nu : streams.nu) {
      const Vector3d omega = nu.tail<3>();
      nu.head<3>() += omega.cross(size() * along_);
    }
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"l_x", size() * along_.x()}, {"l_y", size() * along_.y()}, {"l_z", size() * along_.z()}};
  }

 private:
  Vector3d along_;
};

/// An Ornstein-Uhlenbeck wrench on every axis.
class ColouredNoise : public Sized {
 public:
  ColouredNoise(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1, 10.0), memory_time_(random.log_uniform(0.3, 5.0)), weight_(usual_drag(craft)) {}
  void begin_file(double from, double to, Random& random) override {
    from_ = from;
    path_.assign(static_cast<std::size_t>((to - from) / kStep) + 2, Vector6::Zero());
    const double keep = std::exp(-kStep / memory_time_), fresh = std::sqrt(1.0 - keep * keep);
    Vector6 x;
    for (int i = 0; i < 6; ++i) x[i] = random.normal();
    for (Vector6& one : path_) {
      one = x.cwiseProduct(weight_);
      for (int i = 0; i < 6; ++i) x[i] = keep * x[i] + fresh * random.normal();
    }
  }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    if (path_.empty()) return;
    const double place = std::clamp((at.t - from_) / kStep, 0.0, static_cast<double>(path_.size() - 2));
    const auto i = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(i);
    terms.wrench += size() * ((1.0 - share) * path_[i] + share * path_[i + 1]);
  }
  [[nodiscard]] Numbers parameters() const override { return {{"memory_time", memory_time_}, {"factor", size()}}; }

 private:
  static constexpr double kStep = 0.02;  // s
  double memory_time_;
  Vector6 weight_;
  double from_{};
  std::vector<Vector6> path_;
};

}  // namespace

std::vector<Entry> sensor_mechanisms() {
  return {{"sensor_latency", {}, make<Latency>}, {"sensor_scale", {}, make<Scale>}, {"lever_arm", {}, make<LeverArm>}};
}

const Entry& coloured_noise() {
  static const Entry entry{"coloured_noise", {}, make<ColouredNoise>};
  return entry;
}

}  // namespace fathom::sealed
