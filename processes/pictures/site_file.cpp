#include "processes/pictures/site_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::pictures {

namespace {

constexpr double kLeast = 2e-3;  // m

// What of the corners' errors is left, at the distance they were seen from: an error of the map as far as gates care.
double map_error(const vision::Calibration& calibration) {
  std::vector<double> distances;
  for (const vision::Residual& each : calibration.after.residuals) {
    const model::Tag* tag = calibration.site.tag(each.tag);
    distances.push_back((calibration.after.poses[each.view].p_WC - tag->p_WT).norm());
  }
  if (distances.empty()) return kLeast;
  std::sort(distances.begin(), distances.end());
  return std::max(kLeast, calibration.after.high * distances[distances.size() / 2] / calibration.site.lens->focal());
}

}  // namespace

void write_site(const std::string& path, const vision::Calibration& calibration, const std::string& source) {
  std::FILE* out = std::fopen(path.c_str(), "w");
  if (out == nullptr) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
  const model::Site& site = calibration.site;
  const model::Lens& lens = *site.lens;
  std::fprintf(out,
               "# Written by fathom calibrate from %s: %d pictures, %d corners, reprojection %.3f px before, %.3f px "
               "after (medians).\n",
               std::filesystem::path{source}.filename().c_str(), calibration.n_views, calibration.n_corners,
               calibration.before.median, calibration.after.median);
  std::fprintf(out, "site: %s\ntag_search: {families: [", site.name.c_str());
  for (std::size_t i = 0; i < site.search.families.size(); ++i) {
    std::fprintf(out, "%s%s", i > 0 ? ", " : "", site.search.families[i].c_str());
  }
  std::fprintf(out, "], map_sigma: %.1f mm", 1e3 * map_error(calibration));
  if (site.search.least_margin) std::fprintf(out, ", least_margin: %g", *site.search.least_margin);
  std::fprintf(out, "}\ncamera:\n  width: %d\n  height: %d\n  focal: %.3f %.3f\n  centre: %.3f %.3f\n", lens.width,
               lens.height, lens.fx, lens.fy, lens.cx, lens.cy);
  if (lens.kind == model::Lens::Kind::kFisheye) std::fprintf(out, "  lens: fisheye\n");
  const auto& k = lens.distortion;
  std::fprintf(out, "  distortion: %.7f %.7f %.7f %.7f", k[0], k[1], k[2], k[3]);
  std::fprintf(out, lens.kind == model::Lens::Kind::kFisheye ? "\n" : " %.7f\n", k[4]);
  if (lens.port) {
    std::fprintf(out, "  port: {distance: %.6f m, thickness: %.6f m, index_window: %.5f, index_water: %.5f}\n",
                 lens.port->distance, lens.port->thickness, lens.port->index_window, lens.port->index_water);
  }
  std::fprintf(out, "tags:\n");
  for (const model::Tag& tag : site.tags) {
    const Eigen::Vector3d e = euler_from_rotation(tag.R_WT) * 180.0 / M_PI;
    std::fprintf(out, "  - {id: %d, size: %.6f m, position: %.5f %.5f %.5f m, rotation: %.4f %.4f %.4f deg}\n", tag.id,
                 tag.size, tag.p_WT.x(), tag.p_WT.y(), tag.p_WT.z(), e.x(), e.y(), e.z());
  }
  if (std::fclose(out) != 0) throw InputError(path + ": writing failed; is the disk full?");
}

}  // namespace fathom::pictures
