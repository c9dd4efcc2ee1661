// Rendered pictures as JPEG files, as a diver's camera leaves them.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision::test_scene {

/// 0.jpg, 1.jpg, ... every 0.1 s; `pose_at` tells the camera's pose in each.
template <class PoseAt>
void write_pictures(Renderer renderer, const std::string& folder, int n, PoseAt pose_at) {
  constexpr int kQuality = 92;
  std::filesystem::create_directories(folder);
  for (int i = 0; i < n; ++i) {
    const auto bytes = encode_jpeg(renderer.step(0.1 * i, pose_at(i)), kQuality);
    std::ofstream out{folder + "/" + std::to_string(i) + ".jpg", std::ios::binary};
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
}

}  // namespace fathom::vision::test_scene
