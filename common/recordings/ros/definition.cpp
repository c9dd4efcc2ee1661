#include "common/recordings/ros/definition.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <utility>

#include "common/recordings/ros/raw_definition.hpp"

namespace fathom::recordings::ros {
namespace {

constexpr int kMostDepth = 32;
constexpr std::size_t kMostFixed = 100'000;    // elements of a list of fixed length
constexpr std::size_t kMostParts = 1'000'000;  // of a type: a few lines can claim more than a file can hold

constexpr std::array<std::pair<std::string_view, Basic>, 25> kBasics{{{"bool", Basic::kBool},
                                                                      {"boolean", Basic::kBool},
                                                                      {"byte", Basic::kUint8},
                                                                      {"octet", Basic::kUint8},
                                                                      {"char", Basic::kUint8},
                                                                      {"int8", Basic::kInt8},
                                                                      {"uint8", Basic::kUint8},
                                                                      {"int16", Basic::kInt16},
                                                                      {"uint16", Basic::kUint16},
                                                                      {"int32", Basic::kInt32},
                                                                      {"uint32", Basic::kUint32},
                                                                      {"int64", Basic::kInt64},
                                                                      {"uint64", Basic::kUint64},
                                                                      {"short", Basic::kInt16},
                                                                      {"unsigned short", Basic::kUint16},
                                                                      {"long", Basic::kInt32},
                                                                      {"unsigned long", Basic::kUint32},
                                                                      {"long long", Basic::kInt64},
                                                                      {"unsigned long long", Basic::kUint64},
                                                                      {"float32", Basic::kFloat32},
                                                                      {"float", Basic::kFloat32},
                                                                      {"float64", Basic::kFloat64},
                                                                      {"double", Basic::kFloat64},
                                                                      {"string", Basic::kString},
                                                                      {"wstring", Basic::kStruct}}};

}  // namespace

/// Links raw definitions to types.
class Builder {
 public:
  Builder(const RawDefinitions& raw, Definitions& out) : raw_(raw), out_(out) {}

  const Type* build(const std::string& name, int depth, std::string& reason) {
    if (const auto known = out_.types_.find(name); known != out_.types_.end()) {
      if (open_.contains(name)) reason = "type " + name + " holds itself";
      return open_.contains(name) ? nullptr : known->second.get();
    }
    const auto raw = raw_.find(name);
    if (raw == raw_.end() || depth > kMostDepth) {
      reason = raw == raw_.end() ? "type " + name + " is not defined" : "types are nested too deeply";
      return nullptr;
    }
    open_.insert(name);
    Type& type = *(out_.types_[name] = std::make_unique<Type>());
    type.name = name;
    for (const RawMember& member : raw->second) {
      Member made{.name = member.name, .list = member.list, .count = member.count};
      if (member.count > kMostFixed) {
        reason = "member " + member.name + " of " + name + " is too long a list";
        return nullptr;
      }
      const auto basic = std::ranges::find(kBasics, member.type, &std::pair<std::string_view, Basic>::first);
      if (member.type == "wstring") {
        reason = "member " + member.name + " of " + name + " is a wstring, which writers lay out differently";
        return nullptr;
      }
      if (basic != kBasics.end()) {
        made.basic = basic->second;
      } else if (member.type == "time" || member.type == "duration") {
        made.basic = member.type == "time" ? Basic::kTime : Basic::kDuration;
      } else {
        std::string of = short_name(member.type);
        if (of == "Header") of = "std_msgs/Header";
        if (of.find('/') == std::string::npos) of = name.substr(0, name.find('/') + 1) + of;
        made.basic = Basic::kStruct;
        made.type = build(of, depth + 1, reason);
        if (made.type == nullptr) return nullptr;
      }
      const std::size_t each = made.type == nullptr ? 1 : made.type->parts;
      type.parts += each * (made.type == nullptr ? 1 : std::max<std::size_t>(made.count, 1));
      if (type.parts > kMostParts) {
        reason = "type " + name + " has too many members";
        return nullptr;
      }
      type.members.push_back(std::move(made));
    }
    open_.erase(name);
    return &type;
  }

 private:
  const RawDefinitions& raw_;
  Definitions& out_;
  std::set<std::string> open_;
};

std::size_t size_of(Basic basic) {
  switch (basic) {
    case Basic::kBool:
    case Basic::kInt8:
    case Basic::kUint8:
      return 1;
    case Basic::kInt16:
    case Basic::kUint16:
      return 2;
    case Basic::kInt32:
    case Basic::kUint32:
    case Basic::kFloat32:
      return 4;
    case Basic::kInt64:
    case Basic::kUint64:
    case Basic::kFloat64:
      return 8;
    default:
      return 0;
  }
}

std::string short_name(std::string_view name) {
  const std::size_t first = name.find('/');
  const std::size_t last = name.rfind('/');
  if (first == last) return std::string{name};
  return std::string{name.substr(0, first)} + std::string{name.substr(last)};
}

std::shared_ptr<const Definitions> Definitions::parse(const std::string& root, std::string_view text, bool idl,
                                                      std::string& reason) {
  const std::string name = short_name(root);
  RawDefinitions raw = idl ? raw_from_idl(text) : raw_from_msg(name, text);
  // What a definition leaves out is what everybody knows.
  for (const char* usual : {"std_msgs/Header", "builtin_interfaces/Time", "builtin_interfaces/Duration"}) {
    if (raw.contains(usual)) continue;
    for (auto& [type, members] : raw_from_msg(usual, usual_definition(usual))) raw.emplace(type, std::move(members));
  }
  auto definitions = std::make_shared<Definitions>();
  definitions->root_ = Builder{raw, *definitions}.build(name, 0, reason);
  return definitions->root_ == nullptr ? nullptr : definitions;
}

}  // namespace fathom::recordings::ros
