// fathom track: the front end of the vision process over recorded pictures, without LCM.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/site.hpp"
#include "common/pictures/source.hpp"
#include "common/runtime/command_line.hpp"
#include "common/vision/drawing.hpp"
#include "common/vision/threads.hpp"
#include "processes/pictures/commands.hpp"
#include "processes/pictures/mounted.hpp"
#include "processes/pictures/track_tables.hpp"

namespace fathom::pictures {
namespace {

struct TrackOptions {
  std::string source, site, csv, drawings, vehicle, camera, config;
  double rate{0.0};
  std::vector<std::string> families;
};

class Summary {
 public:
  void add(const vision::Sight& sight) {
    ++pictures_;
    for (const vision::TagSighting& tag : sight.tags) ++verdicts_[name(tag.verdict)];
    if (sight.picture != vision::PictureState::kGood) ++states_[name(sight.picture)];
    if (sight.fix && sight.fix->ambiguous) ++ambiguous_;
    if (sight.fix && !sight.fix->ambiguous) {
      ++poses_;
      if (sight.fix->n_tags > 1) errors_.push_back(sight.fix->rms);
    }
    velocities_ += sight.v_C ? 1 : 0;
    flows_ += sight.flow.state == vision::FlowState::kValid ? 1 : 0;
    if (sight.laser && sight.laser->state == vision::LaserState::kFound) ++dots_;
  }
  void add_unread(const std::string& problem) {
    ++pictures_;
    ++unread_;
    constexpr int kTold = 10;
    if (unread_ <= kTold) std::fprintf(stderr, "fathom: %s; the picture is left out\n", problem.c_str());
  }
  [[nodiscard]] bool none_read() const { return pictures_ == unread_; }
  void print(bool has_lens, bool has_map, bool has_laser) {
    std::printf("%-34s %d\n", "pictures", pictures_);
    if (unread_ > 0) std::printf("%-34s %d\n", "  that could not be read", unread_);
    for (const auto& [state, count] : states_) std::printf("  %-32s %d\n", state.c_str(), count);
    for (const auto& [verdict, count] : verdicts_) std::printf("tags %-29s %d\n", verdict.c_str(), count);
    if (verdicts_.empty()) std::printf("%-34s 0\n", "tags");
    if (!has_lens) std::printf("no calibration: detections alone (key 'camera' of the site, or --vehicle)\n");
    if (!has_map) std::printf("no map of tags: no pose (key 'tags' or 'poster' of the site)\n");
    if (!has_lens || !has_map) return;
    std::printf("%-34s %d\n", "poses of the camera", poses_);
    if (ambiguous_ > 0) std::printf("%-34s %d\n", "poses ambiguous, not told", ambiguous_);
    if (!errors_.empty()) {
      std::sort(errors_.begin(), errors_.end());
      std::printf("%-34s median %.3f, 95 %% below %.3f\n", "reprojection, two tags or more [px]",
                  errors_[errors_.size() / 2], errors_[errors_.size() * 95 / 100]);
    }
    std::printf("%-34s %d (%d metric)\n", "flows valid", flows_, velocities_);
    if (has_laser) std::printf("%-34s %d\n", "laser dots", dots_);
  }

 private:
  int pictures_{}, unread_{}, poses_{}, ambiguous_{}, flows_{}, velocities_{}, dots_{};
  std::map<std::string, int> verdicts_, states_;
  std::vector<double> errors_;
};

bool differ(const model::Lens& a, const model::Lens& b) {
  constexpr double kSame = 1e-3;  // px, as files round
  return a.kind != b.kind || a.width != b.width || a.height != b.height || std::abs(a.fx - b.fx) > kSame ||
         std::abs(a.fy - b.fy) > kSame || std::abs(a.cx - b.cx) > kSame || std::abs(a.cy - b.cy) > kSame ||
         a.distortion != b.distortion || a.port.has_value() != b.port.has_value();
}

std::string drawing_name(const std::string& folder, const std::string& frame) {
  return (std::filesystem::path{folder} / (std::filesystem::path{frame}.stem().string() + ".jpg")).string();
}

void run_track(const TrackOptions& options) {
  vision::use_one_core();
  model::Site site;
  if (!options.site.empty()) site = model::Site::load_for_pictures(options.site);
  if (!options.families.empty()) site.look_for(options.families);
  const Mounted camera = mounted(options.vehicle, options.camera);
  std::optional<model::Lens> lens = camera.lens ? camera.lens : site.lens;
  if (camera.lens && site.lens && differ(*camera.lens, *site.lens)) {
    std::fprintf(stderr, "fathom: %s and %s state different lenses; that of the vehicle file is used\n",
                 options.vehicle.c_str(), options.site.c_str());
  }
  vision::FrontEndSettings settings;
  // Recorded pictures can wait: search at every and flow at full resolution, unless the configuration says otherwise.
  settings.detector.decimation = 1.0;
  settings.detector.coarser = true;
  settings.flow.reduction = 1.0;
  if (!options.config.empty()) {
    const Config file = Config::load(options.config);
    if (file.has("vision")) settings = vision::FrontEndSettings::from(file.section("vision"));
  }
  settings.detector.families = site.search.families;
  if (const std::string doubts = site.doubts(); !doubts.empty())
    std::fprintf(stderr, "fathom: %s: %s\n", options.site.c_str(), doubts.c_str());
  const auto source = open(options.source, options.rate);
  if (lens && lens->undistorted()) {
    std::fprintf(stderr, "fathom: the lens has no distortion; if nobody has calibrated it: fathom calibrate\n");
  }
  if (const std::string doubts = lens ? vision::lens_doubts(*lens) : std::string{}; !doubts.empty())
    std::fprintf(stderr, "fathom: %s\n", doubts.c_str());
  vision::FrontEnd front_end{site, lens, camera.laser, settings};
  TrackTables tables{options.csv, camera.R_BC};
  if (!options.drawings.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.drawings, error);
    if (error) throw InputError(options.drawings + ": this folder cannot be made");
  }
  Summary summary;
  bool told_size = false;
  while (auto frame = source->next()) {
    if (!frame->problem.empty()) {
      summary.add_unread(frame->problem);
      tables.write_unread(frame->name, frame->time);
      continue;
    }
    vision::Picture picture{.utime = utime_after(0, frame->time), .grey = in_grey(frame->picture)};
    picture.halved_colour = frame->halved_colour;
    if (frame->picture.channels() == 3) picture.bgr = frame->picture;
    vision::Sight sight = front_end.step(picture, std::nullopt);
    if (sight.picture == vision::PictureState::kOtherSize && !told_size) {
      told_size = true;
      std::fprintf(stderr, "fathom: %s is %d x %d, the calibration is for %d x %d: such pictures give no measurement\n",
                   frame->name.c_str(), picture.grey.cols, picture.grey.rows, lens->width, lens->height);
    }
    if (sight.picture != vision::PictureState::kGood) {  // as the process: nothing is told by a picture that stands
      sight = {.picture = sight.picture, .tags = sight.tags, .flow = {.utime = sight.flow.utime}};
    }
    tables.write(frame->name, frame->time, sight);
    summary.add(sight);
    if (!options.drawings.empty()) write(drawing_name(options.drawings, frame->name), draw(picture, front_end));
  }
  if (const std::string remark = source->remark(); !remark.empty())
    std::fprintf(stderr, "fathom: %s\n", remark.c_str());
  tables.close();
  summary.print(lens.has_value(), !site.tags.empty(), camera.laser.has_value());
  if (summary.none_read()) throw InputError(options.source + ": none of its pictures can be read");
  std::printf("written: %s, %s%s%s\n", options.csv.c_str(), tables.frames_path().c_str(),
              options.drawings.empty() ? "" : ", ", options.drawings.c_str());
}

}  // namespace

void add_track(runtime::CommandLine& app) {
  auto options = std::make_shared<TrackOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("track", "tags, camera pose, velocity and laser range from recorded pictures");
  command->add_option("pictures", options->source, "folder of pictures, or a video")->required();
  command->add_option("--site", options->site, "tags to look for and where they lie, camera; left out: tag36h11 alone");
  command
      ->add_option("--csv", options->csv, "table of detections; a second one, NAME.frames.csv, has a row per picture")
      ->required();
  command->add_option("--pictures", options->drawings, "folder for the pictures with everything drawn in");
  command->add_option("--rate", options->rate, "Hz of the pictures; left out: the video's own, 10 for a folder")
      ->positive();
  command->add_option("--vehicle", options->vehicle, "vehicle file: camera, its mounting, laser");
  command->add_option("--camera", options->camera, "which of the vehicle's cameras; left out: the first");
  command->add_option("--families", options->families, "families of tags in place of the site's");
  command->add_option("--config", options->config, "pipeline whose section 'vision' is used");
  command->callback([options] { run_track(*options); });
}

}  // namespace fathom::pictures
