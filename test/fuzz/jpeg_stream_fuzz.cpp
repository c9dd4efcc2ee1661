// Any bytes as a camera's stream: pictures are whole, and however the stream is cut into pieces they are the same.
#include <algorithm>
#include <cstdlib>
#include <span>
#include <vector>

#include "common/vision/jpeg_stream.hpp"

namespace {

struct Told {
  std::vector<std::vector<std::uint8_t>> pictures;
  std::int64_t torn{};
  bool operator==(const Told&) const = default;
};

Told fed(std::span<const std::uint8_t> bytes, std::size_t piece) {
  fathom::vision::JpegStream stream;
  Told told;
  for (std::size_t i = 0; i < bytes.size(); i += piece) {
    stream.feed(bytes.subspan(i, std::min(piece, bytes.size() - i)),
                [&](std::vector<std::uint8_t> picture) { told.pictures.push_back(std::move(picture)); });
  }
  told.torn = stream.torn();
  return told;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size < 1) return 0;
  const std::span<const std::uint8_t> bytes{data + 1, size - 1};
  const Told whole = fed(bytes, std::max<std::size_t>(bytes.size(), 1));
  if (!(fed(bytes, 1U + data[0] % 16U) == whole)) std::abort();
  std::size_t sum = 0;
  for (const auto& picture : whole.pictures) {
    sum += picture.size();
    if (picture.size() < 4 || picture[0] != 0xff || picture[1] != 0xd8 || picture[picture.size() - 2] != 0xff ||
        picture.back() != 0xd9)
      std::abort();
  }
  if (sum > bytes.size()) std::abort();
  return 0;
}
