#include <algorithm>
#include <cmath>

#include "common/recordings/dataflash/dataflash.hpp"
#include "common/recordings/dataflash/kinds.hpp"
#include "common/recordings/little.hpp"

namespace fathom::recordings::dataflash {
namespace {

constexpr std::uint8_t kFirst = 0xA3, kSecond = 0x95;
constexpr std::size_t kHeader = 3;
constexpr int kFmt = 128;
constexpr std::size_t kFmtLength = 89;
constexpr std::size_t kLongest = 255;
constexpr double kShortest = 1e-3,
                 kLongestPeriod = 10.0;    // s between reports of a velocity log: else it is another unit
constexpr std::int64_t kNear = 2'000'000;  // us: what stands without a follower must fit the time before it

std::string_view words(Bytes bytes, std::size_t at, std::size_t count) {
  const char* begin = reinterpret_cast<const char*>(bytes.data() + at);
  return {begin, static_cast<std::size_t>(std::find(begin, begin + count, '\0') - begin)};
}

/// One number; 'L' and the letters of hundredths are scaled, as the format defines them.
double number(char letter, Bytes bytes, std::size_t at) {
  switch (letter) {
    case 'b':
      return little<std::int8_t>(bytes, at);
    case 'B':
    case 'M':
      return bytes[at];
    case 'h':
      return little<std::int16_t>(bytes, at);
    case 'H':
      return little<std::uint16_t>(bytes, at);
    case 'c':
      return little<std::int16_t>(bytes, at) * 0.01;
    case 'C':
      return little<std::uint16_t>(bytes, at) * 0.01;
    case 'g':
      return half(little<std::uint16_t>(bytes, at));
    case 'i':
      return little<std::int32_t>(bytes, at);
    case 'I':
      return little<std::uint32_t>(bytes, at);
    case 'e':
      return little<std::int32_t>(bytes, at) * 0.01;
    case 'E':
      return little<std::uint32_t>(bytes, at) * 0.01;
    case 'L':
      return little<std::int32_t>(bytes, at) * 1e-7;
    case 'f':
      return static_cast<double>(little<float>(bytes, at));
    case 'd':
      return little<double>(bytes, at);
    case 'q':
      return static_cast<double>(little<std::int64_t>(bytes, at));
    default:
      return static_cast<double>(little<std::uint64_t>(bytes, at));
  }
}

class Reader {
 public:
  Reader(const std::string& path, Sink& sink, Damage& damage)
      : file_(path), sink_(sink), damage_(damage), kinds_(sink) {
    (void)kinds_.describe(kFmt, kFmtLength, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
  }

  void run() {
    std::uint64_t lost_from = 0;
    std::string why;
    const auto close = [&](std::uint64_t at) {
      if (!why.empty()) damage_.add(why, lost_from, at - lost_from);
      why.clear();
    };
    std::uint64_t at = 0;
    while (at < file_.size()) {
      const Bytes record = file_.at(at, kLongest + 2 * kHeader);
      const std::size_t length = believed(record);
      if (length > 0) {
        close(at);
        take(record.first(length));
        at += length;
        continue;
      }
      const std::string reason = complaint(record, file_.size() - at);
      if (why.empty() || reason != kNoRecord) {
        close(at);
        why = reason;
        lost_from = at;
      }
      const Bytes rest = file_.rest(at + 1);  // to the next byte that can begin a record
      const auto next = std::find(rest.begin(), rest.end(), kFirst);
      at += 1 + static_cast<std::uint64_t>(next - rest.begin());
    }
    close(file_.size());
  }

 private:
  static constexpr const char* kNoRecord = "stretches of bytes that are no record";

  [[nodiscard]] static bool begins(Bytes bytes) {
    return bytes.size() >= kHeader && bytes[0] == kFirst && bytes[1] == kSecond;
  }

  /// Length of the record at the beginning; 0 when there is none that can be believed.
  std::size_t believed(Bytes bytes) {
    if (!begins(bytes)) return 0;
    Kind* kind = kinds_.find(bytes[2]);
    if (kind == nullptr || bytes.size() < kind->length) return 0;
    const Bytes behind = bytes.subspan(kind->length);
    if (behind.empty()) return fits(*kind, bytes) || last_ == kNoTime ? kind->length : 0;
    if (begins(behind)) return kind->length;
    return fits(*kind, bytes) ? kind->length : 0;
  }

  /// Whether the record's time goes with those before: what makes a record that nothing follows believable.
  [[nodiscard]] bool fits(const Kind& kind, Bytes bytes) const {
    if (kind.time < 0 || !kind.readable || last_ == kNoTime) return bytes[2] == kFmt && kind.name == "FMT";
    const std::int64_t time = time_of(kind, bytes);
    return time != kNoTime && std::abs(time - last_) < kNear;
  }

  [[nodiscard]] static std::int64_t time_of(const Kind& kind, Bytes bytes) {
    std::size_t at = kHeader;
    for (int i = 0; i < kind.time; ++i) at += size_of(kind.letters[static_cast<std::size_t>(i)]);
    const double time = kind.time_factor * number(kind.letters[static_cast<std::size_t>(kind.time)], bytes, at);
    return std::abs(time) < 9e15 ? static_cast<std::int64_t>(time) : kNoTime;
  }

  std::string complaint(Bytes bytes, std::uint64_t left) {
    if (!begins(bytes)) return kNoRecord;
    const Kind* kind = kinds_.find(bytes[2]);
    if (kind == nullptr) {
      const bool own = fits_unknown(bytes);
      return own ? "records of type " + std::to_string(bytes[2]) + ", which no FMT describes" : kNoRecord;
    }
    if (left < kind->length) return "records cut off by the end of the file";
    return kNoRecord;
  }

  /// A record that nobody describes still says when it was, if it begins as nearly all do.
  [[nodiscard]] bool fits_unknown(Bytes bytes) const {
    if (last_ == kNoTime || bytes.size() < kHeader + sizeof(std::uint64_t)) return false;
    const auto time = little<std::uint64_t>(bytes, kHeader);
    return time < std::uint64_t{9'000'000'000'000'000} && std::abs(static_cast<std::int64_t>(time) - last_) < kNear;
  }

  void take(Bytes bytes) {
    const int type = bytes[2];
    Kind& kind = *kinds_.find(type);
    if (!kind.readable) {
      damage_.add("records of kind " + kind.name + " whose description does not fit its length");
      return;
    }
    learn(kind, bytes);
    if (!kind.settled) kinds_.settle(kind);
    Stamp stamp{.log = kind.time < 0 ? last_ : time_of(kind, bytes)};
    if (stamp.log != kNoTime) last_ = stamp.log;
    int instance = -1;
    if (kind.instance >= 0) {
      std::size_t at = kHeader;
      for (int i = 0; i < kind.instance; ++i) at += size_of(kind.letters[static_cast<std::size_t>(i)]);
      const double said = number(kind.letters[static_cast<std::size_t>(kind.instance)], bytes, at);
      if (std::abs(said) < 1e6) instance = static_cast<int>(said);
    }
    const auto [topic, wanted] = kinds_.topic(kind, instance);
    values_.clear();
    if (wanted) decode(kind, topic, bytes);
    sink_.message(topic, stamp, values_);
  }

  void decode(const Kind& kind, std::size_t topic, Bytes bytes) {
    std::size_t at = kHeader;
    for (std::size_t i = 0; i < kind.letters.size(); ++i) {
      const char letter = kind.letters[i];
      if (is_words(letter)) {
        if (said_.size() <= topic) said_.resize(topic + 1);
        if (!said_[topic]) {
          sink_.text(topic, kind.columns[i], words(bytes, at, size_of(letter)));
          said_[topic] = true;
        }
      } else if (letter == 'a') {
        for (std::size_t k = 0; k < size_of('a'); k += 2) values_.push_back(little<std::int16_t>(bytes, at + k));
      } else {
        values_.push_back(number(letter, bytes, at));
      }
      at += size_of(letter);
    }
    if (kind.period < 0) return;
    const double period = values_[static_cast<std::size_t>(kind.period)];  // s; all columns of this kind are numbers
    const bool known = period > kShortest && period < kLongestPeriod;
    for (int i = 0; i < 3; ++i)
      values_.push_back(known ? values_[static_cast<std::size_t>(kind.shift + i)] / period : std::nan(""));
  }

  /// What FMT, FMTU, UNIT and MULT say about the others.
  void learn(const Kind& kind, Bytes bytes) {
    if (bytes[2] == kFmt && kind.length == kFmtLength) {
      if (!kinds_.describe(bytes[3], bytes[4], words(bytes, 5, 4), words(bytes, 9, 16), words(bytes, 25, 64)))
        damage_.add("FMT records that describe nothing");
      return;
    }
    if (kind.name == "FMTU" && kind.letters == "QBNN") {
      kinds_.units(bytes[11], words(bytes, 12, 16), words(bytes, 28, 16));
    } else if (kind.name == "UNIT" && kind.letters == "QbZ") {
      kinds_.unit(static_cast<char>(bytes[11]), words(bytes, 12, 64));
    } else if (kind.name == "MULT" && kind.letters == "Qbd") {
      kinds_.multiplier(static_cast<char>(bytes[11]), little<double>(bytes, 12));
    }
  }

  FileWindow file_;
  Sink& sink_;
  Damage& damage_;
  Kinds kinds_;
  std::int64_t last_{kNoTime};
  std::vector<double> values_;
  std::vector<bool> said_;
};

}  // namespace

bool is_binary(Bytes head) {
  // A record of kind FMT within the first bytes: what is cut out of a log may begin in the middle of one.
  constexpr std::size_t kSearched = 4096;
  for (std::size_t i = 0; i + kFmtLength <= std::min(head.size(), kSearched + kFmtLength); ++i) {
    if (head[i] != kFirst || head[i + 1] != kSecond || head[i + 2] != kFmt) continue;
    const bool another =
        i + kFmtLength + 2 > head.size() || (head[i + kFmtLength] == kFirst && head[i + kFmtLength + 1] == kSecond);
    if (another && head[i + 4] >= kHeader && head[i + 5] > ' ' && head[i + 5] < 127) return true;
  }
  return false;
}

void read_binary(const std::string& path, Sink& sink, Damage& damage) { Reader{path, sink, damage}.run(); }

}  // namespace fathom::recordings::dataflash
