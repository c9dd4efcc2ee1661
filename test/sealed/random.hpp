// Random numbers that are the same on every machine: std's engines are specified bit by bit, its distributions are not.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string_view>

namespace fathom::sealed {

class Random {
 public:
  /// A stream of its own for every `purpose`, so that a draw more in one place moves nothing elsewhere.
  Random(std::uint64_t seed, std::string_view purpose) {
    std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a
    for (const char c : purpose) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    engine_.seed(hash ^ (seed * 0x9E3779B97F4A7C15ULL));
    engine_.discard(16);
  }
  [[nodiscard]] double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * unit(); }
  [[nodiscard]] double log_uniform(double low, double high) { return low * std::pow(high / low, unit()); }
  [[nodiscard]] int below(int count) { return static_cast<int>(unit() * count); }
  [[nodiscard]] bool chance(double probability) { return unit() < probability; }
  [[nodiscard]] double sign() { return chance(0.5) ? 1.0 : -1.0; }
  /// Standard normal (Box and Muller 1958).
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
    return radius * std::cos(2.0 * std::numbers::pi * unit());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fathom::sealed
