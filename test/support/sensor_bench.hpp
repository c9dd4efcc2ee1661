// One simulated instrument alone, asked at moments that are worked out by hand, and the moments of its noise.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "test/support/dive_site.hpp"

namespace fathom::test {

inline constexpr double kExact = 1e-9;
// A sample standard deviation of n numbers scatters by 1/sqrt(2 n); four of that is met by all but 6 in 100 000.
inline double four_sigma(std::size_t n) { return 4.0 / std::sqrt(2.0 * static_cast<double>(n)); }

struct Moments {
  double sum{}, squares{};
  std::size_t n{};
  void add(double x) {
    sum += x;
    squares += x * x;
    ++n;
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(n); }
  [[nodiscard]] double sigma() const { return std::sqrt(squares / static_cast<double>(n) - mean() * mean()); }
};

inline void check_sigma(const Moments& moments, double wanted) {
  CAPTURE(moments.n);
  CHECK(moments.sigma() == doctest::Approx(wanted).epsilon(four_sigma(moments.n)));
}
inline void check_mean(const Moments& moments, double wanted, double sigma) {
  CHECK(std::abs(moments.mean() - wanted) < 4.0 * sigma / std::sqrt(static_cast<double>(moments.n)));
}

inline const model::Vehicle& lbv() {
  static const model::Vehicle kVehicle = vehicle_of_file("seabotix_lbv150");
  return kVehicle;
}

/// An instrument alone, with its section's text.
struct Bench {
  model::Vehicle vehicle;
  model::Site site;
  simulation::AhrsTold told{};
  std::unique_ptr<simulation::Sensor> sensor;
  std::vector<simulation::Sample> samples;

  Bench(simulation::MakeSensor make, const std::string& text, const std::string& place, std::uint64_t seed = 1,
        const std::function<void(model::Vehicle&)>& change = {})
      : vehicle{lbv()}, site{site_of_file(place)} {
    if (change) change(vehicle);
    const Config config = Config::parse("rate: 100 Hz\nlatency: 0 s\n" + text, "bench.yaml");
    sensor = make(config, {.vehicle = &vehicle, .site = &site, .seed = seed, .ahrs = &told});
  }
  /// Attitude and rates as a perfect AHRS tells them, then the measurement.
  const std::vector<simulation::Sample>& measure(const simulation::Moment& moment) {
    told.hear({.utime = moment.utime,
               .w_WB_B = moment.nu.tail<3>(),
               .q_WB = moment.q_WB,
               .has_rates = true,
               .has_specific_force = true,
               .has_attitude = true},
              moment);
    samples.clear();
    sensor->measure(moment, samples);
    return samples;
  }
};

inline simulation::Moment moment_at(const Eigen::Vector3d& p, const Eigen::Vector3d& euler = Eigen::Vector3d::Zero(),
                                    const Vector6d& nu = Vector6d::Zero(), const Vector6d& nu_dot = Vector6d::Zero()) {
  simulation::Moment moment{.utime = 1'700'000'000'000'000, .p_WB = p};
  moment.R_WB = rotation_from_euler(euler);
  moment.q_WB = Eigen::Quaterniond{moment.R_WB};
  moment.nu = moment.nu_seen = nu;
  moment.nu_dot = nu_dot;
  return moment;
}

}  // namespace fathom::test
