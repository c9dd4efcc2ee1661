#include "common/consistency/conventions/evidence_windows.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::consistency {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using estimation::PoseSeries;
using estimation::Series;
using estimation::Spline;

constexpr double kWindow = 1.0;             // s
constexpr std::size_t kFewestSamples = 5;   // in a window
constexpr std::size_t kMostWindows = 400;   // of a recording, spread evenly
constexpr std::size_t kFewestMoments = 12;  // at which speeds are compared
constexpr double kLongestDelay = 1.0;       // s
constexpr double kDelayStep = 0.05;         // s
constexpr double kDelaySeen = 0.7;          // correlation of speeds that shows a delay
constexpr double kDelayBetter = 0.05;       // more correlation than without one

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sa += a[i], sb += b[i], saa += a[i] * a[i], sbb += b[i] * b[i], sab += a[i] * b[i];
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 0.0 && vb > 0.0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : 0.0;
}

/// By how much the sensor's stamps lag: where its magnitude goes best with the reference's, whatever their axes.
double delay_of(const std::vector<double>& t, const std::vector<double>& magnitude, const Series& sensor) {
  if (sensor.size() < 2 || t.size() < kFewestMoments) return 0.0;
  const Spline spline(sensor);
  const auto at = [&](double delay) {
    std::vector<double> a, b;
    Vector3d x;
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (!spline.at(t[i] + delay, x)) continue;
      a.push_back(magnitude[i]);
      b.push_back(x.norm());
    }
    return a.size() < kFewestMoments ? 0.0 : correlation(a, b);
  };
  const double none = at(0.0);
  double best = none, delay = 0.0;
  for (int k = 1; k * kDelayStep <= kLongestDelay + 1e-9; ++k) {
    for (const double one : {k * kDelayStep, -k * kDelayStep}) {
      const double c = at(one);
      if (c > best) best = c, delay = one;
    }
  }
  return best > kDelaySeen && best > none + kDelayBetter ? delay : 0.0;
}

}  // namespace

void find_delays(EvidenceStreams& streams) {
  const PoseSeries& pose = streams.pose;
  // Speeds and rates of turn over half a second.
  const double step = estimation::typical_step(pose.t);
  if (step <= 0.0 || !pose.has_attitude) return;
  const auto span = static_cast<std::size_t>(std::max(2.0, std::round(0.4 / step)));
  const std::size_t stride = std::max<std::size_t>(1, pose.size() / 1500);
  std::vector<double> t, speed, turning;
  for (std::size_t i = 0; i + span < pose.size(); i += stride) {
    const std::size_t j = i + span;
    if (!pose.valid[i] || !pose.valid[j] || pose.t[j] - pose.t[i] > 1.5 * static_cast<double>(span) * step) continue;
    t.push_back(0.5 * (pose.t[i] + pose.t[j]));
    speed.push_back((pose.p_WB[j] - pose.p_WB[i]).norm() / (pose.t[j] - pose.t[i]));
    turning.push_back(pose.q_WB[i].angularDistance(pose.q_WB[j]) / (pose.t[j] - pose.t[i]));
  }
  if (pose.has_position) streams.velocity_delay = delay_of(t, speed, streams.velocity);
  streams.rates_delay = delay_of(t, turning, streams.rates);
}

std::vector<EvidenceWindow> evidence_windows(const EvidenceStreams& streams, const Reading& reading) {
  std::vector<EvidenceWindow> all;
  if (!streams.pose.has_attitude) return all;
  estimation::Corrections form;
  form.quaternion = reading.quaternion;
  form.heading_sense = reading.sense;
  PoseSeries pose = streams.pose;
  estimation::correct_pose(form, pose);
  const double step = estimation::typical_step(pose.t);
  if (step <= 0.0) return all;
  const std::size_t count = std::max(kFewestSamples, static_cast<std::size_t>(std::lround(kWindow / step)) + 1);
  if (pose.size() < count) return all;
  const Spline velocity(streams.velocity), rates(streams.rates), force(streams.force), depth(streams.depth);
  const std::size_t possible = (pose.size() - 1) / (count - 1);
  const std::size_t stride = (count - 1) * std::max<std::size_t>(1, possible / kMostWindows);
  for (std::size_t first = 0; first + count <= pose.size(); first += stride) {
    EvidenceWindow one;
    bool whole = true;
    for (std::size_t i = first; i < first + count && whole; ++i)
      whole = pose.valid[i] != 0 && (i == first || pose.t[i] - pose.t[i - 1] < 2.5 * step);
    if (!whole) continue;
    const std::size_t last = first + count - 1;
    one.has_velocity = pose.has_position && !streams.velocity.empty();
    one.has_rates = !streams.rates.empty();
    one.has_force = !streams.force.empty();
    one.length = pose.t[last] - pose.t[first];
    one.moved = pose.p_WB[last] - pose.p_WB[first];
    one.turned = pose.q_WB[last].toRotationMatrix() - pose.q_WB[first].toRotationMatrix();
    for (std::size_t i = first; i <= last; ++i) {
      const double w = 0.5 * (pose.t[std::min(i + 1, last)] - pose.t[i == first ? first : i - 1]);
      const Matrix3d R = pose.q_WB[i].toRotationMatrix();
      const Eigen::Map<const Eigen::Matrix<double, 9, 1>> r(R.data());
      Vector3d x;
      one.mean += w * R;
      if (one.has_velocity && (one.has_velocity = velocity.at(pose.t[i] + streams.velocity_delay, x))) {
        one.velocity += w * r * x.transpose();
        one.straight += w * x;
      }
      if (one.has_rates && (one.has_rates = rates.at(pose.t[i] + streams.rates_delay, x))) {
        one.rates += w * r * x.transpose();
        one.euler_cross += w * R * skew(estimation::body_rates(x, pose.q_WB[i]));
      }
      if (one.has_force && (one.has_force = force.at(pose.t[i], x))) one.force += w * r * x.transpose();
    }
    Vector3d from, to;
    one.has_depth =
        pose.has_position && !streams.depth.empty() && depth.at(pose.t[first], from) && depth.at(pose.t[last], to);
    if (one.has_depth) one.deeper = to.z() - from.z();
    all.push_back(one);
  }
  return all;
}

}  // namespace fathom::consistency
