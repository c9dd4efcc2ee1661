// Whole JPEG pictures out of a stream of bytes, as cameras on a network send them: one behind the other, with or
// without the lines of an HTTP answer between.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fathom::vision {

class JpegStream {
 public:
  static constexpr std::size_t kLargest = 16U << 20U;  ///< B of one picture; whatever is longer was none

  using Picture = std::function<void(std::vector<std::uint8_t> bytes)>;
  /// Hands over each picture that is complete with these bytes.
  void feed(std::span<const std::uint8_t> bytes, const Picture& picture);
  /// The line was opened anew: what has come of a picture is forgotten.
  void restart();
  /// A picture has begun and is not complete.
  [[nodiscard]] bool inside() const { return begun_; }
  [[nodiscard]] std::int64_t torn() const { return torn_; }  ///< begun, and never complete

 private:
  enum class Step { kDone, kMore, kTorn };
  [[nodiscard]] Step step();
  bool find_begin();

  std::vector<std::uint8_t> waiting_;
  std::size_t at_{};  ///< of the next marker, from the picture's begin
  bool begun_{false}, in_scan_{false};
  std::int64_t torn_{};
};

}  // namespace fathom::vision
