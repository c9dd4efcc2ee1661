// Random numbers of one source each: a stream is made from the run's seed and a name, so that a sensor more or less
// changes nothing for the others. Own generator and own normal law: the same bits with every standard library.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace fathom::simulation {

/// xoshiro256++ (Blackman and Vigna 2019), seeded by splitmix64.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name) {
    std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a of the name
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    std::uint64_t mixed = seed ^ hash;
    for (std::uint64_t& word : state_) {
      mixed += 0x9E3779B97F4A7C15ULL;
      std::uint64_t z = mixed;
      z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
      z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
      word = z ^ (z >> 31);
    }
  }

  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  bool chance(double probability) { return uniform() < probability; }
  /// Standard normal (Box and Muller 1958); two uniforms each, none kept, so that calls stay countable.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  Eigen::Vector3d normal3(double sigma) {
    Eigen::Vector3d v;
    for (double& x : v) x = sigma * normal();
    return v;
  }

 private:
  std::uint64_t next() {
    const auto rotate = [](std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); };
    const std::uint64_t result = rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate(state_[3], 45);
    return result;
  }

  std::array<std::uint64_t, 4> state_{};
};

}  // namespace fathom::simulation
