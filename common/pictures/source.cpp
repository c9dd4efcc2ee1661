#include "common/pictures/source.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>

#include "common/base/error.hpp"
#include "common/pictures/file_reader.hpp"

namespace fathom::pictures {
namespace {

namespace fs = std::filesystem;

constexpr double kFolderRate = 10.0;

const std::set<std::string> kPictures{".png", ".jpg", ".jpeg", ".jp2",  ".bmp", ".pgm",
                                      ".ppm", ".pnm", ".tif",  ".tiff", ".webp"};

std::string ending(const fs::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Names that begin with a dot are other programs' notes beside the pictures.
bool is_picture(const fs::directory_entry& entry) {
  std::error_code error;
  return entry.is_regular_file(error) && entry.path().filename().string().front() != '.' &&
         kPictures.contains(ending(entry.path()));
}

bool has_pictures(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator all{folder, error};
  return std::any_of(begin(all), end(all), is_picture);
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

class Folder final : public Source {
 public:
  Folder(std::vector<fs::path> files, double rate) : files_{std::move(files)}, rate_{rate} {}

  std::optional<Frame> next() override {
    if (at_ >= files_.size()) return {};
    Frame frame{.name = files_[at_].filename().string(), .time = static_cast<double>(at_) / rate_};
    reader_.read(files_[at_], frame);
    ++at_;
    return frame;
  }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] double to_come() const override { return static_cast<double>(files_.size() - at_); }

 private:
  std::vector<fs::path> files_;
  double rate_;
  std::size_t at_{};
  FileReader reader_;
};

class Video final : public Source {
 public:
  Video(const cv::VideoCapture& capture, std::string name, double rate)
      : capture_{capture}, name_{std::move(name)}, rate_{rate} {}

  std::optional<Frame> next() override {
    Frame frame;
    cv::Mat picture;
    if (!capture_.read(picture) || picture.empty()) {
      if (count_ == 0) throw InputError(name_ + ": no picture comes out of it; is it a video that OpenCV can read?");
      ended_ = true;
      return {};
    }
    char text[32];
    std::snprintf(text, sizeof text, "%06zu", count_);
    frame.name = text;
    frame.time = static_cast<double>(count_) / rate_;
    ++count_;
    frame.picture = plain(picture).clone();
    frame.halved_colour = true;  // as videos have it (4:2:0); OpenCV does not say
    return frame;
  }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] double to_come() const override {
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    return stated < 1e8 ? std::max(stated - static_cast<double>(count_), 0.0) : 0.0;
  }
  [[nodiscard]] std::string remark() const override {
    constexpr double kSure = 0.95;  // lengths are estimates where the rate varies
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    const auto came = static_cast<double>(count_);
    if (!ended_ || !(stated < 1e8) || came + 1.0 >= kSure * stated) return {};
    return name_ + ": ends after " + std::to_string(count_) + " of " + std::to_string(std::lround(stated)) +
           " pictures that it states; is it cut?";
  }

 private:
  cv::VideoCapture capture_;
  std::string name_;
  double rate_;
  std::size_t count_{};
  bool ended_{false};
};

}  // namespace

std::unique_ptr<Source> open(const std::string& path, double rate) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path + ": no such file or folder");
  const double folder_rate = rate > 0.0 ? rate : kFolderRate;
  if (fs::is_directory(path)) {
    std::vector<fs::path> files;
    std::string within;  // a folder with pictures, to say where they are
    for (const auto& entry : fs::directory_iterator{path, error}) {
      if (is_picture(entry)) files.push_back(entry.path());
      if (entry.is_directory(error) && has_pictures(entry.path())) within = entry.path().filename().string();
    }
    if (files.empty()) {
      throw InputError(path + ": no pictures in this folder (png, jpg, jp2, bmp, pgm, tif, webp)" +
                       (within.empty() ? "" : "; there are some in its folder '" + within + "'"));
    }
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
      return before(a.filename().string(), b.filename().string());
    });
    return std::make_unique<Folder>(std::move(files), folder_rate);
  }
  if (kPictures.contains(ending(path))) return std::make_unique<Folder>(std::vector<fs::path>{path}, folder_rate);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it, in one line
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);                              // as does FFmpeg's own voice
  cv::VideoCapture capture;
  try {
    capture.open(path);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened()) throw InputError(path + ": neither a folder of pictures nor a video that OpenCV can read");
  const double stated = capture.get(cv::CAP_PROP_FPS);
  const bool sensible = std::isfinite(stated) && stated > 0.01 && stated < 10000.0;
  return std::make_unique<Video>(capture, path, rate > 0.0 ? rate : (sensible ? stated : kFolderRate));
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
