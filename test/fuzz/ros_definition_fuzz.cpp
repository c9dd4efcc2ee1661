// Any text as a definition of a ROS message, and any bytes as such a message.
#include <string>
#include <string_view>

#include "common/recordings/ros/message.hpp"

namespace {

using namespace fathom;

struct Nowhere final : recordings::Sink {
  bool topic(std::size_t, const recordings::Topic&) override { return true; }
  void further_field(std::size_t, const recordings::Field&) override {}
  void message(std::size_t, recordings::Stamp, std::span<const double>) override {}
  void text(std::size_t, std::string_view, std::string_view) override {}
};

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size < 3) return 0;
  const std::size_t split = 3 + static_cast<std::size_t>(data[1]) * 4 % size;
  const std::size_t end = split < size ? split : size;
  const std::string_view text{reinterpret_cast<const char*>(data) + 3, end - 3};
  std::string reason;
  const auto definitions = recordings::ros::Definitions::parse("a/A", text, (data[0] & 1) != 0, reason);
  if (definitions == nullptr) return 0;
  Nowhere nowhere;
  recordings::ros::Messages messages{
      0, definitions, (data[0] & 2) != 0 ? recordings::ros::Layout::kRos1 : recordings::ros::Layout::kCdr, nowhere};
  messages.announced();
  std::int64_t measured = 0;
  (void)messages.read({data + end, size - end}, measured);
  (void)messages.read({data + end, size - end}, measured);
  return 0;
}
