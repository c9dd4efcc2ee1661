#include "common/recordings/dataflash/kinds.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace fathom::recordings::dataflash {
namespace {

constexpr int kBatch = 32;  // int16 numbers of a field 'a'

bool printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isgraph(c) != 0; });
}

std::vector<std::string> parts(std::string_view text) {
  std::vector<std::string> all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    all.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

std::string plain(double factor) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), factor).ptr};
}

}  // namespace

std::size_t size_of(char letter) {
  switch (letter) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'q':
    case 'Q':
    case 'd':
      return 8;
    case 'N':
      return 16;
    case 'Z':
      return 64;
    case 'a':
      return 2 * kBatch;
    default:
      return 0;
  }
}

bool is_words(char letter) { return letter == 'n' || letter == 'N' || letter == 'Z'; }

bool Kinds::describe(int type, std::size_t length, std::string_view name, std::string_view letters,
                     std::string_view columns) {
  constexpr std::size_t kHeader = 3;
  if (name.empty() || length < kHeader || length > 255 || !printable(name) || !printable(letters) ||
      !printable(columns))
    return false;
  auto kind = std::make_unique<Kind>();
  kind->name = name;
  kind->letters = letters;
  kind->columns = parts(columns);
  kind->length = length;
  std::size_t sum = kHeader;
  bool known = kind->columns.size() == letters.size();
  for (const char letter : letters) {
    sum += size_of(letter);
    known = known && size_of(letter) > 0;
  }
  kind->readable = known && sum <= length;
  for (std::size_t i = 0; kind->readable && i < letters.size(); ++i) {
    if (kind->columns[i] != "TimeUS" && kind->columns[i] != "TimeMS") continue;
    if (letters[i] != 'Q' && letters[i] != 'I' && letters[i] != 'q') continue;
    kind->time = static_cast<int>(i);
    kind->time_factor = kind->columns[i] == "TimeMS" ? 1e3 : 1.0;
    break;
  }
  if (kind->readable && name == "VISO" && std::ranges::count(letters, 'f') + 1 == std::ssize(letters)) {
    const auto column = [&](std::string_view wanted) {
      const auto found = std::ranges::find(kind->columns, wanted);
      return found == kind->columns.end() ? -1 : static_cast<int>(found - kind->columns.begin());
    };
    if (column("PosDX") >= 0 && column("PosDZ") == column("PosDX") + 2) {
      kind->period = column("dt");
      kind->shift = column("PosDX");
    }
  }
  auto& place = kinds_[static_cast<std::size_t>(type & 0xFF)];
  if (place && place->name == kind->name && place->letters == kind->letters && place->columns == kind->columns &&
      place->length == kind->length)
    return true;  // said again, as each start does
  if (place) former_.push_back(std::move(place));
  place = std::move(kind);
  by_name_[std::string{name}] = type & 0xFF;
  return true;
}

void Kinds::units(int type, std::string_view units, std::string_view multipliers) {
  Kind* kind = find(type);
  if (kind == nullptr || kind->settled) return;
  kind->units = units;
  kind->multipliers = multipliers;
}

Kind* Kinds::find(std::string_view name) {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : find(found->second);
}

void Kinds::settle(Kind& kind) {
  kind.settled = true;
  const std::size_t marked = kind.units.find('#');
  if (marked < kind.letters.size()) {
    kind.instance = static_cast<int>(marked);
  } else if (kind.units.empty() && kind.columns.size() > 1) {
    // Before FMTU: by the names that ArduPilot gives such a column, the second behind the time.
    const std::string& second = kind.columns[1];
    const bool core = second == "C" && (kind.name.starts_with("XK") || kind.name.starts_with("NK"));
    if (second == "I" || second == "Instance" || second == "Inst" || second == "Id" || core) kind.instance = 1;
    if (second == "Id" && (kind.name == "EV" || kind.name == "UNIT" || kind.name == "MULT")) kind.instance = -1;
  }
  if (kind.instance >= 0 &&
      std::string_view{"bBhHiI"}.find(kind.letters[static_cast<std::size_t>(kind.instance)]) == std::string_view::npos)
    kind.instance = -1;
}

std::string Kinds::unit_of(const Kind& kind, std::size_t column) const {
  if (column >= kind.units.size()) return {};
  const std::string& label = labels_[static_cast<unsigned char>(kind.units[column])];
  if (label.empty() || kind.units[column] == '-' || kind.units[column] == '?' || kind.units[column] == '#') return {};
  if (column >= kind.multipliers.size()) return label;
  const std::optional<double> factor = factors_[static_cast<unsigned char>(kind.multipliers[column])];
  const char letter = kind.letters[column];
  const bool scaled = std::string_view{"cCeEL"}.find(letter) != std::string_view::npos;  // by its letter already
  if (!factor || *factor == 1.0 || *factor == 0.0 || scaled) return label;
  // What FMTU says of floats is wrong often enough (CTUN.BAlt) that it is passed on as hearsay.
  return letter == 'f' || letter == 'd' ? label + " (or " + plain(*factor) + " " + label + ")"
                                        : plain(*factor) + " " + label;
}

Kind::Own Kinds::topic(Kind& kind, int instance) {
  if (const auto found = kind.topics.find(instance); found != kind.topics.end()) return found->second;
  Topic topic{.name = kind.name + (instance < 0 ? "" : "[" + std::to_string(instance) + "]"), .type = kind.name};
  for (std::size_t i = 0; i < kind.letters.size(); ++i) {
    if (is_words(kind.letters[i])) continue;
    if (kind.letters[i] == 'a') {
      for (int k = 0; k < kBatch; ++k) topic.fields.push_back({kind.columns[i] + "[" + std::to_string(k) + "]"});
    } else {
      topic.fields.push_back({kind.columns[i], unit_of(kind, i)});
    }
  }
  for (const char* axis : {"VelX", "VelY", "VelZ"}) {
    if (kind.period >= 0) topic.fields.push_back({axis, "m/s, shift over time"});
  }
  // The same name with other columns (another firmware in the same file) is another topic.
  std::string key = topic.name + " " + kind.letters;
  for (const std::string& column : kind.columns) key += "," + column;
  const auto [known, added] = named_.try_emplace(key);
  if (added) {
    while (!names_.insert(topic.name).second) topic.name += "'";
    const std::size_t number = named_.size() - 1;
    known->second = {number, sink_.topic(number, topic)};
  }
  return kind.topics[instance] = known->second;
}

}  // namespace fathom::recordings::dataflash
