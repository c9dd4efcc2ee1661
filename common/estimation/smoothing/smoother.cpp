#include "common/estimation/smoothing/smoother.hpp"

namespace fathom::estimation {
template <int N>
void FilterRecord<N>::begin(const KalmanFilter<N>& filter) {
  instants.clear();
  taken.clear();
  add(false, filter);
}

template <int N>
void FilterRecord<N>::add(bool went_on, const KalmanFilter<N>& filter) {
  Instant& instant = instants.emplace_back();
  instant.x = filter.state();
  instant.P = filter.covariance();
  instant.reference = filter.reference();
  if (went_on) {
    instant.step = filter.transition();
    instant.turned = filter.turned();
  }
  instant.taken = taken.size();
}

template <int N>
void FilterRecord<N>::add(const model::Observation& observation, const typename KalmanFilter<N>::Outcome& outcome) {
  if (!outcome.used) return;
  Taken& one = taken.emplace_back();
  one.row = observation.row.template head<N>();
  one.gain = outcome.gain;
  one.innovation = outcome.innovation;
  one.variance = outcome.variance;
}

template <int N>
typename Smoothed<N>::State Smoothed<N>::state() const {
  return filtered_.x - filtered_.P * lambda_;
}

template <int N>
typename Smoothed<N>::Covariance Smoothed<N>::covariance() const {
  Covariance LP;
  LP.noalias() = Lambda_ * filtered_.P;
  Covariance P = filtered_.P;
  P.noalias() -= filtered_.P * LP;
  return 0.5 * (P + P.transpose());
}

template <int N>
typename Smoothed<N>::State Smoothed<N>::variance() const {
  // Lambda is the sum of a half and its transpose, which both give the diagonal of P Lambda P alike: blocks above the
  // diagonal need not be multiplied.
  constexpr int kBlock = N % 6 == 0 ? 6 : 9;
  static_assert(N % kBlock == 0);
  const Covariance& P = filtered_.P;
  State variance = P.diagonal();
  Eigen::Matrix<double, kBlock, N> half;
  for (int b = 0; b < N; b += kBlock) {
    const auto rows = P.template middleRows<kBlock>(b);
    half = (0.5 * Lambda_.template block<kBlock, kBlock>(b, b)).lazyProduct(rows);
    for (int c = 0; c < b; c += kBlock)
      half += Lambda_.template block<kBlock, kBlock>(b, c).lazyProduct(P.template middleRows<kBlock>(c));
    variance -= 2.0 * rows.cwiseProduct(half).colwise().sum().transpose();
  }
  return variance;
}

template <int N>
void Smoother<N>::back_over(const FilterRecord<N>& record, const Visit& visit) {
  for (std::size_t k = record.instants.size() - 1; k > 0; --k) {
    visit(k, Smoothed<N>{record.instants[k], lambda_, Lambda_});
    for (std::size_t n = record.instants[k].taken; n > record.instants[k - 1].taken; --n) {
      const typename FilterRecord<N>::Taken& one = record.taken[n - 1];
      const State v = Lambda_.lazyProduct(one.gain);  // of a size that is known: no call of a general product
      lambda_ -= one.row * (one.gain.dot(lambda_) + one.innovation / one.variance);
      // (I - k h')' L (I - k h') + h h' / S, as one symmetric update of rank two.
      const State half = v - (0.5 * (one.gain.dot(v) + 1.0 / one.variance)) * one.row;
      for (int i = 0; i < N; ++i) {  // most instruments see a few states
        const double share = one.row[i];
        if (share == 0.0) continue;
        Lambda_.row(i) -= share * half.transpose();
        Lambda_.col(i) -= share * half;
      }
    }
    if (!record.instants[k].step) continue;
    const Transition& F = *record.instants[k].step;
    transport_back<N>(F, lambda_);
    transport_back<N>(F, Lambda_);
    Lambda_.transposeInPlace();
    transport_back<N>(F, Lambda_);
    if (record.instants[k].turned) {
      const Eigen::Matrix3d& M = *record.instants[k].turned;
      constexpr int kAngles = model::at::kAngles;
      const Eigen::Vector3d part = M.transpose() * lambda_.template segment<3>(kAngles);
      lambda_.template segment<3>(kAngles) = part;
      const Eigen::Matrix<double, N, 3> columns = Lambda_.template middleCols<3>(kAngles) * M;
      Lambda_.template middleCols<3>(kAngles) = columns;
      const Eigen::Matrix<double, 3, N> rows = M.transpose() * Lambda_.template middleRows<3>(kAngles);
      Lambda_.template middleRows<3>(kAngles) = rows;
    }
    for (int column = 1; column < N; ++column) {
      for (int row = 0; row < column; ++row) Lambda_(row, column) = Lambda_(column, row);
    }
  }
}

template struct FilterRecord<model::kKinematicStates>;
template struct FilterRecord<model::kInertialStates>;
template struct FilterRecord<model::kLoggedStates>;
template struct FilterRecord<model::kMostStates>;
template class Smoothed<model::kKinematicStates>;
template class Smoothed<model::kInertialStates>;
template class Smoothed<model::kLoggedStates>;
template class Smoothed<model::kMostStates>;
template class Smoother<model::kKinematicStates>;
template class Smoother<model::kInertialStates>;
template class Smoother<model::kLoggedStates>;
template class Smoother<model::kMostStates>;

}  // namespace fathom::estimation
