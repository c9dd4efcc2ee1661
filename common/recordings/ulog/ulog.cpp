#include "common/recordings/ulog/ulog.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/ulog/layout.hpp"

namespace fathom::recordings::ulog {
namespace {

constexpr std::array<std::uint8_t, 7> kMagic{0x55, 0x4C, 0x6F, 0x67, 0x01, 0x12, 0x35};
constexpr std::array<std::uint8_t, 8> kSync{0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12};
constexpr std::size_t kFileHeader = 16;
constexpr std::size_t kHeader = 3;
constexpr std::size_t kLongest = 65535 + 2 * kHeader;
constexpr std::size_t kFlagBits = 40;

std::string_view text(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

bool is_name(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) { return c > ' ' && c < 127; });
}

class Reader {
 public:
  Reader(const std::string& path, Sink& sink, Damage& damage) : file_(path), sink_(sink), damage_(damage) {}

  void run() {
    if (!is_ulog(file_.at(0, kFileHeader))) throw InputError(file_.path() + ": is no ULog");
    std::uint64_t at = kFileHeader;
    std::uint64_t lost_from = 0;
    bool lost = false;
    while (at < file_.size()) {
      const std::uint64_t appended = next_appended(at);
      const Bytes bytes = file_.at(at, kLongest);
      const std::size_t length = whole(bytes);
      const bool crosses = length > 0 && appended > at && at + length > appended;
      const bool believed = length > 0 && !crosses && (!lost || follows(bytes.subspan(length)) || sync(bytes));
      if (believed) {
        if (lost) damage_.add("stretches of bytes that are no message", lost_from, at - lost_from);
        lost = false;
        take(bytes.first(length));
        at += length;
        continue;
      }
      if (const std::size_t rest = bytes.size(); !lost && cut_off(bytes)) {
        damage_.add("messages cut off by the end of the file", at, rest);
        at = file_.size();
        break;
      }
      if (crosses && !lost) {
        damage_.add("messages cut off before appended data", at, appended - at);
        at = appended;
        continue;
      }
      if (!lost) lost_from = at;
      lost = true;
      ++at;
    }
    if (lost) damage_.add("stretches of bytes that are no message", lost_from, file_.size() - lost_from);
    for (std::uint64_t i = 0; i < dropouts_; ++i)
      damage_.add("dropouts that the logger itself reports, " + std::to_string(dropout_ms_) + " ms together");
    if (unsubscribed_ > 0) damage_.add("subscriptions to a format that is not defined, or does not fit a message");
  }

 private:
  struct Subscription {
    Layout layout;
    std::size_t topic{};
    bool wanted{};
    std::size_t time{}, sample{};  ///< places of timestamp and timestamp_sample; beyond the last: none
    bool said{};
  };

  [[nodiscard]] std::uint64_t next_appended(std::uint64_t at) const {
    for (const std::uint64_t offset : appended_) {
      if (offset > at) return offset;
    }
    return 0;
  }

  [[nodiscard]] static bool sync(Bytes bytes) {
    return bytes.size() >= kHeader + kSync.size() && bytes[2] == 'S' &&
           std::equal(kSync.begin(), kSync.end(), bytes.begin() + kHeader);
  }

  /// Length of the message at the beginning with its header, 0 where none can be.
  [[nodiscard]] std::size_t whole(Bytes bytes) const {
    if (bytes.size() < kHeader) return 0;
    const std::size_t size = little<std::uint16_t>(bytes);
    const Bytes body = bytes.subspan(kHeader, std::min(size, bytes.size() - kHeader));
    if (body.size() < size) return 0;
    return plausible(static_cast<char>(bytes[2]), body) ? kHeader + size : 0;
  }

  [[nodiscard]] bool plausible(char kind, Bytes body) const {
    switch (kind) {
      case 'B':
        return body.size() >= kFlagBits;
      case 'F':
        return text(body).find(':') != std::string_view::npos;
      case 'I':
      case 'P':
        return body.size() > 1 && body[0] > 0 && body[0] < body.size();
      case 'M':
      case 'Q':
        return body.size() > 2 && body[1] > 0 && body[1] + std::size_t{1} < body.size();
      case 'A':
        return body.size() > 3 && is_name(text(body.subspan(3)));
      case 'R':
      case 'O':
        return body.size() == 2;
      case 'D': {
        if (body.size() < 2) return false;
        const auto found = subscriptions_.find(little<std::uint16_t>(body));
        return found != subscriptions_.end() && body.size() - 2 >= found->second.layout.stored &&
               body.size() - 2 <= std::max(found->second.layout.size, found->second.layout.stored);
      }
      case 'L':
        return body.size() >= 9;
      case 'C':
        return body.size() >= 11;
      case 'S':
        return body.size() == kSync.size() && std::equal(kSync.begin(), kSync.end(), body.begin());
      default:
        return false;
    }
  }

  /// Whether another message, or the end of the file, stands there.
  [[nodiscard]] bool follows(Bytes bytes) const { return bytes.empty() || whole(bytes) > 0; }

  /// Whether a message begins that the end of the file cuts off.
  [[nodiscard]] bool cut_off(Bytes bytes) const {
    if (bytes.size() < kHeader) return !bytes.empty();
    const std::size_t size = little<std::uint16_t>(bytes);
    if (kHeader + size <= bytes.size() || bytes.size() >= kLongest) return false;
    const char kind = static_cast<char>(bytes[2]);
    if (kind != 'D') return std::string_view{"FIPMQALC"}.find(kind) != std::string_view::npos;
    if (bytes.size() < kHeader + 2) return true;
    const auto found = subscriptions_.find(little<std::uint16_t>(bytes, kHeader));
    return found != subscriptions_.end() && size - 2 >= found->second.layout.stored &&
           size - 2 <= std::max(found->second.layout.size, found->second.layout.stored);
  }

  void take(Bytes bytes) {
    const Bytes body = bytes.subspan(kHeader);
    switch (static_cast<char>(bytes[2])) {
      case 'B':
        return flags(body);
      case 'F':
        if (!formats_.add(text(body))) damage_.add("formats that cannot be understood");
        return;
      case 'A':
        return subscribe(body);
      case 'D':
        return data(body);
      case 'O':
        ++dropouts_;
        dropout_ms_ += little<std::uint16_t>(body);
        return;
      default:
        return;
    }
  }

  void flags(Bytes body) {
    constexpr std::size_t kIncompatible = 8, kAppended = 16;
    for (std::size_t i = 0; i < 8; ++i) {
      const auto known = static_cast<std::uint8_t>(i == 0 ? 1 : 0);  // data were appended
      if ((body[kIncompatible + i] & ~known) != 0)
        throw InputError(file_.path() + ": this ULog says that older readers must not read it (incompatible flag " +
                         std::to_string(i) + ")");
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto offset = little<std::uint64_t>(body, kAppended + 8 * i);
      if (offset > kFileHeader && offset < file_.size()) appended_.push_back(offset);
    }
    std::ranges::sort(appended_);
  }

  void subscribe(Bytes body) {
    const int instance = body[0];
    const auto id = little<std::uint16_t>(body, 1);
    const std::string name{text(body.subspan(3))};
    std::optional<Layout> layout = formats_.layout(name);
    if (!layout) {
      ++unsubscribed_;
      return;
    }
    Subscription subscription{.layout = std::move(*layout)};
    const auto& places = subscription.layout.places;
    const auto place = [&](std::string_view field) {
      return static_cast<std::size_t>(
          std::ranges::find_if(
              places, [&](const Place& one) { return one.name == field && (one.type == 'Q' || one.type == 'I'); }) -
          places.begin());
    };
    subscription.time = place("timestamp");
    subscription.sample = place("timestamp_sample");
    Topic topic{.name = name + (instance == 0 ? "" : "[" + std::to_string(instance) + "]"), .type = name};
    std::string key = topic.name;
    for (const Place& one : places) {
      key += " " + one.name + one.type;
      if (one.type != 'c') topic.fields.push_back({one.name, one.name.starts_with("timestamp") ? "us" : ""});
    }
    auto known = topics_.find(key);
    if (known == topics_.end()) {
      const std::size_t number = topics_.size();
      known = topics_.emplace(key, std::pair{number, sink_.topic(number, topic)}).first;
    }
    subscription.topic = known->second.first;
    subscription.wanted = known->second.second;
    subscriptions_[id] = std::move(subscription);
  }

  void data(Bytes body) {
    Subscription& subscription = subscriptions_.at(little<std::uint16_t>(body));
    const Bytes message = body.subspan(2);
    const auto& places = subscription.layout.places;
    const auto time_at = [&](std::size_t index) {
      if (index >= places.size()) return kNoTime;
      const Place& place = places[index];
      const std::uint64_t time = place.type == 'Q' ? little<std::uint64_t>(message, place.offset)
                                                   : std::uint64_t{little<std::uint32_t>(message, place.offset)};
      // Zero: published once, before there was a clock.
      return time == 0 || time > (std::uint64_t{1} << 53U) ? kNoTime : static_cast<std::int64_t>(time);
    };
    values_.clear();
    if (subscription.wanted) {
      for (const Place& place : places) {
        if (place.type != 'c') {
          values_.push_back(number(place, message));
        } else if (!subscription.said) {
          const std::string_view words = text(message.subspan(place.offset, place.count));
          sink_.text(subscription.topic, place.name, words.substr(0, words.find('\0')));
          subscription.said = true;
        }
      }
    }
    sink_.message(subscription.topic, {time_at(subscription.time), time_at(subscription.sample)}, values_);
  }

  FileWindow file_;
  Sink& sink_;
  Damage& damage_;
  Formats formats_;
  std::vector<std::uint64_t> appended_;
  std::map<std::uint16_t, Subscription> subscriptions_;
  std::map<std::string, std::pair<std::size_t, bool>> topics_;
  std::vector<double> values_;
  std::uint64_t dropouts_{}, dropout_ms_{}, unsubscribed_{};
};

}  // namespace

bool is_ulog(Bytes head) {
  return head.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), head.begin());
}

void read(const std::string& path, Sink& sink, Damage& damage) { Reader{path, sink, damage}.run(); }

}  // namespace fathom::recordings::ulog
