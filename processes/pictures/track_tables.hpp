// The tables of `fathom track`: a row per detection, and a row per picture.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "common/vision/front_end.hpp"

namespace fathom::pictures {

class TrackTables {
 public:
  /// `path`: of the detections; the pictures' table gets the same name with ".frames" before its end.
  /// `R_BC`: camera's axes in those in which velocity is told.
  TrackTables(const std::string& path, const Eigen::Matrix3d& R_BC);
  void write(const std::string& frame, double time, const vision::Sight& sight);
  /// A picture that could not be read.
  void write_unread(const std::string& frame, double time);
  /// InputError when the disk is full.
  void close();
  [[nodiscard]] const std::string& frames_path() const { return frames_path_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  void write_pose(const vision::Sight& sight);
  void write_flow(const vision::Sight& sight);

  std::string path_, frames_path_;
  File detections_, frames_;
  Eigen::Matrix3d R_BC_;
};

}  // namespace fathom::pictures
