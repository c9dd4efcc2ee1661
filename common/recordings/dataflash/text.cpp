#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "common/base/error.hpp"
#include "common/recordings/dataflash/dataflash.hpp"
#include "common/recordings/dataflash/kinds.hpp"

namespace fathom::recordings::dataflash {
namespace {

constexpr std::size_t kLongestLine = 4096;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Takes the next part of a line; the last takes the commas that are left.
std::string_view part(std::string_view& line, bool last) {
  const std::size_t end = last ? line.size() : std::min(line.find(','), line.size());
  const std::string_view one = trimmed(line.substr(0, end));
  line.remove_prefix(std::min(end + 1, line.size()));
  return one;
}

double number(std::string_view text) {
  double value = std::nan("");
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? value : std::nan("");
}

class TextReader {
 public:
  TextReader(Sink& sink, Damage& damage) : sink_(sink), damage_(damage), kinds_(sink) {
    (void)kinds_.describe(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
  }

  void line(std::string_view text, std::uint64_t offset) {
    std::string_view rest = text;
    const std::string_view name = part(rest, false);
    if (name.empty()) return;
    Kind* kind = kinds_.find(name);
    if (kind == nullptr || !kind->readable) {
      damage_.add("lines that no FMT describes", offset, text.size());
      return;
    }
    if (!kind->settled) kinds_.settle(*kind);
    numbers_.clear();
    words_.clear();
    for (std::size_t i = 0; i < kind->letters.size(); ++i) {
      if (rest.empty() && i + 1 < kind->letters.size()) {
        damage_.add("lines with too few fields", offset, text.size());
        return;
      }
      const std::string_view one = part(rest, i + 1 == kind->letters.size());
      words_.push_back(one);
      if (is_words(kind->letters[i])) continue;
      if (kind->letters[i] == 'a') {
        damage_.add("lines of batch samples, which have no text form", offset, text.size());
        return;
      }
      numbers_.push_back(number(one));
    }
    if (!learn(*kind)) {
      damage_.add("FMT lines that describe nothing", offset, text.size());
      return;
    }
    const auto column = [&](int index) { return number(words_[static_cast<std::size_t>(index)]); };
    Stamp stamp{.log = last_};
    if (kind->time >= 0) {
      const double time = kind->time_factor * column(kind->time);
      stamp.log = std::abs(time) < 9e15 ? static_cast<std::int64_t>(time) : kNoTime;
    }
    if (stamp.log != kNoTime) last_ = stamp.log;
    const double instance = kind->instance < 0 ? -1.0 : column(kind->instance);
    const auto [topic, wanted] = kinds_.topic(*kind, std::abs(instance) < 1e6 ? static_cast<int>(instance) : -1);
    if (said_.size() <= topic) said_.resize(topic + 1);
    for (std::size_t i = 0; wanted && !said_[topic] && i < words_.size(); ++i) {
      if (!is_words(kind->letters[i])) continue;
      sink_.text(topic, kind->columns[i], words_[i]);
      said_[topic] = true;
    }
    if (!wanted) numbers_.clear();
    sink_.message(topic, stamp, numbers_);
  }

 private:
  bool learn(const Kind& kind) {
    const auto whole = [&](std::size_t i) { return static_cast<int>(number(words_[i])); };
    if (kind.name == "FMT") {
      const double type = number(words_[0]), length = number(words_[1]);
      if (!(type >= 0.0 && type < 256.0 && length >= 0.0 && length < 256.0)) return false;
      return kinds_.describe(whole(0), static_cast<std::size_t>(length), words_[2], words_[3], words_[4]);
    }
    if (kind.name == "FMTU" && kind.letters == "QBNN" && number(words_[1]) >= 0.0 && number(words_[1]) < 256.0)
      kinds_.units(whole(1), words_[2], words_[3]);
    if (kind.name == "UNIT" && kind.letters == "QbZ") {
      if (const double id = number(words_[1]); id >= 0.0 && id < 128.0) kinds_.unit(static_cast<char>(id), words_[2]);
    }
    if (kind.name == "MULT" && kind.letters == "Qbd") {
      if (const double id = number(words_[1]); id >= 0.0 && id < 128.0)
        kinds_.multiplier(static_cast<char>(id), number(words_[2]));
    }
    return true;
  }

  Sink& sink_;
  Damage& damage_;
  Kinds kinds_;
  std::int64_t last_{kNoTime};
  std::vector<double> numbers_;
  std::vector<std::string_view> words_;
  std::vector<bool> said_;
};

}  // namespace

bool is_text(Bytes head) {
  constexpr std::string_view kStart = "FMT,";
  const std::string_view text{reinterpret_cast<const char*>(head.data()), std::min<std::size_t>(head.size(), 4096)};
  return text.starts_with(kStart) ||
         (text.find("\nFMT,") != std::string_view::npos && text.find('\0') == std::string_view::npos);
}

void read_text(const std::string& path, Sink& sink, Damage& damage) {
  FileWindow file{path};
  TextReader reader{sink, damage};
  std::uint64_t at = 0;
  while (at < file.size()) {
    const Bytes bytes = file.at(at, kLongestLine);
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos && bytes.size() == kLongestLine) {
      damage.add("stretches without the end of a line", at, kLongestLine);
      at += kLongestLine;
      continue;
    }
    reader.line(text.substr(0, end), at);
    at += end == std::string_view::npos ? bytes.size() : end + 1;
  }
}

}  // namespace fathom::recordings::dataflash
