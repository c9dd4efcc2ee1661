// What pictures need from long series: fewer points, binned medians, autocorrelation, dependence on another quantity.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fathom::report {

/// A polyline; NaN in both parts the strokes.
struct Polyline {
  std::vector<double> x;
  std::vector<double> y;
};

/// At most about `max_points` points that keep every visible extreme. Broken where y is not finite and before each
/// sample index in `breaks` (rising).
[[nodiscard]] Polyline decimate(std::span<const double> x, std::span<const double> y, std::size_t max_points,
                                std::span<const std::size_t> breaks = {});

/// Median and quartiles of y in one bin of x.
struct Bin {
  double x{};  ///< median of x
  double low{};
  double median{};
  double high{};
};

/// Bins of equal count over the finite pairs; fewer when there are few pairs.
[[nodiscard]] std::vector<Bin> binned(std::span<const double> x, std::span<const double> y, std::size_t bins);

/// Share of y's variance that follows x (correlation ratio over `bins` bins), less what chance gives when only
/// this share (0..1) of the samples is independent. 0..1; NaN when x does not vary or there is too little data.
[[nodiscard]] double dependence(std::span<const double> x, std::span<const double> y, std::size_t bins,
                                double independent_share);

/// Autocorrelation of several records of one process at lags 0, stride, 2 stride, ... (`count` of them); NaN skipped.
[[nodiscard]] std::vector<double> autocorrelation(std::span<const std::vector<double>> records, std::size_t stride,
                                                  std::size_t count);

/// Value at `share` (0..1) of the sorted finite values; NaN when there are none.
[[nodiscard]] double quantile(std::span<const double> values, double share);

}  // namespace fathom::report
