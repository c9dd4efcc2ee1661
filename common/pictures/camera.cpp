#include "common/pictures/camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iomanip>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/vision/jpeg.hpp"

namespace fathom::pictures {
namespace {

std::string cameras_here() {
  std::string names;
  std::error_code error;
  for (int i = 0; i < 64; ++i) {
    const std::string path = "/dev/video" + std::to_string(i);
    if (std::filesystem::exists(path, error)) names += (names.empty() ? "" : ", ") + path;
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

std::string letters(int fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<char>((static_cast<unsigned>(fourcc) >> static_cast<unsigned>(shift)) & 0xffU);
    if (c > ' ' && c < 127) text += c;
  }
  return text;
}

// OpenCV waits up to 10 s for a camera's first picture and lets nothing else happen meanwhile. We wait ourselves.
void never_block() { setenv("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", "0", 1); }  // read at its first use

double seconds(auto time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

class V4l2Camera final : public Camera {
 public:
  V4l2Camera(const CameraSettings& settings, const cv::VideoCapture& capture)
      : device_{settings.device}, streams_{capture} {
    using cv::VideoWriter;
    const auto& f = settings.format;
    // The format first: it decides which sizes there are.
    if (!f.empty()) set(cv::CAP_PROP_FOURCC, VideoWriter::fourcc(f[0], f[1], f[2], f[3]));
    if (settings.width > 0) set(cv::CAP_PROP_FRAME_WIDTH, settings.width);
    if (settings.height > 0) set(cv::CAP_PROP_FRAME_HEIGHT, settings.height);
    if (settings.rate > 0.0) set(cv::CAP_PROP_FPS, settings.rate);
    if (settings.newest_only) set(cv::CAP_PROP_BUFFERSIZE, 1);
    const auto given = static_cast<int>(get(cv::CAP_PROP_FOURCC));
    format_ = letters(given);
    full_colour_ = format_ == "BGR3" || format_ == "RGB3" || format_ == "XR24" || format_ == "AR24";
    describe_rate(settings.rate);
    width_ = static_cast<int>(get(cv::CAP_PROP_FRAME_WIDTH));
    height_ = static_cast<int>(get(cv::CAP_PROP_FRAME_HEIGHT));
    if ((settings.width > 0 && settings.width != width_) || (settings.height > 0 && settings.height != height_) ||
        (!f.empty() && VideoWriter::fourcc(f[0], f[1], f[2], f[3]) != given)) {
      std::string asked = f;
      const auto add = [&](const char* what, int pixels) {
        if (pixels > 0) asked += (asked.empty() ? "" : ", ") + std::string{what} + " " + std::to_string(pixels);
      };
      add("width", settings.width);
      add("height", settings.height);
      throw InputError(device_ + ": gives " + description() + " where " + asked +
                       " was asked for; what it can: v4l2-ctl -d " + device_ + " --list-formats-ext");
    }
    // Otherwise bytes that are no picture would come as one.
    if (!streams_[0].set(cv::CAP_PROP_CONVERT_RGB, 1)) {
      throw InputError(device_ + ": gives " + description() +
                       ", a format that OpenCV cannot read; 'format' may ask for " +
                       "another (MJPG, YUYV): v4l2-ctl -d " + device_ + " --list-formats-ext");
    }
    // Its own JPEG is handed on: not read and compressed anew.
    own_jpeg_ = (format_ == "MJPG" || format_ == "JPEG") && streams_[0].set(cv::CAP_PROP_CONVERT_RGB, 0);
  }

  bool wait(double longest) override {
    std::vector<int> ready;
    try {
      return cv::VideoCapture::waitAny(streams_, ready,
                                       std::max<std::int64_t>(static_cast<std::int64_t>(longest * 1e9), 1));
    } catch (const cv::Exception&) {
      // The first call starts the stream, and fails when no picture is there at once (never_block).
      if (!std::exchange(started_, true)) return false;
      throw InputError(gone());
    }
  }

  Frame read() override {
    Frame frame{.name = device_};
    cv::Mat got;
    if (!streams_[0].grab()) throw InputError(gone());
    // Before anything is decoded, and both clocks at once: what comes after is not the picture's age.
    const double monotonic = seconds(std::chrono::steady_clock::now()),
                 wall = seconds(std::chrono::system_clock::now());
    frame.arrival = std::llround(1e6 * wall);
    frame.age = age_of_stamp(1e-3 * get(cv::CAP_PROP_POS_MSEC), monotonic, wall);
    if (!streams_[0].retrieve(got) || got.empty()) throw InputError(gone());
    ++count_;
    if (own_jpeg_) {
      const auto* first = got.ptr<std::uint8_t>();
      frame.jpeg.assign(first, first + got.total() * got.elemSize());
      cv::Mat grey, bgr;
      frame.problem = vision::decode_jpeg(frame.jpeg, false, grey, bgr);
      if (frame.problem.empty()) frame.picture = grey;
      if (!frame.problem.empty()) frame.problem = device_ + ": " + frame.problem;
    } else {
      frame.picture = plain(got).clone();
      frame.halved_colour = !full_colour_;
    }
    return frame;
  }

  [[nodiscard]] std::string description() const override {
    return std::to_string(width_) + " x " + std::to_string(height_) + ", " + format_ + rate_;
  }

 private:
  void describe_rate(double asked) {
    const double given = get(cv::CAP_PROP_FPS);
    if (!(given > 0.0) || !std::isfinite(given)) return;  // not every driver knows
    const auto in_hertz = [](double rate) {
      std::ostringstream text;
      text << std::setprecision(3) << rate << " Hz";
      return text.str();
    };
    rate_ = ", " + in_hertz(given);
    if (asked > 0.0 && std::abs(given - asked) > 0.01 * asked) rate_ += " (" + in_hertz(asked) + " asked for)";
  }

  // What it did not take is seen in what it then has.
  void set(int property, double value) { static_cast<void>(streams_[0].set(property, value)); }
  [[nodiscard]] double get(int property) const { return streams_[0].get(property); }
  [[nodiscard]] std::string gone() const {
    if (count_ == 0) return device_ + ": no picture comes out of it; who else has this camera: fuser -v " + device_;
    return device_ + ": the camera gives no pictures any more";
  }

  std::string device_, format_, rate_;
  std::vector<cv::VideoCapture> streams_;  // one: waitAny takes many
  int width_{}, height_{};
  bool own_jpeg_{false}, full_colour_{false}, started_{false};
  std::size_t count_{};
};

}  // namespace

std::optional<double> age_of_stamp(double stamp, double monotonic, double wall) {
  constexpr double kAhead = 0.5, kOldest = 2.0;  // s: a frame at most, should a driver stamp the end before it has come
  if (!(stamp > 0.0)) return {};
  for (const double now : {monotonic, wall}) {
    const double age = now - stamp;
    if (age > -kAhead && age < kOldest) return age;
  }
  return {};
}

std::unique_ptr<Camera> open_camera(const CameraSettings& settings) {
  if (!settings.format.empty() && settings.format.size() != 4) {
    throw InputError(settings.device + ": a format has four letters (MJPG, YUYV), not '" + settings.format + "'");
  }
  need_camera(settings.device);
  never_block();
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it, in one line
  cv::VideoCapture capture;
  try {
    capture.open(settings.device, cv::CAP_V4L2);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened()) {
    throw InputError(settings.device + ": busy, or a camera that OpenCV cannot read; who has it: fuser -v " +
                     settings.device);
  }
  return std::make_unique<V4l2Camera>(settings, capture);
}

}  // namespace fathom::pictures
