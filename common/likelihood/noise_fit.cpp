#include "common/likelihood/noise_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/factors.hpp"
#include "common/likelihood/processor.hpp"

namespace fathom::likelihood {
namespace {

constexpr int kLanes = 8;  // filters run side by side: the numbers themselves and one moved in each, or trial steps
/// One number of each filter: arithmetic on it runs through the processor's vectors.
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
using LaneLogs = std::array<NoiseLogs, kLanes>;
using Information = Eigen::Matrix<double, kNoiseNumbers, kNoiseNumbers>;

constexpr double kStep = 1e-3;                                // of a logarithm, for differences
constexpr double kLongest = 1.5;                              // of a logarithm, in one step
constexpr double kEnough = 0.02;                              // nats: what one iteration must gain
constexpr double kMemory = 1.0, kFloor = 0.05, kMost = 25.0;  // FollowedScale's
constexpr int kTogether = 8;  // factors of one logarithm: variances of 1e-30 do not yet underflow

struct Scored {
  std::array<double, kLanes> log_likelihood{};
  Information information{Information::Zero()};
};

/// Sum of logarithms as logarithms of products.
class LogSum {
 public:
  [[gnu::always_inline]] void times(const Lanes& factor, std::array<double, kLanes>& sum, double weight) {
    product_ *= factor;
    if (++count_ < kTogether) return;
    flush(sum, weight);
  }
  [[gnu::always_inline]] void flush(std::array<double, kLanes>& sum, double weight) {
    for (std::size_t l = 0; l < kLanes; ++l) sum[l] += weight * std::log(product_[l]);
    product_ = 1.0 - Lanes{};
    count_ = 0;
  }

 private:
  Lanes product_{1.0 - Lanes{}};
  int count_{};
};

/// What the noise numbers come to over a block, per lane.
struct LaneNoise {
  Lanes force{}, memory{}, white{}, sensor{}, colour{}, rho{}, rho_c{};
  LaneNoise(const LaneLogs& logs, double dt) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const auto of = [&](NoiseNumber number) { return std::exp(logs[l][number]); };
      force[l] = of(kForce) * of(kForce);
      memory[l] = of(kForceMemory);
      white[l] = of(kWhiteForce) * of(kWhiteForce) * dt;
      sensor[l] = of(kSensor) * of(kSensor);
      colour[l] = of(kColoured) * of(kColoured);
      rho[l] = std::exp(-dt / memory[l]);
      rho_c[l] = std::exp(-dt / of(kColourMemory));
    }
  }
};

/// Expected information of the numbers, from lane 0 and the six lanes behind it.
[[gnu::always_inline]] inline void add_information(const Lanes& e, const Lanes& S, double of_location, double of_scale,
                                                   Information& information) {
  std::array<double, kNoiseNumbers> de{}, dS{};
  for (std::size_t j = 0; j < kNoiseNumbers; ++j) {
    de[j] = (e[j + 1] - e[0]) / kStep;
    dS[j] = (S[j + 1] - S[0]) / kStep;
  }
  for (std::size_t i = 0; i < kNoiseNumbers; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) +=
          de[i] * de[j] * of_location + dS[i] * dS[j] * of_scale;
}

/// The filter of filter_pass.hpp for one axis.
[[gnu::always_inline]] inline void add_lanes(const std::vector<ReducedBlock>& blocks, const LaneLogs& logs,
                                             const Tail& tail, bool with_information, Scored& scored) {
  if (blocks.empty()) return;
  const double dt = blocks.front().dt;
  const LaneNoise noise{logs, dt};
  const Lanes rho = noise.rho, rho_c = noise.rho_c, R = noise.sensor;
  const Lanes mean_force = (1.0 - rho) * noise.memory / dt, fresh = noise.force * (1.0 - rho * rho);
  const Lanes Q_c = noise.colour * (1.0 - rho_c * rho_c);
  Lanes nn = 4.0 * R + noise.colour, nd{}, nc = -noise.colour, dd = noise.force, dc{}, cc = noise.colour;
  Lanes n{}, d{}, c{}, followed = 1.0 - Lanes{}, squares{};
  const double keep = std::exp(-dt / kMemory);
  const double freedom = tail.freedom;
  const double gain_location = freedom > 0.0 ? (freedom + 1.0) / (freedom + 3.0) : 1.0;
  const double gain_scale = 0.5 * (freedom > 0.0 ? freedom / (freedom + 3.0) : 1.0);
  Lanes least = nn;  // a filter whose variance is not positive has failed
  LogSum of_variance, of_tail;
  for (const ReducedBlock& block : blocks) {
    const double F = block.F, lag = block.lag, late = 1.0 - block.lag;
    const Lanes g = block.G * mean_force;
    const Lanes T_nn = F * nn + g * nd, T_nd = F * nd + g * dd, T_nc = F * nc + g * dc;
    const Lanes Z = nn + 2.0 * nc + cc, C_n = T_nn + T_nc, C_d = rho * (nd + dc), C_c = rho_c * (nc + cc);
    const Lanes before = n + c;
    nn = F * T_nn + g * T_nd;
    nd = rho * T_nd;
    nc = rho_c * T_nc;
    dd = rho * rho * dd;
    dc = rho * rho_c * dc;
    cc = rho_c * rho_c * cc;
    const Lanes D_n = nn + nc, D_d = nd + dc, D_c = nc + cc;
    const Lanes white = noise.white + block.others;
    nn += white + fresh * (dt * dt / 3.0);
    nd += (0.5 * dt) * fresh;
    dd += fresh;
    cc += Q_c;
    n = F * n + g * d + block.r;
    d *= rho;
    c *= rho_c;
    if (block.n <= 0.0) continue;
    const Lanes S = late * late * (D_n + D_c) + lag * lag * Z + (2.0 * late * lag) * (C_n + C_c) +
                    block.walk * (white + Q_c) + (block.force_mean * dt * dt) * fresh + R / block.n;
    const Lanes e = block.z - lag * before - late * (n + c), inverse = 1.0 / S, square = e * e * inverse;
    least = S < least ? S : least;
    if (block.scored) {
      const Lanes scale = tail.follows ? kFloor + (1.0 - kFloor) * followed : 1.0 - Lanes{};
      of_variance.times(S * scale, scored.log_likelihood, -0.5);
      if (freedom > 0.0) {
        of_tail.times(1.0 + square / (freedom * scale), scored.log_likelihood, -0.5 * (freedom + 1.0));
      } else {
        squares += square / scale;
      }
      if (with_information)
        add_information(e, S, gain_location * inverse[0] / scale[0], gain_scale * inverse[0] * inverse[0],
                        scored.information);
    }
    if (tail.follows) followed = keep * followed + (1.0 - keep) * (square < kMost ? square : kMost + Lanes{});
    const Lanes K_n = (late * D_n + lag * C_n + late * white + (block.force_end * dt * dt) * fresh) * inverse,
                K_d = (late * D_d + lag * C_d + (block.force_walk * dt) * fresh) * inverse,
                K_c = (late * D_c + lag * C_c + late * Q_c) * inverse;
    n += K_n * e;
    d += K_d * e;
    c += K_c * e;
    nn -= K_n * K_n * S;
    nd -= K_n * K_d * S;
    nc -= K_n * K_c * S;
    dd -= K_d * K_d * S;
    dc -= K_d * K_c * S;
    cc -= K_c * K_c * S;
  }
  of_variance.flush(scored.log_likelihood, -0.5);
  of_tail.flush(scored.log_likelihood, -0.5 * (freedom + 1.0));
  for (std::size_t l = 0; l < kLanes; ++l) {
    scored.log_likelihood[l] -= 0.5 * squares[l];
    if (!(least[l] > 0.0)) scored.log_likelihood[l] = -std::numeric_limits<double>::infinity();
  }
}

#if defined(FATHOM_AVX2)
FATHOM_AVX2 void add_lanes_avx2(const std::vector<ReducedBlock>& blocks, const LaneLogs& logs, const Tail& tail,
                                bool with_information, Scored& scored) {
  add_lanes(blocks, logs, tail, with_information, scored);
}
#endif

void run_lanes(const std::vector<ReducedBlock>& blocks, const LaneLogs& logs, const Tail& tail, bool with_information,
               Scored& scored) {
#if defined(FATHOM_AVX2)
  if (has_avx2()) return add_lanes_avx2(blocks, logs, tail, with_information, scored);
#endif
  add_lanes(blocks, logs, tail, with_information, scored);
}

Scored score(std::span<const std::vector<ReducedBlock>* const> runs, const LaneLogs& logs, const Tail& tail,
             bool with_information) {
  Scored scored;
  for (const auto* run : runs) run_lanes(*run, logs, tail, with_information, scored);
  return scored;
}

double or_never(double value) { return std::isfinite(value) ? value : -std::numeric_limits<double>::infinity(); }

}  // namespace

double reduced_log_likelihood(std::span<const std::vector<ReducedBlock>* const> runs, const AxisNoise& noise) {
  LaneLogs logs;
  logs.fill(noise.log);
  double count = 0.0;
  for (const auto* run : runs)
    for (const ReducedBlock& block : *run) count += block.scored && block.n > 0.0 ? 1.0 : 0.0;
  // run_lanes leaves out the density's constant.
  return score(runs, logs, noise.tail, false).log_likelihood[0] + count * TailDensity{noise.tail}(0.0, 1.0).log_density;
}

NoiseFit fit_noise(std::span<const std::vector<ReducedBlock>* const> runs, const AxisNoise& start,
                   const NoisePrior& prior, int iterations) {
  NoiseFit fit{.noise = start};
  NoiseLogs& at = fit.noise.log;
  for (int turn = 0; turn < iterations; ++turn) {
    LaneLogs logs;
    logs.fill(at);
    for (std::size_t j = 0; j < kNoiseNumbers; ++j) logs[j + 1][j] += kStep;
    const Scored here = score(runs, logs, start.tail, true);
    if (!std::isfinite(here.log_likelihood[0])) break;
    Information information = here.information.selfadjointView<Eigen::Lower>();
    Eigen::Matrix<double, kNoiseNumbers, 1> gradient;
    for (std::size_t j = 0; j < kNoiseNumbers; ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const double weight = 1.0 / (prior.sigma[j] * prior.sigma[j]);
      gradient[i] = (here.log_likelihood[j + 1] - here.log_likelihood[0]) / kStep - weight * (at[j] - prior.mean[j]);
      information(i, i) += weight;
    }
    if (0.5 * gradient.dot(solve_symmetric(information, gradient)) < 0.1 * kEnough) break;
    // Trial steps, each with its own damping, all in one pass.
    LaneLogs trials;
    for (int l = 0; l < kLanes; ++l) {
      Information damped = information;
      damped.diagonal() *= 1.0 + (l == 0 ? 0.0 : std::pow(10.0, l - 4));
      const Eigen::Matrix<double, kNoiseNumbers, 1> step = solve_symmetric(damped, gradient);
      for (std::size_t j = 0; j < kNoiseNumbers; ++j) {
        const double moved = at[j] + std::clamp(step[static_cast<Eigen::Index>(j)], -kLongest, kLongest);
        trials[static_cast<std::size_t>(l)][j] = std::clamp(moved, prior.low[j], prior.high[j]);
      }
    }
    const Scored tried = score(runs, trials, start.tail, false);
    const double now = here.log_likelihood[0] + prior.log_density(at);
    double best = now;
    NoiseLogs found = at;
    for (int l = 0; l < kLanes; ++l) {
      const NoiseLogs& trial = trials[static_cast<std::size_t>(l)];
      const double value = or_never(tried.log_likelihood[static_cast<std::size_t>(l)]) + prior.log_density(trial);
      if (value <= best) continue;
      best = value;
      found = trial;
    }
    at = found;
    fit.gained += best - now;
    if (best - now < kEnough) break;
  }
  return fit;
}

}  // namespace fathom::likelihood
