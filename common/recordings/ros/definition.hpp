// Message definitions of ROS 1 and 2, as recordings carry them: text of .msg files, or of .idl files, one behind the
// other.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings::ros {

enum class Basic : std::uint8_t {
  kStruct,
  kBool,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kTime,      ///< ROS 1: two of 32 bits, unsigned
  kDuration,  ///< the same, signed
};

/// Bytes of one number; 0 for what is none.
[[nodiscard]] std::size_t size_of(Basic basic);

struct Type;

struct Member {
  std::string name;
  Basic basic{};
  const Type* type{};  ///< of a struct
  bool list{};
  std::size_t count{};  ///< of a list of fixed length; 0: the message says how many
};

struct Type {
  std::string name;  ///< "sensor_msgs/Imu"
  std::vector<Member> members;
  std::size_t parts{1};  ///< members with all that they hold, fixed lists counted through: what a reader must visit
};

/// All types that a message needs. Types are owned here and refer to each other.
class Definitions {
 public:
  /// "pkg/Type" or "pkg/msg/Type" with the text of its definition and those it needs. Null, with the reason, when a
  /// type is missing, refers to itself or cannot be understood.
  static std::shared_ptr<const Definitions> parse(const std::string& root, std::string_view text, bool idl,
                                                  std::string& reason);
  [[nodiscard]] const Type& root() const { return *root_; }

 private:
  friend class Builder;
  std::map<std::string, std::unique_ptr<Type>> types_;
  const Type* root_{};
};

/// "pkg/msg/Type" as "pkg/Type".
[[nodiscard]] std::string short_name(std::string_view name);

/// Definition of a usual type, for recordings that hold none; empty when it is not known here.
[[nodiscard]] std::string usual_definition(const std::string& name);

}  // namespace fathom::recordings::ros
