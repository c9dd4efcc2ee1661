// The canonical columns: a table that needs no map. docs/configuration.md lists them.
#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/tables/import.hpp"

namespace fathom::tables {
namespace {

constexpr const char* kCanonical =
    "t; x y z; phi theta psi; u v w; p q r; ax ay az; f1..fN or X Y Z K M N; pwm1..pwmN; depth; voltage";

constexpr std::array kNames{"t",  "x",  "y",  "z", "phi", "theta", "psi", "u", "v", "w",     "p",       "q",  "r",
                            "ax", "ay", "az", "X", "Y",   "Z",     "K",   "M", "N", "depth", "voltage", "f1", "pwm1"};

// Takes groups of columns out of the table until only strangers are left.
class Shelf {
 public:
  explicit Shelf(const CsvTable& table) : table_(table), left_(table.names.begin(), table.names.end()) {}

  /// All of `names`, or none; InputError when only some are there.
  std::optional<ColumnGroup> take(const std::vector<std::string>& names) {
    ColumnGroup group;
    std::string there;
    std::string absent;
    for (const std::string& name : names) {
      std::string& list = left_.erase(name) > 0 ? there : absent;
      list += (list.empty() ? "'" : ", '") + name + "'";
      group.columns.push_back({name, ""});
    }
    if (there.empty()) return std::nullopt;
    if (!absent.empty()) {
      throw InputError(table_.path + ":1: columns " + there + " stand without " + absent + "; they go together");
    }
    return group;
  }

  /// Those of `names` that are there, the others marked absent; nothing when none is.
  std::optional<ColumnGroup> take_some(const std::vector<std::string>& names) {
    ColumnGroup group;
    for (const std::string& name : names) group.columns.push_back({name, "", left_.erase(name) == 0});
    if (std::ranges::all_of(group.columns, &Column::absent)) return std::nullopt;
    return group;
  }

  /// prefix1, prefix2, ... as far as they go.
  std::optional<ColumnGroup> take_numbered(const std::string& prefix) {
    ColumnGroup group;
    for (int i = 1; left_.erase(prefix + std::to_string(i)) > 0; ++i) {
      group.columns.push_back({prefix + std::to_string(i), ""});
    }
    return group.columns.empty() ? std::nullopt : std::optional<ColumnGroup>(group);
  }

  /// " (did you mean 'phi'?)" for "Phi", unless there is a "phi" too.
  [[nodiscard]] std::string meant(const std::string& name) const {
    for (const char* known : kNames) {
      if (table_.find(known) == nullptr && looks_like(name, known))
        return std::string(" (did you mean '") + known + "'?)";
    }
    return "";
  }

  /// "f3" where "f4" and no "f3" is there; empty where the numbers go on from the first.
  [[nodiscard]] std::string skipped(const std::string& name) const {
    for (const std::string prefix : {"f", "pwm"}) {
      if (!name.starts_with(prefix) || table_.find(prefix + "1") == nullptr) continue;
      int number = 0;
      const char *begin = name.data() + prefix.size(), *end = name.data() + name.size();
      const auto [rest, error] = std::from_chars(begin, end, number);
      if (error != std::errc{} || rest != end) continue;
      for (int i = 2; i < number; ++i) {
        std::string before = prefix + std::to_string(i);
        if (table_.find(before) == nullptr) return before;
      }
    }
    return "";
  }

  void must_be_empty() const {
    for (const std::string& name : table_.names) {
      const std::string before = left_.contains(name) ? skipped(name) : "";
      if (!before.empty())
        throw InputError(table_.path + ":1: column '" + before + "' is missing, and '" + name +
                         "' is there; a thruster that was not driven has a column of zeros");
    }
    std::string strangers;
    for (const std::string& name : table_.names) {
      if (left_.contains(name)) strangers += (strangers.empty() ? "'" : ", '") + name + "'" + meant(name);
    }
    if (strangers.empty()) return;
    throw InputError(table_.path + ":1: unknown columns " + strangers +
                     "; without a map (--map) these are known: " + kCanonical);
  }

 private:
  const CsvTable& table_;
  std::set<std::string> left_;
};

std::optional<AttitudeColumns> as_euler(const std::optional<ColumnGroup>& group) {
  if (!group) return std::nullopt;
  AttitudeColumns attitude;
  attitude.group = *group;
  attitude.euler = true;
  return attitude;
}

}  // namespace

ColumnMap canonical_map(const CsvTable& table) {
  Shelf shelf(table);
  ColumnMap map;
  const auto time = shelf.take({"t"});
  if (!time) {
    throw InputError(table.path + ":1: column 't' (time in seconds) is missing" +
                     (table.find("T") != nullptr ? " (is it 'T'?)" : "") +
                     "; describe other columns with a map (--map)");
  }
  map.time = *time;
  const auto position = shelf.take_some({"x", "y", "z"});
  const auto attitude = as_euler(shelf.take_some({"phi", "theta", "psi"}));
  // With a position the attitude belongs to the pose; alone it is what an attitude sensor says.
  if (position) map.pose_capture = PoseColumns{position, attitude, {}, {}};
  AhrsColumns ahrs;
  ahrs.rates = shelf.take_some({"p", "q", "r"});
  ahrs.specific_force = shelf.take({"ax", "ay", "az"});
  if (!position) ahrs.attitude = attitude;
  if (ahrs.rates || ahrs.specific_force || ahrs.attitude) map.ahrs = ahrs;
  if (const auto velocity = shelf.take_some({"u", "v", "w"})) map.dvl = DvlColumns{*velocity, {}, {}, {}};
  ThrusterColumns thrusters;
  thrusters.pwm = shelf.take_numbered("pwm");
  thrusters.force = shelf.take_numbered("f");
  if (const auto wrench = shelf.take_some({"X", "Y", "Z", "K", "M", "N"})) {
    thrusters.wrench_force = ColumnGroup{{wrench->columns.begin(), wrench->columns.begin() + 3}};
    thrusters.wrench_moment = ColumnGroup{{wrench->columns.begin() + 3, wrench->columns.end()}};
  }
  if (thrusters.pwm || thrusters.force || thrusters.wrench_force) map.thrusters = thrusters;
  if (const auto depth = shelf.take({"depth"})) map.depth = ScalarColumn{*depth, {}};
  if (const auto voltage = shelf.take({"voltage"})) map.battery = ScalarColumn{*voltage, {}};
  shelf.must_be_empty();
  if (table.names.size() == 1) throw InputError(table.path + ":1: there is no column besides time");
  return map;
}

}  // namespace fathom::tables
