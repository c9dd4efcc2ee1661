#include "common/recordings/ros/message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/recordings/little.hpp"

namespace fathom::recordings::ros {
namespace {

constexpr std::size_t kMostElements = 64;  // of a list become fields
constexpr std::size_t kEncapsulation = 4;
constexpr std::size_t kMostLeft = 7;  // bytes that writers pad a message with
constexpr int kMostDepth = 40;
constexpr std::size_t kMostFields = 20'000;

template <class T>
T read_as(Bytes bytes, std::size_t at, bool is_big) {
  return is_big ? big<T>(bytes, at) : little<T>(bytes, at);
}

}  // namespace

Messages::Messages(std::size_t topic, std::shared_ptr<const Definitions> definitions, Layout layout, Sink& sink)
    : topic_(topic), definitions_(std::move(definitions)), layout_(layout), sink_(sink) {
  prepare(definitions_->root(), "", slots_, 0);
}

/// Fields that every message has, in the order of the definition.
void Messages::prepare(const Type& type, const std::string& path, Slots& slots, int depth) {
  slots.members.resize(type.members.size());
  if (depth > kMostDepth) return;
  for (std::size_t i = 0; i < type.members.size(); ++i) {
    const Member& member = type.members[i];
    MemberSlots& own = slots.members[i];
    if (member.basic == Basic::kString || (member.list && member.count == 0)) continue;
    const std::size_t elements = member.list ? std::min(member.count, kMostElements) : 1;
    for (std::size_t k = 0; k < elements && fields_.size() < kMostFields; ++k) {
      const std::string name = path + member.name + (member.list ? "[" + std::to_string(k) + "]" : "");
      if (member.basic == Basic::kStruct) {
        own.nested.push_back(std::make_unique<Slots>());
        prepare(*member.type, name + ".", *own.nested.back(), depth + 1);
      } else if (member.basic == Basic::kTime || member.basic == Basic::kDuration) {
        own.numbers.push_back(field(name + ".sec"));
        (void)field(name + ".nsec");
      } else {
        own.numbers.push_back(field(name));
      }
    }
  }
}

bool Messages::of_header(const Path* path) {
  return path != nullptr && (path->member->name.find("header") != std::string::npos || of_header(path->outer));
}

std::string Messages::prefix(const Path* path) {
  return path == nullptr ? "" : name_of(path->outer, *path->member, path->index) + ".";
}

std::string Messages::name_of(const Path* path, const Member& member, std::size_t index) {
  return prefix(path) + member.name + (member.list ? "[" + std::to_string(index) + "]" : "");
}

std::size_t Messages::field(const std::string& name) {
  fields_.push_back({name});
  if (announced_) sink_.further_field(topic_, fields_.back());
  return fields_.size() - 1;
}

void Messages::put(std::size_t number, double value) {
  if (values_.size() <= number) values_.resize(fields_.size(), std::numeric_limits<double>::quiet_NaN());
  values_[number] = value;
}

bool Messages::empty(const Type& type) {
  return std::ranges::all_of(type.members, [](const Member& member) {
    return member.basic == Basic::kStruct && (!member.list || member.count > 0) && empty(*member.type);
  });
}

std::optional<std::span<const double>> Messages::read(Bytes message, std::int64_t& measured) {
  bool good = attempt(message, origin_);
  if (!good && layout_ == Layout::kCdr) {  // some writers count alignment from the first byte of all
    const std::size_t other = kEncapsulation - origin_;
    good = attempt(message, other);
    if (good) origin_ = other;
  }
  if (!good) return std::nullopt;
  measured = kNoTime;
  if (stamped_ && (seconds_ != 0 || nanoseconds_ != 0)) measured = seconds_ * 1'000'000 + nanoseconds_ / 1000;
  return values_;
}

bool Messages::attempt(Bytes message, std::size_t origin) {
  values_.assign(fields_.size(), std::numeric_limits<double>::quiet_NaN());
  stamped_ = false;
  bytes_ = message;
  at_ = 0;
  big_ = false;
  widest_ = 8;
  if (layout_ == Layout::kCdr) {
    if (message.size() < kEncapsulation || message[0] != 0) return false;
    switch (message[1]) {
      case 0:
      case 1:
        break;
      case 6:
      case 7:
        widest_ = 4;
        break;
      default:
        return false;
    }
    big_ = message[1] % 2 == 0;
    bytes_ = message.subspan(origin == kEncapsulation ? kEncapsulation : 0);
    at_ = kEncapsulation - origin;
  }
  if (!structure(definitions_->root(), nullptr, &slots_, 0)) return false;
  return left() <= (layout_ == Layout::kCdr ? kMostLeft : 0);
}

bool Messages::align(std::size_t size) {
  if (layout_ == Layout::kRos1) return true;
  const std::size_t step = std::min(size, widest_);
  const std::size_t over = at_ % step;
  if (over != 0) at_ += step - over;
  return at_ <= bytes_.size();
}

bool Messages::count(std::uint32_t& value) {
  if (!align(4) || left() < 4) return false;
  value = read_as<std::uint32_t>(bytes_, at_, big_);
  at_ += 4;
  return value <= left() || value == 0;  // every element takes a byte at least
}

double Messages::number(Basic basic, std::size_t at) const {
  switch (basic) {
    case Basic::kInt8:
      return static_cast<std::int8_t>(bytes_[at]);
    case Basic::kInt16:
      return read_as<std::int16_t>(bytes_, at, big_);
    case Basic::kUint16:
      return read_as<std::uint16_t>(bytes_, at, big_);
    case Basic::kInt32:
      return read_as<std::int32_t>(bytes_, at, big_);
    case Basic::kUint32:
      return read_as<std::uint32_t>(bytes_, at, big_);
    case Basic::kInt64:
      return static_cast<double>(read_as<std::int64_t>(bytes_, at, big_));
    case Basic::kUint64:
      return static_cast<double>(read_as<std::uint64_t>(bytes_, at, big_));
    case Basic::kFloat32:
      return static_cast<double>(read_as<float>(bytes_, at, big_));
    case Basic::kFloat64:
      return read_as<double>(bytes_, at, big_);
    default:
      return bytes_[at];
  }
}

bool Messages::structure(const Type& type, const Path* path, Slots* slots, int depth) {
  if (depth > kMostDepth) return false;
  if (type.members.empty() && layout_ == Layout::kCdr) {  // a struct holds a byte at least
    if (left() < 1) return false;
    ++at_;
    return true;
  }
  if (slots != nullptr && slots->members.size() < type.members.size()) slots->members.resize(type.members.size());
  const bool header = depth == 1 && path->member->name == "header" && type.name == "std_msgs/Header";
  for (std::size_t i = 0; i < type.members.size(); ++i) {
    const std::size_t before = at_;
    if (!member(type.members[i], path, slots == nullptr ? nullptr : &slots->members[i], depth)) return false;
    if (header && type.members[i].name == "stamp" && at_ - before >= 8) {
      seconds_ = read_as<std::int32_t>(bytes_, at_ - 8, big_);
      if (layout_ == Layout::kRos1) seconds_ = read_as<std::uint32_t>(bytes_, at_ - 8, big_);
      nanoseconds_ = read_as<std::uint32_t>(bytes_, at_ - 4, big_);
      stamped_ = true;
    }
  }
  return true;
}

bool Messages::member(const Member& member, const Path* path, MemberSlots* slots, int depth) {
  if (!member.list) return one(member, path, slots, 0, depth);
  std::size_t elements = member.count;
  if (elements == 0) {
    std::uint32_t stated = 0;
    if (!count(stated)) return false;
    elements = stated;
    if (slots != nullptr) {
      if (!slots->length && fields_.size() < kMostFields) slots->length = field(prefix(path) + member.name + ".length");
      if (slots->length) put(*slots->length, static_cast<double>(elements));
    }
  }
  if (const std::size_t size = size_of(member.basic); size > 0) {  // numbers: only the first become fields
    if (elements == 0) return true;
    if (!align(size) || elements > left() / size) return false;
    for (std::size_t k = 0; k < std::min(elements, kMostElements) && slots != nullptr; ++k) {
      if (slots->numbers.size() <= k) {
        if (fields_.size() >= kMostFields) break;
        slots->numbers.push_back(field(name_of(path, member, k)));
      }
      put(slots->numbers[k], number(member.basic, at_ + k * size));
    }
    at_ += elements * size;
    return true;
  }
  if (layout_ == Layout::kRos1 && member.basic == Basic::kStruct && empty(*member.type)) return true;
  for (std::size_t k = 0; k < elements; ++k) {
    if (!one(member, path, k < kMostElements ? slots : nullptr, k, depth)) return false;
  }
  return true;
}

bool Messages::one(const Member& member, const Path* path, MemberSlots* slots, std::size_t index, int depth) {
  const auto named = [&] { return name_of(path, member, index); };
  switch (member.basic) {
    case Basic::kStruct: {
      Slots* nested = nullptr;
      if (slots != nullptr) {
        if (slots->nested.size() <= index && fields_.size() < kMostFields)
          slots->nested.push_back(std::make_unique<Slots>());
        if (index < slots->nested.size()) nested = slots->nested[index].get();
      }
      const Path own{path, &member, index};
      return structure(*member.type, &own, nested, depth + 1);
    }
    case Basic::kString: {
      std::uint32_t length = 0;
      if (!count(length) || length > left()) return false;
      if (!said_ && announced_ && length > 1 && !of_header(path)) {
        std::string words{reinterpret_cast<const char*>(bytes_.data() + at_), length};
        while (!words.empty() && words.back() == '\0') words.pop_back();
        sink_.text(topic_, named(), words);
        said_ = true;
      }
      at_ += length;
      return true;
    }
    case Basic::kTime:
    case Basic::kDuration: {
      if (!align(4) || left() < 8) return false;
      if (slots != nullptr) {
        if (slots->numbers.size() <= index && fields_.size() < kMostFields) {
          slots->numbers.push_back(field(named() + ".sec"));
          (void)field(named() + ".nsec");
        }
        if (index < slots->numbers.size()) {
          const Basic half = member.basic == Basic::kTime ? Basic::kUint32 : Basic::kInt32;
          put(slots->numbers[index], number(half, at_));
          put(slots->numbers[index] + 1, number(half, at_ + 4));
        }
      }
      at_ += 8;
      return true;
    }
    default: {
      const std::size_t size = size_of(member.basic);
      if (!align(size) || left() < size) return false;
      if (slots != nullptr) {
        if (slots->numbers.size() <= index && fields_.size() < kMostFields) slots->numbers.push_back(field(named()));
        if (index < slots->numbers.size()) put(slots->numbers[index], number(member.basic, at_));
      }
      at_ += size;
      return true;
    }
  }
}

}  // namespace fathom::recordings::ros
