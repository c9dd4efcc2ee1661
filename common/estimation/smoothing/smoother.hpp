// Fixed-interval smoother: the estimates of Rauch, Tung and Striebel, reached by the adjoint recursion of Bryson and
// Frazier (Bierman 1977, ch. X). No covariance is inverted: what later observations say is carried back as a vector and
// a matrix that stays positive by construction, through the same structured transition that the filter uses.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/estimation/online/kalman_filter.hpp"

namespace fathom::estimation {

/// What a filter did, instant by instant; entry 0 is where it stood before.
template <int N>
struct FilterRecord {
  using State = typename KalmanFilter<N>::State;
  using Covariance = typename KalmanFilter<N>::Covariance;
  struct Instant {
    State x;  ///< after all observations
    Covariance P;
    std::optional<Eigen::Matrix3d> reference{};  ///< of the angles: see KalmanFilter
    std::optional<Transition> step{};            ///< that led here, if time went on
    std::optional<Eigen::Matrix3d> turned{};     ///< before the step that led here: see KalmanFilter
    std::size_t taken{};                         ///< observations taken in up to and with this instant
  };
  struct Taken {
    State row, gain;
    double innovation{}, variance{};
  };

  std::vector<Instant> instants;
  std::vector<Taken> taken;

  void begin(const KalmanFilter<N>& filter);
  /// Where the filter stands; `went_on`: after a predict() since the instant before.
  void add(bool went_on, const KalmanFilter<N>& filter);
  void add(const model::Observation& observation, const typename KalmanFilter<N>::Outcome& outcome);
};

/// The smoothed estimate at one instant.
template <int N>
class Smoothed {
 public:
  using State = typename KalmanFilter<N>::State;
  using Covariance = typename KalmanFilter<N>::Covariance;
  Smoothed(const typename FilterRecord<N>::Instant& filtered, const State& lambda, const Covariance& Lambda)
      : filtered_{filtered}, lambda_{lambda}, Lambda_{Lambda} {}

  [[nodiscard]] const std::optional<Eigen::Matrix3d>& reference() const { return filtered_.reference; }
  [[nodiscard]] State state() const;
  [[nodiscard]] Covariance covariance() const;
  [[nodiscard]] State variance() const;  ///< the covariance's diagonal, for half the price

 private:
  const typename FilterRecord<N>::Instant& filtered_;
  const State& lambda_;
  const Covariance& Lambda_;
};

template <int N>
class Smoother {
 public:
  using Visit = std::function<void(std::size_t instant, const Smoothed<N>&)>;

  /// Goes back over a record, newest instant first; entry 0 is not visited. Records of one run follow each other,
  /// newest first.
  void back_over(const FilterRecord<N>& record, const Visit& visit);

 private:
  using State = typename KalmanFilter<N>::State;
  using Covariance = typename KalmanFilter<N>::Covariance;
  State lambda_{State::Zero()};
  Covariance Lambda_{Covariance::Zero()};
};

extern template struct FilterRecord<model::kKinematicStates>;
extern template struct FilterRecord<model::kInertialStates>;
extern template struct FilterRecord<model::kLoggedStates>;
extern template struct FilterRecord<model::kMostStates>;
extern template class Smoothed<model::kKinematicStates>;
extern template class Smoothed<model::kInertialStates>;
extern template class Smoothed<model::kLoggedStates>;
extern template class Smoothed<model::kMostStates>;
extern template class Smoother<model::kKinematicStates>;
extern template class Smoother<model::kInertialStates>;
extern template class Smoother<model::kLoggedStates>;
extern template class Smoother<model::kMostStates>;

}  // namespace fathom::estimation
