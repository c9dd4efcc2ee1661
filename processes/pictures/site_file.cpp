#include "processes/pictures/site_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
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

std::string text(const char* format, auto... values) {
  std::array<char, 256> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

// What of a site's file is not written anew, comments and all. A block begins with a key at the line's beginning; lines
// of comment right above belong to it.
std::string kept_of(const std::string& original) {
  static const std::set<std::string> written{"site", "tag_search", "camera", "tags", "poster"};
  std::ifstream in{original};
  std::string kept, waiting;
  bool keep = false;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') {
      waiting += line + "\n";
      continue;
    }
    const auto colon = line.find(':');
    if (line.front() != ' ' && line.front() != '-' && colon != std::string::npos)
      keep = !written.contains(line.substr(0, colon));
    if (keep) kept += waiting + line + "\n";
    waiting.clear();
  }
  return kept;
}

}  // namespace

std::string lens_keys(const model::Lens& lens) {
  const bool fisheye = lens.kind == model::Lens::Kind::kFisheye;
  const auto& k = lens.distortion;
  std::string keys = text("width: %d, height: %d, focal: %.3f %.3f, centre: %.3f %.3f", lens.width, lens.height,
                          lens.fx, lens.fy, lens.cx, lens.cy);
  keys += text(", distortion: %.7f %.7f %.7f %.7f", k[0], k[1], k[2], k[3]);
  keys += fisheye ? ", lens: fisheye" : text(" %.7f", k[4]);
  if (lens.port) {
    keys += text(", port: {distance: %.6f m, thickness: %.6f m, index_window: %.5f, index_water: %.5f}",
                 lens.port->distance, lens.port->thickness, lens.port->index_window, lens.port->index_water);
  }
  return keys;
}

void write_site(const std::string& path, const vision::Calibration& calibration, const std::string& source,
                const std::string& original) {
  const model::Site& site = calibration.site;
  std::string out = text(
      "# Written by fathom calibrate from %s: %d pictures, %d corners, reprojection %.3f px before, %.3f px after\n"
      "# (medians).\n",
      std::filesystem::path{source}.filename().c_str(), calibration.n_views, calibration.n_corners,
      calibration.before.median, calibration.after.median);
  out += "site: " + site.name + "\n";
  if (!original.empty()) out += kept_of(original);
  out += "tag_search: {families: [";
  for (std::size_t i = 0; i < site.search.families.size(); ++i) out += (i > 0 ? ", " : "") + site.search.families[i];
  out += text("], map_sigma: %.1f mm", 1e3 * map_error(calibration));
  if (site.search.least_margin) out += text(", least_margin: %g", *site.search.least_margin);
  out += "}\ncamera: {" + lens_keys(*site.lens) + "}\ntags:\n";
  for (const model::Tag& tag : site.tags) {
    const Eigen::Vector3d e = euler_from_rotation(tag.R_WT) * 180.0 / M_PI;
    out += text("  - {id: %d, size: %.6f m, position: %.5f %.5f %.5f m, rotation: %.4f %.4f %.4f deg", tag.id, tag.size,
                tag.p_WT.x(), tag.p_WT.y(), tag.p_WT.z(), e.x(), e.y(), e.z());
    if (!tag.family.empty()) out += ", family: " + tag.family;
    if (tag.own_number) out += text(", number: %d", *tag.own_number);
    out += "}\n";
  }
  std::ofstream file{path};
  if (!file) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
  file << out;
  file.close();
  if (!file) throw InputError(path + ": writing failed; is the disk full?");
  static_cast<void>(model::Site::load_for_pictures(path));  // what follows shall not be the first to find it unreadable
}

}  // namespace fathom::pictures
