// From exposures to pictures on CAMERA.
#pragma once

#include <optional>
#include <string>

#include "common/link/server.hpp"
#include "common/samples/vision.hpp"
#include "common/simulation/simulator.hpp"
#include "common/vision/renderer.hpp"

namespace fathom::simulator {

class Darkroom {
 public:
  /// `config`: the section `simulator`; its `sensors: camera: look` says how the water looks.
  Darkroom(const model::Vehicle& vehicle, const model::Site& site, const Config& config,
           const simulation::Setup& setup);
  /// From now on whoever connects there ("tcp:PORT") gets the pictures as they come, one JPEG behind the other.
  void open_line(const std::string& at) { line_.emplace(at); }
  [[nodiscard]] bool has_line() const { return line_.has_value(); }
  void begin_at(Utime origin) { origin_ = origin; }
  /// Virtual time is the host's then. Every picture is as old when it goes: the camera's latency and 8 ms.
  void send(const simulation::Exposure& exposure);
  /// A spoilt exposure is a black picture.
  [[nodiscard]] Camera develop(const simulation::Exposure& exposure);

 private:
  Utime origin_;
  double age_{};  // s, of pictures on the line
  std::optional<vision::Renderer> renderer_;
  std::optional<link::Server> line_;
};

}  // namespace fathom::simulator
