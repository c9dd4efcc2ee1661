#include "common/diagnosis/left_to_explain.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/parallel.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kLasts = 2.0;  // s: slower than what a smoother makes of the noise of sensors
constexpr int kHalvings = 2;    // of that: bands that tell how strong the noise is
constexpr std::size_t kBands = kHalvings + 2;

/// Squares and their number in bands of time: what means over kLasts keep, what means over half of that keep beyond,
/// and so on; last, what single samples hold beyond the shortest means: noise, and less of it where it was smoothed.
struct Bands {
  std::array<double, kBands> square{}, count{};
};

/// Of consecutive rows of one axis.
void add(const Eigen::Ref<const Eigen::VectorXd>& rows, Eigen::Index longest, Bands& bands) {
  const Eigen::Index used = rows.size() / longest * longest;
  double coarser = 0.0, cells_of_coarser = 0.0;
  for (std::size_t band = 0; band < kBands; ++band) {
    const Eigen::Index length = band + 1 < kBands ? longest >> band : 1;
    double square = 0.0;
    for (Eigen::Index i = 0; i < used; i += length) {
      const double sum = rows.segment(i, length).sum();
      square += sum * sum / static_cast<double>(length);
    }
    const auto cells = static_cast<double>(used / length);
    bands.square[band] += square - coarser;
    bands.count[band] += cells - cells_of_coarser;
    coarser = square;
    cells_of_coarser = cells;
  }
}

}  // namespace

double left_to_explain(const identification::TrajectoryFit& problem, const identification::FitResult& fit) {
  const auto windows = problem.windows();
  std::vector<std::array<Bands, 6>> of_window(windows.size());
  bool told = !windows.empty();
  for (const auto& window : windows) told = told && window.window().trial->dt * (2 << kHalvings) <= kLasts;
  if (!told) return 1.0;
  for_each_index(windows.size(), problem.settings().threads, [&](std::size_t w) {
    const identification::WindowResidual& window = windows[w];
    model::VelocityTrace trace;
    Eigen::VectorXd residual(window.rows());
    window.evaluate(fit.model, fit.nu0[w], fit.sigma, trace, residual);
    // A multiple of the shortest means' length.
    const auto longest = static_cast<Eigen::Index>(kLasts / window.window().trial->dt) >> kHalvings << kHalvings;
    for (const identification::AxisRows& rows : window.axes()) {
      if (rows.count < longest) continue;
      const auto axis = static_cast<std::size_t>(window.axis(rows.first));
      add(residual.segment(rows.first, rows.count), longest, of_window[w][axis]);
    }
  });
  double left = 0.0, chance = 0.0, all = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    Bands sum;
    for (const auto& window : of_window) {
      for (std::size_t band = 0; band < kBands; ++band) {
        sum.square[band] += window[axis].square[band];
        sum.count[band] += window[axis].count[band];
        all += window[axis].square[band];
      }
    }
    if (!(sum.count[0] > 0.0)) continue;
    const double noise = std::min(sum.square[1] / sum.count[1], sum.square[2] / sum.count[2]);
    left += std::max(sum.square[0] - noise * sum.count[0], 0.0);
    chance += 2.0 * sum.count[0] * noise * noise;
  }
  return all > 0.0 ? std::min((left + 2.0 * std::sqrt(chance)) / all, 1.0) : 0.0;
}

}  // namespace fathom::diagnosis
