// A kind of factor: what features of a learned force can read. A new one is a source of this folder and a line of
// factors.def; what needs a memory is a field of FeatureState besides.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "common/base/brief_number.hpp"
#include "common/model/learned/features.hpp"

namespace fathom::model {

/// What `index` of a factor counts.
enum class Indexed : std::uint8_t { kNothing, kAxes, kThrusters, kHarmonics, kColumns };

struct FactorKind {
  std::string_view word;      ///< in result.json
  std::string_view sentence;  ///< what it reads
  std::string_view unit;
  Indexed indexed{Indexed::kNothing};
  int banks{};           ///< low passes that it may read
  bool moves{false};     ///< it goes with the velocity
  bool in_time{false};   ///< it goes with the clock: another run is another time
  bool grows{false};     ///< with the clock, and stays what it has become
  bool of_point{false};  ///< a, b and c are a point in W, m, and no widths
  double (*value)(const Factor&, const FeatureState&){};
  /// Its rate with the clock alone, 1/s: what swings has one, so that water that swings has an acceleration. A moment
  /// or a ramp has none: how fast a stream sets in is not known.
  double (*rate)(const Factor&, const FeatureState&){};
  std::string (*words)(const Factor&){};  ///< Fossen's notation
  std::string (*where)(const Factor&){};  ///< of a law: "point at N 1 m, E 2 m"; none: it is at no place
  /// 1 where its recording has been, falling beyond; none: it is bounded by itself.
  double (*within)(const Factor&, const FeatureState&, const Visited&){};
};

#define FACTOR(enumerator, name) extern const FactorKind factor_##name;
#include "common/model/learned/factors/factors.def"
#undef FACTOR

/// 1 up to kVisitedReach times the visited size, half of it more leaves 61 %, all of it 14 %.
[[nodiscard]] inline double fade_beyond(double x, double visited) {
  constexpr double kWidth = 0.5, kLeast = 1e-6;
  const double over = std::abs(x) / std::max(visited, kLeast) - kVisitedReach;
  return over <= 0.0 ? 1.0 : std::exp(-0.5 * over * over / (kWidth * kWidth));
}
/// The same of a place within [low, high].
[[nodiscard]] inline double fade_outside(double x, double low, double high) {
  return fade_beyond(x - 0.5 * (low + high), 0.5 * (high - low));
}

[[nodiscard]] inline std::string axis_name(const char* const (&names)[6], int index) {
  if (index == kOwn) return "i";
  return index >= 0 && index < 6 ? names[index] : "?";
}
constexpr const char* kNuNames[6]{"u", "v", "w", "p", "q", "r"};
constexpr const char* kTauNames[6]{"X", "Y", "Z", "K", "M", "N"};

}  // namespace fathom::model
