// Files of a set: what the tool may see in one folder, the truth in another.
#pragma once

#include <string>

#include "test/sealed/dives/sealed_set.hpp"

namespace fathom::sealed {

/// Counts up whenever the same number draws another set: old sets are then drawn again.
constexpr int kGenerator = 5;

/// Where a set lies below the benchmark's folder.
struct Places {
  std::string data;   ///< folder: vehicle.yaml, train-*.csv, validate.csv
  std::string truth;  ///< file
  std::string found;  ///< folder of the diagnosis
};
/// `way`: in which it is asked, where there are several: answers lie apart.
[[nodiscard]] Places places(const std::string& out, std::uint64_t seed, const std::string& way = {});

/// Canonical columns of one file.
[[nodiscard]] std::string to_csv(const SealedSet& set, const Dive& run);
/// What the owner would write: geometry right, mass weighed, the rest guessed widely.
[[nodiscard]] std::string to_vehicle_file(const SealedSet& set);
[[nodiscard]] std::string to_truth(const SealedSet& set);
/// Writes all of them; the truth last, so that its presence says that the set is whole.
void write_set(const SealedSet& set, const Places& where);

}  // namespace fathom::sealed
