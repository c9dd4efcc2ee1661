// fathom calibrate: lens and map of tags from a sequence of pictures, by bundle adjustment; what is left of every
// corner before and after, in numbers and in a picture.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/model/site.hpp"
#include "common/pictures/source.hpp"
#include "common/runtime/command_line.hpp"
#include "common/vision/calibration.hpp"
#include "common/vision/calibration_drawing.hpp"
#include "processes/pictures/commands.hpp"
#include "processes/pictures/mounted.hpp"
#include "processes/pictures/site_file.hpp"

namespace fathom::pictures {
namespace {

struct CalibrateOptions {
  std::string source, site, out, picture, vehicle, camera, what{"all"};
  int distortion{2}, every{1}, held_out{0};
  double map_sigma{0.0}, focal{0.0}, focal_sigma{0.1};
  bool not_flat{false};
  std::vector<std::string> families, sizes;
};

constexpr const char *kPictures = "pictures", *kAdjustment = "adjustment";  // phases of the work

std::vector<vision::View> look(const CalibrateOptions& options, model::Site& site, ProgressLine& line) {
  const Progress progress = line.progress();
  vision::TagDetector detector{{.families = site.search.families, .decimation = 1.0, .coarser = true}};
  const auto source = open(options.source, 0.0);
  std::vector<vision::View> views;
  int count = 0;
  progress.expect(kPictures, source->to_come());
  progress.expect(kAdjustment, 1, 0.2 * source->to_come());
  progress.begin(kPictures, "finding tags");
  while (auto frame = source->next()) {
    progress.done(kPictures);
    if (count++ % options.every != 0) continue;
    if (!frame->problem.empty()) {
      line.say("fathom: " + frame->problem + "; the picture is left out");
      continue;
    }
    const cv::Mat grey = in_grey(frame->picture);
    if (!site.lens) {
      if (options.focal <= 0.0) {
        throw InputError((options.site.empty() ? options.source : options.site) +
                         ": no lens to begin with; state 'camera' in the site's file, or --focal in pixels");
      }
      site.lens = model::Lens{.width = grey.cols, .height = grey.rows, .fx = options.focal, .fy = options.focal};
      site.lens->cx = 0.5 * (grey.cols - 1);
      site.lens->cy = 0.5 * (grey.rows - 1);
    }
    if (grey.cols != site.lens->width || grey.rows != site.lens->height) {
      const std::string problem = frame->name + ": " + std::to_string(grey.cols) + " x " + std::to_string(grey.rows) +
                                  " pixels; the lens is for " + std::to_string(site.lens->width) + " x " +
                                  std::to_string(site.lens->height);
      if (views.empty()) throw InputError(problem);
      line.say("fathom: " + problem + "; the picture is left out");
      continue;
    }
    views.push_back({frame->name, detector.step(grey)});
  }
  progress.expect(kPictures, 0);
  if (const std::string remark = source->remark(); !remark.empty()) line.say("fathom: " + remark);
  return views;
}

void print(const char* what, const vision::Reprojection& error) {
  std::printf("%-30s median %.3f px, 95 %% below %.3f px (%zu pictures with two tags or more)\n", what, error.median,
              error.high, error.per_view.size());
}

void run_calibrate(const CalibrateOptions& options) {
  model::Site site;
  if (!options.site.empty()) site = model::Site::load_for_pictures(options.site);
  if (!options.families.empty()) site.look_for(options.families);
  if (options.map_sigma > 0.0) site.search.map_sigma = options.map_sigma;  // what may disagree with the map, too
  if (site.name.empty()) site.name = "surveyed";
  if (const std::string doubts = site.doubts(); !doubts.empty())
    std::fprintf(stderr, "fathom: %s: %s\n", options.site.c_str(), doubts.c_str());
  const Mounted camera = mounted(options.vehicle, options.camera);
  if (camera.lens) site.lens = camera.lens;
  const bool site_has_lens = site.lens.has_value();
  vision::check_map(site);
  const vision::TagSizes sizes = vision::TagSizes::parse(options.sizes);
  sizes.check_against(site);
  std::optional<ProgressLine> line{std::in_place};
  std::vector<vision::View> views = look(options, site, *line), held;
  if (options.held_out > 1) {
    std::vector<vision::View> kept;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const bool out = i % static_cast<std::size_t>(options.held_out) == 0;
      (out ? held : kept).push_back(std::move(views[i]));
    }
    views = std::move(kept);
  }
  vision::CalibrationSettings settings{.lens = options.what != "map",
                                       .distortion = options.distortion,
                                       .map = options.what != "lens",
                                       .flat = !options.not_flat,
                                       .map_sigma = site.search.map_sigma,
                                       .given = site_has_lens,
                                       .focal_sigma = options.focal_sigma,
                                       .sizes = sizes};
  line->progress().begin(kAdjustment, "adjusting " + options.what);
  const vision::Calibration result = vision::calibrate(site, views, settings);
  line.reset();
  std::printf("%d pictures, %d corners; %s\n", result.n_views, result.n_corners,
              result.converged ? "converged" : ("not converged: " + result.message).c_str());
  int seen = 0;
  for (const vision::View& view : views) {
    for (const vision::TagSighting& tag : view.tags)
      seen += site.tag(tag.family, tag.id) != nullptr && std::ranges::find(tag.sound, false) == tag.sound.end() ? 4 : 0;
  }
  if (result.n_corners < seen * 4 / 5) {
    std::printf(
        "of %d corners of tags in the map %d were left out: they contradict it or each other; is it known no better "
        "than --map-sigma?\n",
        seen, seen - result.n_corners);
  }
  if (!result.before.per_view.empty()) print("before", result.before);
  print("after", result.after);
  if (!held.empty()) {
    const vision::Reprojection before = vision::reproject(site, held);
    if (!before.per_view.empty()) print("held out, before", before);
    print("held out, after", vision::reproject(result.site, held));
  }
  const model::Lens& lens = *result.site.lens;
  std::printf("focal %.2f %.2f px (sigma %.2f %.2f), centre %.2f %.2f px (sigma %.2f %.2f)\n", lens.fx, lens.fy,
              result.lens_sigma[0], result.lens_sigma[1], lens.cx, lens.cy, result.lens_sigma[2], result.lens_sigma[3]);
  const double moved = std::abs(lens.focal() / site.lens->focal() - 1.0);
  if (result.undetermined_focal) {
    std::printf(
        "these pictures do not determine the focal length: %.0f px would explain them as well; it stays as given\n",
        *result.undetermined_focal);
  } else if (settings.lens && (moved > 0.25 || result.lens_sigma[0] > 0.1 * lens.fx)) {
    std::printf("these pictures hardly determine the focal length: add some from other distances and tilts\n");
  }
  std::printf("distortion %.5f %.5f %.5f %.5f %.5f\n", lens.distortion[0], lens.distortion[1], lens.distortion[2],
              lens.distortion[3], lens.distortion[4]);
  if (const std::string doubts = vision::lens_doubts(lens); !doubts.empty()) std::printf("%s\n", doubts.c_str());
  for (const model::Tag& tag : result.site.tags) {
    const model::Tag* was = site.tag(site.family_of(tag), tag.id);
    if (site.search.families.size() > 1) std::printf("%s ", site.family_of(tag).c_str());
    std::printf("tag %-4d %9.4f %9.4f %9.4f m", tag.id, tag.p_WT.x(), tag.p_WT.y(), tag.p_WT.z());
    if (was != nullptr) std::printf(", moved %.1f mm", 1e3 * (tag.p_WT - was->p_WT).norm());
    std::printf("\n");
  }
  if (!result.converged)
    throw InputError("the adjustment did not converge: nothing is written; is the lens to begin with far off?");
  write_site(options.out, result, options.source, options.site);
  if (settings.lens) {
    std::printf("for %s: %s\n",
                camera.lens ? (options.vehicle + ", camera '" + camera.name + "'").c_str() : "a vehicle file",
                lens_keys(lens).c_str());
  }
  if (!options.picture.empty()) write(options.picture, vision::draw_calibration(result, site));
  std::printf("written: %s%s%s\n", options.out.c_str(), options.picture.empty() ? "" : ", ", options.picture.c_str());
}

}  // namespace

void add_calibrate(runtime::CommandLine& app) {
  auto options = std::make_shared<CalibrateOptions>();
  runtime::CommandLine* command = app.add_subcommand("calibrate", "lens and map of tags from a sequence of pictures");
  command->add_option("pictures", options->source, "folder of pictures, or a video")->required();
  command->add_option("--site", options->site, "what is known: tags or board, a lens to begin with");
  command->add_option("--vehicle", options->vehicle, "vehicle file whose camera's lens is the one to begin with");
  command->add_option("--camera", options->camera, "which of the vehicle's cameras; left out: the first");
  command->add_option("--out", options->out, "site file to write: lens and tags as adjusted")->required();
  command->add_option("--picture", options->picture, "PNG: what is left of every corner, and the map");
  command
      ->add_option("--adjust", options->what, "all; lens: the tags are a board, known exactly; map: the lens is known")
      ->one_of({"all", "lens", "map"});
  command->add_option("--distortion", options->distortion, "coefficients that are adjusted: 0, 2, 4 or 5")
      ->one_of({0, 2, 4, 5});
  command
      ->add_option("--size", options->sizes,
                   "m, edge of tags that are not in the map: of all (0.15), of a family (16h5=0.15) or of one tag "
                   "(16h5:3=0.12), more than once if wanted; left out: they stay outside")
      ->allow_extra_args(false);
  command->add_option("--map-sigma", options->map_sigma, "m, how well the map is known; left out: the site's")
      ->positive();
  command->add_option("--focal", options->focal, "px, a focal length to begin with")->positive();
  command->add_option("--focal-sigma", options->focal_sigma, "how well it is known, as a share of it (0.1)")
      ->positive();
  command->add_option("--every", options->every, "use every n-th picture")->positive();
  command->add_option("--hold-out", options->held_out, "keep every n-th picture back and judge by it")
      ->within(2, 1'000'000);
  command->add_option("--families", options->families, "families of tags in place of the site's");
  command->add_flag("--not-flat", options->not_flat, "the tags do not lie in one plane");
  command->callback([options] { run_calibrate(*options); });
}

}  // namespace fathom::pictures
