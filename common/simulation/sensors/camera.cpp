// The camera itself: when its shutter opened and where it was. What the picture shows is the renderer's.
#include "common/base/config.hpp"
#include "common/simulation/camera_view.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class CameraSensor final : public Sensor {
 public:
  explicit CameraSensor(const model::CameraMount& camera) : camera_{camera} {}

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const CameraView view{camera_, moment};
    samples.emplace_back(Exposure{.utime = moment.utime, .camera = camera_.name, .p_WC = view.p_WC, .R_WC = view.R_WC});
  }

 private:
  model::CameraMount camera_;
};

}  // namespace

std::unique_ptr<Sensor> make_camera(const Config& config, const Surroundings& around) {
  if (around.vehicle->mounts.cameras.empty()) config.fail("rate", "the vehicle file has no sensors.cameras");
  // How the water looks is the renderer's, which reads these keys in earnest.
  if (config.has("look")) {
    const Config look = config.section("look");
    for (const std::string& key : look.keys()) static_cast<void>(look.text(key));
  }
  return std::make_unique<CameraSensor>(around.vehicle->mounts.cameras.front());
}

}  // namespace fathom::simulation
