// A picture of 640 x 480 through the front end, beside the plain libraries' parts on the same pictures.
#include <benchmark/benchmark.h>

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <time.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/vision/front_end.hpp"
#include "common/vision/jpeg.hpp"
#include "common/vision/renderer.hpp"
#include "common/vision/threads.hpp"

namespace {

using namespace fathom;

constexpr int kPictures = 30;

/// A second over a poster of tags, as JPEG with the attitudes that a sensor would tell.
struct Dive {
  model::Site site;
  model::Lens lens{.width = 640, .height = 480, .fx = 540, .fy = 540, .cx = 319.5, .cy = 239.5};
  model::LaserMount laser{.camera = "down", .p_CE = {0.06, 0.0, 0.0}};
  std::vector<std::vector<std::uint8_t>> jpeg;
  std::vector<Eigen::Matrix3d> R_WC;

  Dive() {
    site.floor = 1.5;
    for (int i = 0; i < 45; ++i) {
      site.tags.push_back({.id = i, .size = 0.15, .p_WT = {0.45 * (i % 5 - 2), 0.45 * (i / 5 - 4), 1.5}});
    }
    vision::Renderer renderer{site, lens, laser, {}, 1};
    for (int i = 0; i < kPictures; ++i) {
      const double t = i / 30.0;
      const vision::Pose pose{.p_WC = {0.3 * t, 0.1 * t, 0.3}, .R_WC = rotation_from_euler({0.05, 0.03 * t, 0.3 * t})};
      jpeg.push_back(vision::encode_jpeg(renderer.step(t, pose), 90));
      R_WC.push_back(pose.R_WC);
    }
  }
};

const Dive& dive() {
  static const Dive one = [] {
    vision::use_one_core();  // of the plain parts, too
    return Dive{};
  }();
  return one;
}

/// Processor time of each turn, for what the mean does not say: half of them, and 99 of 100, are below [ms].
class Turns {
 public:
  explicit Turns(benchmark::State& state) : state_{state} {}
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;
  ~Turns() {
    if (turns_.empty()) return;
    std::sort(turns_.begin(), turns_.end());
    state_.counters["p50"] = turns_[turns_.size() / 2];
    state_.counters["p99"] = turns_[turns_.size() * 99 / 100];
  }
  void begin() { begun_ = now(); }
  void end() { turns_.push_back(now() - begun_); }

 private:
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }

  benchmark::State& state_;
  std::vector<double> turns_;
  double begun_{};
};

std::vector<cv::Mat> greys() {
  std::vector<cv::Mat> all;
  for (const auto& bytes : dive().jpeg) {
    cv::Mat grey, bgr;
    if (vision::decode_jpeg(bytes, false, grey, bgr).empty()) all.push_back(grey);
  }
  return all;
}

void whole(benchmark::State& state, bool with_laser) {
  const Dive& d = dive();
  vision::FrontEnd front_end{d.site, d.lens, with_laser ? std::optional{d.laser} : std::nullopt, {}};
  vision::Picture picture;
  std::size_t i = 0;
  double tags = 0.0;
  Turns turns{state};
  for (auto _ : state) {
    turns.begin();
    const std::size_t k = i % kPictures;
    picture.utime = utime_after(0, static_cast<double>(++i) / 30.0);
    const std::string problem = vision::decode_jpeg(d.jpeg[k], with_laser, picture.grey, picture.bgr);
    benchmark::DoNotOptimize(problem);
    tags += static_cast<double>(front_end.step(picture, d.R_WC[k]).tags.size());
    turns.end();
  }
  state.counters["tags"] = tags / static_cast<double>(state.iterations());
}
void picture_with_laser(benchmark::State& state) { whole(state, true); }
void picture_without_laser(benchmark::State& state) { whole(state, false); }
BENCHMARK(picture_with_laser)->Name("vision/picture: decode, tags, flow, laser")->Unit(benchmark::kMillisecond);
BENCHMARK(picture_without_laser)->Name("vision/picture: decode, tags, flow")->Unit(benchmark::kMillisecond);

void decode(benchmark::State& state, bool colour) {
  cv::Mat grey, bgr;
  std::size_t i = 0;
  const Dive& d = dive();
  Turns turns{state};
  for (auto _ : state) {
    turns.begin();
    const std::string problem = vision::decode_jpeg(d.jpeg[i++ % kPictures], colour, grey, bgr);
    benchmark::DoNotOptimize(problem);
    turns.end();
  }
}
BENCHMARK_CAPTURE(decode, grey, false)->Name("vision/plain: JPEG to grey")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode, colour, true)->Name("vision/plain: JPEG to colour and grey")->Unit(benchmark::kMillisecond);

void plain_tags(benchmark::State& state) {
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_add_family_bits(detector, family, 2);
  detector->quad_decimate = 2.0F;
  const std::vector<cv::Mat> pictures = greys();
  std::size_t i = 0;
  Turns turns{state};
  for (auto _ : state) {
    turns.begin();
    const cv::Mat& grey = pictures[i++ % pictures.size()];
    image_u8_t image{grey.cols, grey.rows, static_cast<int32_t>(grey.step), grey.data};
    zarray_t* found = apriltag_detector_detect(detector, &image);
    benchmark::DoNotOptimize(found);
    apriltag_detections_destroy(found);
    turns.end();
  }
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
}
BENCHMARK(plain_tags)->Name("vision/plain: AprilTag at half resolution")->Unit(benchmark::kMillisecond);

// Features, pyramids, there and back, at half resolution: what optical flow needs of OpenCV.
void plain_flow(benchmark::State& state) {
  std::vector<cv::Mat> halves;
  for (const cv::Mat& grey : greys()) {
    cv::Mat half;
    cv::resize(grey, half, {}, 0.5, 0.5, cv::INTER_AREA);
    halves.push_back(half);
  }
  std::size_t i = 0;
  std::vector<cv::Mat> before, now;
  const cv::Size window{15, 15};
  cv::buildOpticalFlowPyramid(halves[0], before, window, 3);
  std::vector<cv::Point2f> features, found, back;
  std::vector<unsigned char> ok;
  std::vector<float> error;
  cv::goodFeaturesToTrack(halves[0], features, 150, 0.005, 13.6);
  Turns turns{state};
  for (auto _ : state) {
    turns.begin();
    const cv::Mat& half = halves[++i % halves.size()];
    cv::buildOpticalFlowPyramid(half, now, window, 3);
    cv::calcOpticalFlowPyrLK(before, now, features, found, ok, error, window, 3);
    cv::calcOpticalFlowPyrLK(now, before, found, back, ok, error, window, 3);
    cv::goodFeaturesToTrack(half, features, 150, 0.005, 13.6);
    std::swap(before, now);
    turns.end();
  }
}
BENCHMARK(plain_flow)
    ->Name("vision/plain: features, Lucas-Kanade and back, half resolution")
    ->Unit(benchmark::kMillisecond);

}  // namespace
