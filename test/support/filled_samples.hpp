// One sample of every kind with a different value in every field, so that a forgotten or swapped field shows.
#pragma once

#include <cstddef>
#include <set>

#include "common/samples/recording.hpp"

namespace fathom::test {

/// Hands out numbers that never repeat and remembers them.
class Fill {
 public:
  double number() { return remember(1.0 / 3.0 + static_cast<double>(++count_)); }
  template <class Matrix>
  Matrix matrix() {
    Matrix m;
    for (Eigen::Index i = 0; i < m.size(); ++i) m(i) = number();
    return m;
  }
  Eigen::Quaterniond quaternion() {
    const Eigen::Quaterniond q = Eigen::Quaterniond{1.0, -2.0, 3.0, 4.0}.normalized();
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) remember(value);
    return q;
  }
  Utime utime() { return 1'600'000'000'000'000 + ++count_; }
  std::string word() { return "word-" + std::to_string(++count_); }
  int whole() { return ++count_ * 1000; }
  std::vector<double> list() { return {number(), number(), number()}; }
  [[nodiscard]] const std::set<double>& numbers() const { return numbers_; }

 private:
  double remember(double value) {
    numbers_.insert(value);
    return value;
  }
  int count_{};
  std::set<double> numbers_;
};

using Vector3 = Eigen::Vector3d;

inline void fill(Fill& f, Ahrs& s) {
  s = {f.utime(), f.matrix<Vector3>(), f.matrix<Vector3>(), f.quaternion(), true, false, true};
}
inline void fill(Fill& f, Dvl& s) { s = {f.utime(), f.matrix<Vector3>(), f.number(), false, true}; }
inline void fill(Fill& f, Usbl& s) { s = {f.utime(), f.matrix<Vector3>(), f.matrix<Vector3>(), false}; }
inline void fill(Fill& f, Depth& s) { s = {f.utime(), f.number()}; }
inline void fill(Fill& f, Ranges& s) { s = {f.utime(), f.list(), {1, 0, 1}}; }
inline void fill(Fill& f, Loads& s) { s = {f.utime(), f.list()}; }
inline void fill(Fill& f, Signal& s) { s = {f.utime(), f.word(), f.word(), f.word(), f.number()}; }
inline void fill(Fill& f, PoseCapture& s) { s = {f.utime(), f.matrix<Vector3>(), f.quaternion(), false, true, false}; }
inline void fill(Fill& f, Battery& s) { s = {f.utime(), f.number()}; }
inline void fill(Fill& f, Thrusters& s) {
  s = {f.utime(), f.list(), {f.number(), f.number()}, {}, true};
  for (double& value : s.tau) value = f.number();
}
inline void fill(Fill& f, Camera& s) { s = {f.utime(), f.word(), f.whole(), f.whole(), {255, 216, 0, 7}}; }
inline void fill(Fill& f, TagPose& s) {
  s = {f.utime(), f.word(), f.whole(), f.matrix<Vector3>(), f.quaternion(), f.number()};
}
inline void fill(Fill& f, OpticalFlow& s) {
  s = {f.utime(), f.word(), f.number(), f.matrix<Vector3>(), f.matrix<Eigen::Matrix3d>(), f.whole()};
}
inline void fill(Fill& f, LaserRange& s) { s = {f.utime(), f.word(), f.matrix<Vector3>(), f.number()}; }
inline void fill(Fill& f, WrenchCommand& s) {
  s = {f.utime(), f.matrix<Vector6d>(), f.number(), f.word(), f.whole(), f.whole(), f.whole()};
}
inline void fill(Fill& f, Operator& s) {
  s = {f.utime(), f.whole(), f.whole(), false, true, f.word(), f.matrix<Vector6d>(), f.word(), f.number(), f.number()};
}
inline void fill(Fill& f, Answer& s) {
  s = {f.utime(), f.word(), true, f.whole(), f.whole(), f.whole(), true, true, f.word()};
}
inline void fill(Fill& f, Excitation& s) {
  s = {f.utime(), true,     f.word(),   f.word(),   f.number(), f.number(), f.matrix<Vector6d>(),
       f.word(),  f.word(), f.number(), f.number(), f.word(),   true,       {f.word(), f.word()}};
}
inline void fill(Fill& f, StateEstimate& s) {
  s = {f.utime(), f.matrix<Vector3>(), f.quaternion(), f.matrix<Vector6d>(), f.matrix<Eigen::Matrix<double, 12, 1>>(),
       true,      f.matrix<Matrix6d>()};
  for (double& value : s.age) value = f.number();
}
inline void fill(Fill& f, SmoothedState& s) {
  s = {f.utime(),
       f.matrix<Vector3>(),
       f.quaternion(),
       f.matrix<Vector6d>(),
       f.matrix<Vector6d>(),
       f.matrix<Eigen::Matrix<double, 18, 1>>()};
}
inline void fill(Fill& f, ModelEstimate& s) {
  s = {f.utime(), {}, {f.word(), f.word(), f.word()}, {}, f.whole()};
  for (int i = 0; i < 3; ++i) s.effect_numbers.push_back({f.word(), f.number(), f.number(), f.word()});
  for (int i = 0; i < 2; ++i) s.parameters.push_back({f.word(), f.number(), f.number(), f.word()});
  for (int i = 0; i < 2; ++i) s.modes.push_back({f.word(), f.number(), f.number()});
  s.covariance = f.list();
  s.residual_ratio = f.matrix<Vector6d>();
  s.residual_mean = f.matrix<Vector6d>();
  s.residual_excess = f.matrix<Vector6d>();
  s.frozen = {f.word(), f.word()};
  s.joint = true;
}
inline void fill(Fill& f, Residual& s) { s = {f.utime(), f.matrix<Vector6d>()}; }
inline void fill(Fill& f, EffectRanking& s) {
  s = {f.utime(), f.word(), {}, f.word(), f.word(), f.number()};
  for (int i = 0; i < 2; ++i) s.candidates.push_back({f.word(), f.number(), f.number(), f.word(), f.list()});
}
inline void fill(Fill& f, LearnedTold& s) {
  s = {f.utime(), true, f.number(), f.number(), f.number(), f.word(), f.word(), {}};
  for (int i = 0; i < 2; ++i) s.numbers.push_back({f.word(), f.number(), f.number(), f.word()});
}
inline void fill(Fill& f, Truth& s) {
  s = {f.utime(),           f.matrix<Vector3>(), f.quaternion(), f.matrix<Vector6d>(), f.matrix<Vector6d>(),
       f.matrix<Vector3>(), f.matrix<Vector6d>()};
}
inline void fill(Fill& f, Health& s) {
  s = {f.utime(), f.word(),  f.word(),  f.whole(),  f.whole(),  f.whole(), f.word(), f.whole(),
       f.whole(), f.whole(), f.whole(), f.number(), f.number(), f.whole(), f.word(), {}};
  for (int i = 0; i < 2; ++i) s.channels.push_back({f.word(), f.number(), f.number()});
}
inline void fill(Fill& f, ProcessInfo& s) { s = {f.utime(), f.word(), f.word(), f.word(), f.word()}; }

}  // namespace fathom::test
