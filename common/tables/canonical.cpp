// The canonical columns: a table that needs no map. docs/configuration.md lists them.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>
#include <string_view>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/tables/import.hpp"
#include "common/tables/likely_time.hpp"

namespace fathom::tables {
namespace {

constexpr const char* kCanonical =
    "t; x y z; phi theta psi; u v w; p q r; ax ay az; f1..fN or X Y Z K M N; pwm1..pwmN; depth; voltage; range_A, "
    "range_B, ...; load_A, load_B, ...";
constexpr const char* kDraft = "; 'fathom import --describe FILE' drafts a map by the columns' names";

constexpr std::array kNames{"t",  "x",  "y",  "z", "phi", "theta", "psi", "u", "v", "w",     "p",       "q",  "r",
                            "ax", "ay", "az", "X", "Y",   "Z",     "K",   "M", "N", "depth", "voltage", "f1", "pwm1"};

// What others call these.
constexpr std::array<std::pair<const char*, const char*>, 22> kOtherwise{{
    {"time", "t"},   {"north", "x"},
    {"east", "y"},   {"down", "z"},
    {"roll", "phi"}, {"pitch", "theta"},
    {"yaw", "psi"},  {"heading", "psi"},
    {"surge", "u"},  {"sway", "v"},
    {"heave", "w"},  {"vx", "u"},
    {"vy", "v"},     {"vz", "w"},
    {"wx", "p"},     {"wy", "q"},
    {"wz", "r"},     {"Fx", "X"},
    {"Fy", "Y"},     {"Fz", "Z"},
    {"Mz", "N"},     {"battery", "voltage"},
}};

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

  /// Columns whose names begin so, in the order of the table.
  std::optional<ColumnGroup> take_beginning(const std::string& prefix) {
    ColumnGroup group;
    for (const std::string& name : table_.names) {
      if (name.size() > prefix.size() && name.starts_with(prefix) && left_.erase(name) > 0)
        group.columns.push_back({name, ""});
    }
    return group.columns.empty() ? std::nullopt : std::optional<ColumnGroup>(group);
  }

  /// " (did you mean 'phi'?)" for "Phi" or "roll", unless there is a "phi" too.
  [[nodiscard]] std::string meant(const std::string& name) const {
    const auto letter = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    const auto other = std::ranges::find_if(kOtherwise, [&](const auto& pair) {
      return std::ranges::equal(name, std::string_view(pair.first), {}, letter, letter);
    });
    if (other != kOtherwise.end() && table_.find(other->second) == nullptr)
      return std::string(" (did you mean '") + other->second + "'?)";
    for (const char* known : kNames) {
      if (table_.find(known) == nullptr && looks_like(name, known))
        return std::string(" (did you mean '") + known + "'?)";
    }
    return "";
  }

  /// Whether the name is of a thruster, as "f3", and was not taken with those before it.
  void check_numbered(const std::string& name) const {
    for (const std::string prefix : {"f", "pwm"}) {
      if (!name.starts_with(prefix)) continue;
      int number = 0;
      const char *begin = name.data() + prefix.size(), *end = name.data() + name.size();
      const auto [rest, error] = std::from_chars(begin, end, number);
      if (error != std::errc{} || rest != end || number < 0) continue;
      if (number == 0)
        throw InputError(table_.path + ":1: column '" + name + "': thrusters are counted from '" + prefix +
                         "1', in the order of the vehicle file");
      for (int i = 1; i < number; ++i) {
        const std::string before = prefix + std::to_string(i);
        if (table_.find(before) == nullptr)
          throw InputError(table_.path + ":1: column '" + before + "' is missing, and '" + name +
                           "' is there; a thruster that was not driven has a column of zeros");
      }
    }
  }

  /// Columns that nobody knows are left alone, and the import notes them. InputError where one is likely to be a known
  /// one misspelt, or numbered with a gap: what it holds would be missed.
  void check_strangers() const {
    std::string misspelt;
    for (const std::string& name : table_.names) {
      if (!left_.contains(name)) continue;
      check_numbered(name);
      if (const std::string known = meant(name); !known.empty())
        misspelt += (misspelt.empty() ? "'" : ", '") + name + "'" + known;
    }
    if (misspelt.empty()) return;
    throw InputError(table_.path + ":1: unknown columns " + misspelt +
                     "; without a map (--map) these are known: " + kCanonical + kDraft);
  }

 private:
  const CsvTable& table_;
  std::set<std::string> left_;
};

std::string said_of(const std::optional<LikelyTime>& time) {
  if (!time) return "";
  return time->columns.size() == 1
             ? "; '" + time->columns.front() + "' looks like it: call it 't', or write in a map '" + time->key + "'"
             : "; '" + time->columns[0] + "' and '" + time->columns[1] + "' look like it: write in a map '" +
                   time->key + "'";
}

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
    throw InputError(table.path + ":1: column 't' (time in seconds, or as a date) is missing" +
                     (table.find("T") != nullptr ? " (is it 'T'?)" : said_of(likely_time(table))) +
                     "; describe other columns with a map (--map)");
  }
  map.time = *time;
  // A depth alone, as gliders and torpedoes have it, is often called z.
  const bool z_alone = table.find("z") != nullptr && table.find("x") == nullptr && table.find("y") == nullptr &&
                       table.find("depth") == nullptr;
  const auto z_as_depth = z_alone ? shelf.take({"z"}) : std::nullopt;
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
  if (z_as_depth) map.depth = ScalarColumn{*z_as_depth, {}};
  if (const auto depth = shelf.take({"depth"})) map.depth = ScalarColumn{*depth, {}};
  if (const auto voltage = shelf.take({"voltage"})) map.battery = ScalarColumn{*voltage, {}};
  if (const auto ranges = shelf.take_beginning("range_")) map.ranges = ListColumns{*ranges, {}};
  if (const auto loads = shelf.take_beginning("load_")) map.loads = ListColumns{*loads, {}};
  shelf.check_strangers();
  if (table.names.size() == 1) throw InputError(table.path + ":1: there is no column besides time");
  if (!map.pose_capture && !map.ahrs && !map.dvl && !map.thrusters && !map.depth && !map.battery && !map.ranges &&
      !map.loads)
    throw InputError(table.path +
                     ":1: no column besides time is known; without a map (--map) these are: " + kCanonical + kDraft);
  return map;
}

}  // namespace fathom::tables
