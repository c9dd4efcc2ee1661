// A message of ROS as numbers: CDR (ROS 2) or ROS 1's own layout, read by the definition that the recording carries.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/recordings/file_window.hpp"
#include "common/recordings/ros/definition.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::ros {

enum class Layout : std::uint8_t { kCdr, kRos1 };

/// One topic's reader. Lists make fields as they grow, the first 64 of each and its length.
class Messages {
 public:
  Messages(std::size_t topic, std::shared_ptr<const Definitions> definitions, Layout layout, Sink& sink);

  /// Numbers of a message, or nothing where the bytes do not fit the definition. `measured`: header.stamp, us, or
  /// kNoTime. The numbers live until the next call.
  std::optional<std::span<const double>> read(Bytes message, std::int64_t& measured);

  /// Fields of a message without lists, as they are known before the first message.
  [[nodiscard]] const std::vector<Field>& fields() const { return fields_; }
  /// From now on further fields are told to the sink.
  void announced() { announced_ = true; }

 private:
  /// Numbers of the fields of a type's members, grown as lists do.
  struct Slots;
  struct MemberSlots {
    std::vector<std::size_t> numbers;            ///< by element
    std::vector<std::unique_ptr<Slots>> nested;  ///< by element
    std::optional<std::size_t> length;
  };
  struct Slots {
    std::vector<MemberSlots> members;
  };

  /// The members that lead to one: a name is made of them only where a field is, since messages are many.
  struct Path {
    const Path* outer{};  ///< null: the message itself
    const Member* member{};
    std::size_t index{};  ///< of a list's element
  };
  [[nodiscard]] static bool of_header(const Path* path);
  static std::string prefix(const Path* path);
  static std::string name_of(const Path* path, const Member& member, std::size_t index);

  void prepare(const Type& type, const std::string& path, Slots& slots, int depth);
  bool attempt(Bytes message, std::size_t origin);
  bool structure(const Type& type, const Path* path, Slots* slots, int depth);
  bool member(const Member& member, const Path* path, MemberSlots* slots, int depth);
  bool one(const Member& member, const Path* path, MemberSlots* slots, std::size_t index, int depth);
  std::size_t field(const std::string& name);
  void put(std::size_t number, double value);
  bool align(std::size_t size);
  bool count(std::uint32_t& value);
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] double number(Basic basic, std::size_t at) const;
  [[nodiscard]] static bool empty(const Type& type);

  std::size_t topic_;
  std::shared_ptr<const Definitions> definitions_;
  Layout layout_;
  Sink& sink_;
  std::vector<Field> fields_;
  Slots slots_;
  bool announced_{}, said_{};
  std::size_t origin_{4};  ///< where alignment counts from
  // The message at hand.
  Bytes bytes_;
  std::size_t at_{};
  bool big_{};
  std::size_t widest_{8};
  std::vector<double> values_;
  std::int64_t seconds_{}, nanoseconds_{};
  bool stamped_{};
};

}  // namespace fathom::recordings::ros
