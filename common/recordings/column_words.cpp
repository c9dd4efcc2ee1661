#include "common/recordings/column_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <utility>

namespace fathom::recordings {
namespace {

using Words = std::vector<std::string>;

constexpr std::array<std::pair<std::string_view, std::string_view>, 29> kSame{
    {{"velocity", "vel"},  {"speed", "vel"},       {"velo", "vel"},      {"position", "pos"},   {"acceleration", "acc"},
     {"accel", "acc"},     {"angular", "ang"},     {"linear", "lin"},    {"starboard", "stbd"}, {"right", "stbd"},
     {"sb", "stbd"},       {"left", "port"},       {"ps", "port"},       {"forward", "fore"},   {"front", "fore"},
     {"fwd", "fore"},      {"bow", "fore"},        {"rear", "aft"},      {"stern", "aft"},      {"back", "aft"},
     {"vertical", "vert"}, {"horizontal", "horz"}, {"commanded", "cmd"}, {"command", "cmd"},    {"propeller", "prop"},
     {"thruster", "thr"},  {"voltage", "volt"},    {"volts", "volt"},    {"gyroscope", "gyro"}}};

/// Who measured, in which axes it is anyway, how it was treated.
constexpr std::array<std::string_view, 28> kWhoMeasured{
    {"imu",       "ahrs",     "gps",  "gnss",    "rtk",   "ins",  "dvl",      "adcp", "nav",    "odom",
     "ekf",       "vn",       "mti",  "compass", "body",  "b",    "measured", "meas", "actual", "est",
     "estimated", "filtered", "filt", "raw",     "value", "data", "state",    "robot"}};

constexpr std::array<std::string_view, 24> kOfActuators{
    {"rpm",  "rps",  "n",  "vel",      "ang",    "angle", "cmd",   "thr",    "motor",    "prop",  "esc", "shaft",
     "revs", "rate", "fb", "feedback", "output", "out",   "force", "thrust", "setpoint", "input", "pwm", "deflection"}};

bool letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

template <std::size_t N>
Words without(const Words& words, const std::array<std::string_view, N>& those) {
  Words left;
  std::ranges::copy_if(words, std::back_inserter(left),
                       [&](const std::string& word) { return std::ranges::find(those, word) == those.end(); });
  return left;
}

Words split(std::string_view name) {
  Words words;
  char before = ' ';
  for (const char c : name) {
    const bool part_of_word = letter(c) || digit(c);
    const bool hump = std::islower(static_cast<unsigned char>(before)) && std::isupper(static_cast<unsigned char>(c));
    const bool fresh = !letter(before) && !digit(before);
    if (part_of_word) {
      if (fresh || hump || (letter(before) && digit(c)) || (digit(before) && letter(c))) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    before = c;
  }
  for (std::string& word : words) {
    for (const auto& [theirs, ours] : kSame) {
      if (word == theirs) word = ours;
    }
  }
  return words;
}

}  // namespace

Words words_of(std::string_view name) {
  const Words all = split(name);
  Words words = without(all, kWhoMeasured);
  if (words.empty()) words = all;
  std::ranges::sort(words);
  return words;
}

Words words_of_actuator(std::string_view name) { return without(words_of(name), kOfActuators); }

}  // namespace fathom::recordings
