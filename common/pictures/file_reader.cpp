#include "common/pictures/file_reader.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "common/vision/jpeg.hpp"

namespace fathom::pictures {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool begins(const Bytes& bytes, std::string_view with) {
  return bytes.size() >= with.size() && std::equal(with.begin(), with.end(), bytes.begin(), [](char a, std::uint8_t b) {
           return static_cast<std::uint8_t>(a) == b;
         });
}

// A PNG ends with this; of one that does not, libpng would say so itself, in its own words.
bool png_is_cut(const Bytes& bytes) {
  constexpr std::string_view kBegin{"\x89PNG\r\n\x1a\n"}, kEnd{"IEND"};
  return begins(bytes, kBegin) && std::search(bytes.begin(), bytes.end(), kEnd.begin(), kEnd.end()) == bytes.end();
}

int bits_of(const cv::Mat& picture) {
  double largest = 0.0;
  cv::minMaxIdx(picture.reshape(1), nullptr, &largest);
  constexpr std::array<int, 5> kUsual{8, 10, 12, 14, 16};
  for (const int bits : kUsual) {
    if (largest < static_cast<double>(1 << bits)) return bits;
  }
  return kUsual.back();
}

}  // namespace

void FileReader::read(const std::filesystem::path& path, Frame& frame) {
  std::ifstream file{path, std::ios::binary};
  Bytes bytes{std::istreambuf_iterator<char>{file}, {}};
  if (bytes.empty()) {
    frame.problem = path.string() + (file.is_open() ? ": is empty" : ": cannot be read");
  } else if (begins(bytes, "\xff\xd8")) {
    cv::Mat grey, bgr;
    const std::string problem = vision::decode_jpeg(bytes, true, grey, bgr);
    if (problem.empty()) {
      frame.picture = bgr.empty() ? grey : bgr;
      frame.halved_colour = vision::halves_colour(bytes);
      frame.jpeg = std::move(bytes);
    } else {
      frame.problem = path.string() + ": " + problem;
    }
  } else if (png_is_cut(bytes)) {
    frame.problem = path.string() + ": ends before the picture does";
  } else {
    try {
      frame.picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
      frame.picture.release();
    }
    if (frame.picture.empty()) {
      frame.problem = path.string() + ": no picture that can be read; is it damaged?";
    } else {
      if (frame.picture.depth() == CV_16U) bits_ = std::max(bits_, bits_of(frame.picture));
      frame.picture = plain(frame.picture, bits_);
    }
  }
}

cv::Mat plain(const cv::Mat& picture, int bits) {
  cv::Mat result = picture;
  if (picture.depth() == CV_16U) {
    picture.convertTo(result, CV_8U, 255.0 / static_cast<double>((1 << bits) - 1));
  } else if (picture.depth() != CV_8U) {
    cv::normalize(picture, result, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  }
  if (result.channels() == 4) cv::cvtColor(result, result, cv::COLOR_BGRA2BGR);
  if (result.channels() == 2) cv::extractChannel(result, result, 0);
  return result;
}

}  // namespace fathom::pictures
