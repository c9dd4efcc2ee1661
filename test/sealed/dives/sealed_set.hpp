// One sealed set: everything about it follows from its number.
#pragma once

#include <optional>

#include "test/sealed/craft/base_model.hpp"

namespace fathom::sealed {

/// kMixed: two listed effects beside one that no list holds, each of a size of its own, as real craft have them.
/// kMany: five or six listed ones, each of a size of its own.
enum class Kind { kSingle, kClean, kNoise, kPair, kForeign, kMixed, kMany };
enum class Size { kWeak, kMedium, kStrong };
constexpr std::array<const char*, 7> kKindNames{"single", "clean", "noise", "pair", "foreign", "mixed", "many"};
constexpr std::array<const char*, 3> kSizeNames{"weak", "medium", "strong"};
constexpr std::array<double, 3> kShares{0.05, 0.15, 0.40};  ///< of the applied wrench

/// What the caller wants instead of what the number would draw.
struct Wish {
  std::string effect;  ///< or "clean", "pair", "foreign", "single", "mixed", "many"; "unlisted": one of those in turn
  std::optional<Size> size;
  CraftClass craft_class{};
  bool new_recording{false};  ///< a file for validation in any case
};

struct Plan {
  std::uint64_t seed{};
  Kind kind{};
  Size size{};
  CraftClass craft_class{};
  std::vector<std::string> names;
  std::vector<Size> sizes{};  ///< of each of `names` where they differ; else all are of `size`
  bool one_clock{};  ///< time goes on from file to file; else every file (and what depends on time) begins at zero
  int train_files{1};
  bool validates{true};  ///< false: one long file, the tool has to keep a part for itself
  bool wrench{};         ///< the body wrench is logged, not the thrusters
  bool voltage{};        ///< logged, without meaning
  bool priors{};         ///< the owner states some
  Hold hold{Hold::kLine};
};

struct SealedSet {
  Plan plan;
  Craft craft;
  Site site;
  Noise noise;
  Mechanisms mechanisms;
  std::vector<double> shares;  ///< reached by each mechanism alone
  bool reached{true};          ///< all of them are within 10 % of their class
  BaseFit clean_fit, fit;      ///< of the base model: without the mechanisms, with them
  std::vector<Dive> train;
  std::optional<Dive> validate;
};

/// No set has that number: nobody could have recorded it.
struct RunsAway : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[nodiscard]] Plan make_plan(std::uint64_t seed, const Wish& wish);
[[nodiscard]] SealedSet make_set(const Plan& plan);

}  // namespace fathom::sealed
