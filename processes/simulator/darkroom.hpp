// From exposures to pictures on CAMERA.
#pragma once

#include <optional>

#include "common/samples/vision.hpp"
#include "common/simulation/simulator.hpp"
#include "common/vision/renderer.hpp"

namespace fathom::simulator {

class Darkroom {
 public:
  /// `config`: the section `simulator`; its `sensors: camera: look` says how the water looks.
  Darkroom(const model::Vehicle& vehicle, const model::Site& site, const Config& config,
           const simulation::Setup& setup);
  /// A spoilt exposure is a black picture.
  [[nodiscard]] Camera develop(const simulation::Exposure& exposure);

 private:
  Utime origin_;
  std::optional<vision::Renderer> renderer_;
};

}  // namespace fathom::simulator
