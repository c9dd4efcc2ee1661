#include "common/pictures/source.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>

#include "common/base/error.hpp"
#include "common/vision/jpeg.hpp"

namespace fathom::pictures {
namespace {

namespace fs = std::filesystem;

constexpr double kFolderRate = 10.0;

const std::set<std::string> kPictures{".png", ".jpg", ".jpeg", ".bmp",  ".pgm",
                                      ".ppm", ".pnm", ".tif",  ".tiff", ".webp"};

std::string ending(const fs::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// "frame2" before "frame10".
bool before(const std::string& a, const std::string& b) {
  std::size_t i = 0, k = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (i < a.size() && k < b.size()) {
    if (digit(a[i]) && digit(b[k])) {
      while (i < a.size() && a[i] == '0') ++i;
      while (k < b.size() && b[k] == '0') ++k;
      std::size_t i_end = i, k_end = k;
      while (i_end < a.size() && digit(a[i_end])) ++i_end;
      while (k_end < b.size() && digit(b[k_end])) ++k_end;
      if (i_end - i != k_end - k) return i_end - i < k_end - k;
      const int order = a.compare(i, i_end - i, b, k, k_end - k);
      if (order != 0) return order < 0;
      i = i_end;
      k = k_end;
    } else {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i;
      ++k;
    }
  }
  return a.size() - i < b.size() - k || (a.size() - i == b.size() - k && a < b);
}

// 8 bit, one or three channels.
cv::Mat plain(const cv::Mat& picture) {
  cv::Mat result = picture;
  if (picture.depth() == CV_16U) {
    picture.convertTo(result, CV_8U, 1.0 / 257.0);
  } else if (picture.depth() != CV_8U) {
    cv::normalize(picture, result, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  }
  if (result.channels() == 4) cv::cvtColor(result, result, cv::COLOR_BGRA2BGR);
  if (result.channels() == 2) cv::extractChannel(result, result, 0);
  return result;
}

class Folder final : public Source {
 public:
  Folder(std::vector<fs::path> files, double rate) : files_{std::move(files)}, rate_{rate} {}

  std::optional<Frame> next() override {
    if (at_ >= files_.size()) return {};
    const fs::path& path = files_[at_];
    Frame frame{.name = path.filename().string(), .time = static_cast<double>(at_) / rate_};
    ++at_;
    std::ifstream file{path, std::ios::binary};
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>{file}, {}};
    const bool jpeg = bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8;
    if (!file && bytes.empty()) {
      frame.problem = path.string() + ": cannot be read";
    } else if (jpeg) {
      cv::Mat grey, bgr;
      const std::string problem = vision::decode_jpeg(bytes, true, grey, bgr);
      if (problem.empty()) {
        frame.picture = bgr.empty() ? grey : bgr;
        frame.halved_colour = vision::halves_colour(bytes);
        frame.jpeg = std::move(bytes);
      } else {
        frame.problem = path.string() + ": " + problem;
      }
    } else {
      try {
        frame.picture = bytes.empty() ? cv::Mat{} : cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
      } catch (const cv::Exception&) {
        frame.picture.release();
      }
      if (frame.picture.empty()) {
        frame.problem = path.string() + ": no picture that can be read; is it damaged?";
      } else {
        frame.picture = plain(frame.picture);
      }
    }
    return frame;
  }
  [[nodiscard]] double rate() const override { return rate_; }

 private:
  std::vector<fs::path> files_;
  double rate_;
  std::size_t at_{};
};

class Video final : public Source {
 public:
  Video(const cv::VideoCapture& capture, std::string name, double rate, bool live)
      : capture_{capture}, name_{std::move(name)}, rate_{rate}, live_{live} {}

  std::optional<Frame> next() override {
    Frame frame;
    cv::Mat picture;
    if (!capture_.read(picture) || picture.empty()) {
      if (count_ == 0) {
        throw InputError(
            name_ + ": no picture comes out of it; " +
            (live_ ? "who else has this camera: fuser -v " + name_ : "is it a video that OpenCV can read?"));
      }
      return {};
    }
    char text[32];
    std::snprintf(text, sizeof text, "%06zu", count_);
    frame.name = text;
    const auto now = std::chrono::steady_clock::now();
    if (count_ == 0) first_ = now;
    frame.time = live_ ? std::chrono::duration<double>(now - first_).count() : static_cast<double>(count_) / rate_;
    ++count_;
    frame.picture = plain(picture).clone();
    frame.halved_colour = true;  // videos have 4:2:0, cameras 4:2:2 or 4:2:0; OpenCV does not say
    return frame;
  }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] bool live() const override { return live_; }

 private:
  cv::VideoCapture capture_;
  std::string name_;
  double rate_;
  bool live_;
  std::size_t count_{};
  std::chrono::steady_clock::time_point first_;
};

}  // namespace

std::unique_ptr<Source> open(const std::string& path, double rate) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path + ": no such file or folder");
  const double folder_rate = rate > 0.0 ? rate : kFolderRate;
  if (fs::is_directory(path)) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator{path, error}) {
      if (entry.is_regular_file() && kPictures.contains(ending(entry.path()))) files.push_back(entry.path());
    }
    if (files.empty()) throw InputError(path + ": no pictures in this folder (png, jpg, bmp, pgm, tif, webp)");
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
      return before(a.filename().string(), b.filename().string());
    });
    return std::make_unique<Folder>(std::move(files), folder_rate);
  }
  if (kPictures.contains(ending(path))) return std::make_unique<Folder>(std::vector<fs::path>{path}, folder_rate);
  cv::VideoCapture capture;
  try {
    capture.open(path);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened()) throw InputError(path + ": neither a folder of pictures nor a video that OpenCV can read");
  const double stated = capture.get(cv::CAP_PROP_FPS);
  const bool sensible = std::isfinite(stated) && stated > 0.01 && stated < 10000.0;
  return std::make_unique<Video>(capture, path, rate > 0.0 ? rate : (sensible ? stated : kFolderRate), false);
}

namespace {

std::string cameras_here() {
  std::string names;
  std::error_code error;
  for (int i = 0; i < 64; ++i) {
    const std::string path = "/dev/video" + std::to_string(i);
    if (fs::exists(path, error)) names += (names.empty() ? "" : ", ") + path;
  }
  return names.empty() ? "this host has no /dev/video*; is the camera plugged in?" : "there are " + names;
}

// OpenCV says only that it failed.
void need_camera(const std::string& device) {
  const int opened = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  const int why = errno;
  if (opened < 0) {
    if (why == ENOENT || why == ENXIO || why == ENODEV)
      throw InputError(device + ": no such device; " + cameras_here());
    if (why == EACCES || why == EPERM) {
      throw InputError(device + ": no permission; cameras belong to the group video: sudo usermod -aG video " +
                       std::string{"$USER, and log in again"});
    }
    if (why == EBUSY) throw InputError(device + ": busy; another program has this camera: fuser -v " + device);
    throw InputError(device + ": cannot be opened: " + std::strerror(why));
  }
  v4l2_capability able{};
  const bool answered = ioctl(opened, VIDIOC_QUERYCAP, &able) == 0;
  const std::uint32_t all =
      answered && (able.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? able.device_caps : able.capabilities;
  ::close(opened);
  if (!answered) throw InputError(device + ": no camera (V4L2); a video or a folder is told as 'pictures'");
  if ((all & V4L2_CAP_VIDEO_CAPTURE) == 0) {
    throw InputError(device + ": takes no pictures (a camera's other device, or no camera); " + cameras_here());
  }
}

}  // namespace

std::unique_ptr<Source> open_camera(const std::string& device, int width, int height, double rate) {
  need_camera(device);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it, in one line
  cv::VideoCapture capture;
  try {
    capture.open(device, cv::CAP_V4L2);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened()) {
    throw InputError(device + ": busy, or a camera that OpenCV cannot read; who has it: fuser -v " + device);
  }
  if (width > 0) capture.set(cv::CAP_PROP_FRAME_WIDTH, width);
  if (height > 0) capture.set(cv::CAP_PROP_FRAME_HEIGHT, height);
  if (rate > 0.0) capture.set(cv::CAP_PROP_FPS, rate);
  capture.set(cv::CAP_PROP_BUFFERSIZE, 1);
  return std::make_unique<Video>(capture, device, rate, true);
}

cv::Mat in_grey(const cv::Mat& picture) {
  if (picture.channels() != 3) return picture;
  cv::Mat grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

void write(const std::string& path, const cv::Mat& picture) {
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
}

}  // namespace fathom::pictures
