// Random draws that are the same on every machine: the standard's engine, but not its distributions.
#pragma once

#include <cstdint>
#include <random>

namespace fathom::excitation {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_{seed} {}
  /// In [low, high).
  [[nodiscard]] double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1.0p-53;
  }
  [[nodiscard]] double sign() { return engine_() >> 63U != 0 ? 1.0 : -1.0; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fathom::excitation
