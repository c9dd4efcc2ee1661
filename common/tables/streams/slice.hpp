// Some rows of a table, and what happened to those of one stream.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/tables/readers.hpp"

namespace fathom::tables {

/// Some of a table's rows, in the order of time.
struct Slice {
  std::vector<std::size_t> index;
  std::vector<Utime> utime;
};

// What happened to one stream, as sentences.
struct Count {
  static constexpr std::size_t kSeldom = 3;  // empty rows of this many that are not: no dropouts any more
  std::string stream;
  std::size_t kept{};
  std::size_t missing{};
  std::size_t empty{};  ///< rows in which all its cells are empty: they belong to other streams, or are dropouts
  std::size_t no_attitude{};
  std::size_t flagged{};
  std::size_t held{};
  std::size_t not_unit{};
  std::size_t no_stick{};

  void report(const CsvTable& table, std::vector<std::string>& notes) const {
    if (kept == 0) throw InputError(table.path + ": not one whole sample of " + stream);
    const auto say = [&](std::size_t count, const std::string& what) {
      if (count > 0) notes.push_back(stream + ": " + std::to_string(count) + " samples " + what);
    };
    // A few whole rows that are empty are dropouts; many are a stream that comes more seldom than the table's rows.
    if (kSeldom * empty > kept + missing) {
      notes.push_back(stream + ": in " + std::to_string(kept + missing) + " of " +
                      std::to_string(kept + missing + empty) + " rows, the others belong to other streams");
      say(missing, "refused (empty or NaN)");
    } else {
      say(missing + empty, "refused (empty or NaN)");
    }
    say(no_attitude, "refused: no attitude near them turns the world's axes into the body's");
    say(flagged, "marked or left out as invalid by their flags");
    say(held, "repeat the one before (held)");
    say(no_stick, "left out: a stick's channel told no pulse");
    say(not_unit, "invalid because their quaternion is not of unit length");
  }
};

// Calls use(row, utime) for every row in which all of `groups` hold numbers; counts the others.
template <typename Use>
void each_complete(const Slice& rows, const std::vector<const Group*>& groups, Count& count, const Use& use) {
  for (std::size_t k = 0; k < rows.index.size(); ++k) {
    const std::size_t row = rows.index[k];
    if (std::all_of(groups.begin(), groups.end(), [&](const Group* group) { return group->complete(row); })) {
      use(row, rows.utime[k]);
    } else {
      const bool none = std::ranges::all_of(groups, [&](const Group* group) { return group->empty(row); });
      ++(none ? count.empty : count.missing);
    }
  }
}

// As above, and leaves out what the flags call invalid.
template <typename Use>
void each_usable(const Slice& rows, const std::vector<const Group*>& groups, const Flags& invalid, Count& count,
                 const Use& use) {
  each_complete(rows, groups, count, [&](std::size_t row, Utime utime) {
    if (invalid.set(row)) {
      ++count.flagged;
    } else {
      use(row, utime);
    }
  });
}

inline std::optional<Group> optional_group(Resolver& resolve, const std::optional<ColumnGroup>& group) {
  return group ? std::optional<Group>(Group(resolve, *group)) : std::nullopt;
}

inline std::optional<AttitudeReader> optional_attitude(Resolver& resolve,
                                                       const std::optional<AttitudeColumns>& columns) {
  return columns ? std::optional<AttitudeReader>(AttitudeReader(resolve, *columns)) : std::nullopt;
}

}  // namespace fathom::tables
