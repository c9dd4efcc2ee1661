#include "common/devices/load_text.hpp"

#include <algorithm>

#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::string_view kBetween = " ,;\t";

bool begins_number(std::string_view word) {
  return !word.empty() && (word[0] == '+' || word[0] == '-' || (word[0] >= '0' && word[0] <= '9'));
}

}  // namespace

LoadText::LoadText(const Settings& settings) : cells_{settings.cells} {
  if (cells_.empty()) cells_.push_back({.name = "load"});
  cells_.resize(std::min(cells_.size(), kMost));
  sample_.load.resize(cells_.size());
}

bool LoadText::read_named(std::string_view line, std::size_t equals, Readings& readings) const {
  const auto cell = std::find_if(cells_.begin(), cells_.end(),
                                 [&](const LoadCell& each) { return each.name == trim(line.substr(0, equals)); });
  if (cell == cells_.end()) {
    complain("a reading of a cell that 'cells' does not name");
    return false;
  }
  std::string_view rest = line.substr(equals + 1);
  const auto value = number(next_word(rest, kBetween));
  const std::string_view unit = next_word(rest, kBetween);
  if (!value || !next_word(rest, kBetween).empty() || (!unit.empty() && unit != cell->unit)) return false;
  const auto index = static_cast<std::size_t>(cell - cells_.begin());
  readings.value[index] = *value;
  readings.there[index] = true;
  readings.count = 1;
  return true;
}

bool LoadText::read(std::string_view line, Readings& readings) const {
  readings = {};
  const std::size_t equals = line.find('=');
  if (equals != std::string_view::npos) return read_named(line, equals, readings);
  for (std::string_view word = next_word(line, kBetween); !word.empty(); word = next_word(line, kBetween)) {
    if (!begins_number(word)) {  // the unit of the reading before it
      if (readings.count == 0) return false;
      if (word != cells_[readings.count - 1].unit) {
        complain("a reading's unit is not the one of 'cells'");
        return false;
      }
      continue;
    }
    const auto value = number(word);
    if (!value || readings.count == cells_.size()) return false;
    readings.there[readings.count] = true;
    readings.value[readings.count++] = *value;
  }
  return readings.count == cells_.size();
}

bool LoadText::accepts(std::string_view line) const { return read(line, readings_); }

void LoadText::line(std::string_view line, Frame& frame) {
  line_ = line;
  bool all = true;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (readings_.there[i]) {
      sample_.load[i] = cells_[i].gain * (readings_.value[i] - cells_[i].zero);
      fresh_[i] = true;
    }
    all = all && fresh_[i];
  }
  frame.lacks = "not every cell has told since the sample before";
  if (!all) return;
  fresh_ = {};
  frame.sample = &sample_;
}

void LoadText::describe(Fields& fields) const {
  fields.add("line", line_);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    fields.add(cells_[i].name, readings_.there[i] ? std::optional{readings_.value[i]} : std::nullopt);
  }
}

}  // namespace fathom::devices
