#include "processes/pictures/track_tables.hpp"

#include <algorithm>
#include <filesystem>

#include "common/base/error.hpp"

namespace fathom::pictures {
namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::FILE* create(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
  return file;
}

std::string beside(const std::string& path) {
  const std::filesystem::path whole{path};
  return (whole.parent_path() / (whole.stem().string() + ".frames" + whole.extension().string())).string();
}

}  // namespace

TrackTables::TrackTables(const std::string& path, const Eigen::Matrix3d& R_BC)
    : path_{path}, frames_path_{beside(path)}, detections_{create(path)}, frames_{create(frames_path_)}, R_BC_{R_BC} {
  std::fputs("frame,family,id,x0_px,y0_px,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px,margin,hamming,verdict,reprojection_px\n",
             detections_.get());
  std::FILE* out = frames_.get();
  std::fputs("frame,time_s,picture,tags_seen,tags_accepted,pose,p_WC_x_m,p_WC_y_m,p_WC_z_m,q_WC_w,q_WC_x,q_WC_y,q_WC_z",
             out);
  constexpr std::array<const char*, 6> kNames{"x", "y", "z", "rx", "ry", "rz"};
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = i; k < 6; ++k) std::fprintf(out, ",cov_%s_%s", kNames[i], kNames[k]);
  }
  std::fputs(
      ",reprojection_px,flow,flow_tracks,flow_agreed,flow_residual_px,rate_x_per_s,rate_y_per_s,rate_z_per_s,"
      "v_x_mps,v_y_mps,v_z_mps,sigma_v_x_mps,sigma_v_y_mps,sigma_v_z_mps,flow_time_s,range_m,laser,laser_x_px,"
      "laser_y_px,laser_range_m,laser_sigma_m\n",
      out);
}

void TrackTables::write_pose(const vision::Sight& sight) {
  std::FILE* out = frames_.get();
  const auto& fix = sight.fix;
  // An ambiguous pose is told as such and not as a pose.
  if (!fix || fix->ambiguous) {
    std::fprintf(out, ",%s", fix ? "ambiguous" : "none");
    for (int i = 0; i < 3 + 4 + 21; ++i) std::fputc(',', out);
    if (fix) {
      std::fprintf(out, ",%.4f", fix->rms);
    } else {
      std::fputc(',', out);
    }
    return;
  }
  const Eigen::Vector3d& p = fix->pose.p_WC;
  const Eigen::Quaterniond q{fix->pose.R_WC};
  std::fprintf(out, ",known,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f", p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index k = i; k < 6; ++k) std::fprintf(out, ",%.6g", fix->covariance(i, k));
  }
  std::fprintf(out, ",%.4f", fix->rms);
}

void TrackTables::write_flow(const vision::Sight& sight) {
  std::FILE* out = frames_.get();
  const vision::Flow& flow = sight.flow;
  std::fprintf(out, ",%s,%d,%d,%.3f", name(flow.state), flow.n_tracks, flow.n_agreed, flow.residual);
  if (flow.state == vision::FlowState::kValid) {
    std::fprintf(out, ",%.6f,%.6f,%.6f", flow.rate.x(), flow.rate.y(), flow.rate.z());
  } else {
    std::fputs(",,,", out);
  }
  if (sight.v_C) {
    const Eigen::Vector3d v = R_BC_ * *sight.v_C;
    const Eigen::Vector3d variance = (R_BC_ * sight.v_covariance * R_BC_.transpose()).diagonal();
    std::fprintf(out, ",%.5f,%.5f,%.5f,%.5f,%.5f,%.5f", v.x(), v.y(), v.z(), std::sqrt(variance.x()),
                 std::sqrt(variance.y()), std::sqrt(variance.z()));
  } else {
    std::fputs(",,,,,,", out);
  }
}

void TrackTables::write(const std::string& frame, double time, const vision::Sight& sight) {
  const std::string named = cell(frame);
  std::FILE* out = detections_.get();
  for (const vision::TagSighting& tag : sight.tags) {
    std::fprintf(out, "%s,%s,%d", named.c_str(), tag.family.c_str(), tag.id);
    // As the library counts: the outer corner of the first pixel is (0, 0).
    for (const Eigen::Vector2d& corner : tag.corners)
      std::fprintf(out, ",%.3f,%.3f", corner.x() + 0.5, corner.y() + 0.5);
    std::fprintf(out, ",%.3f,%d,%s,", tag.margin, tag.hamming, name(tag.verdict));
    if (tag.reprojection >= 0.0 && tag.reprojection < 1e6) std::fprintf(out, "%.3f", tag.reprojection);
    std::fputc('\n', out);
  }
  out = frames_.get();
  const auto accepted = std::count_if(sight.tags.begin(), sight.tags.end(), [](const vision::TagSighting& tag) {
    return tag.verdict == vision::TagVerdict::kAccepted;
  });
  std::fprintf(out, "%s,%.6f,%s,%zu,%ld", named.c_str(), time, name(sight.picture), sight.tags.size(),
               static_cast<long>(accepted));
  write_pose(sight);
  write_flow(sight);
  std::fprintf(out, ",%.6f,", static_cast<double>(sight.flow.utime) * 1e-6);
  if (sight.range) std::fprintf(out, "%.5f", *sight.range);
  std::fprintf(out, ",%s", sight.laser ? name(sight.laser->state) : "none");
  if (sight.laser && sight.laser->state == vision::LaserState::kFound) {
    std::fprintf(out, ",%.3f,%.3f,%.5f,%.5f\n", sight.laser->pixel.x() + 0.5, sight.laser->pixel.y() + 0.5,
                 sight.laser->p_CL.z(), sight.laser->sigma_range);
  } else {
    std::fputs(",,,,\n", out);
  }
}

void TrackTables::write_unread(const std::string& frame, double time) {
  std::fprintf(frames_.get(), "%s,%.6f,unreadable,0,0,none", cell(frame).c_str(), time);
  for (int i = 0; i < 49; ++i) std::fputc(',', frames_.get());
  std::fputc('\n', frames_.get());
}

void TrackTables::close() {
  const bool good = std::fclose(detections_.release()) == 0;
  if (std::fclose(frames_.release()) != 0 || !good) throw InputError(path_ + ": writing failed; is the disk full?");
}

}  // namespace fathom::pictures
