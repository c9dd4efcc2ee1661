// camera_driver: pictures of a camera (of this host or on the network), a video or a folder as JPEG on CAMERA.
#include <fathom_lcm/camera_t.hpp>
#include <memory>

#include "common/base/config.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "processes/camera_driver/device_camera.hpp"
#include "processes/camera_driver/network_camera.hpp"
#include "processes/camera_driver/recorded_pictures.hpp"

using namespace fathom;
using namespace fathom::camera_driver;

namespace {

/// Nothing is opened before the process runs: --interface connects nowhere.
template <class Pictures, class Settings>
void serve(runtime::Process& process, const Settings& settings) {
  std::unique_ptr<Pictures> pictures;
  process.waits_with([&](std::span<const int> descriptors, int milliseconds) {
    if (!pictures) pictures = std::make_unique<Pictures>(process, settings);
    pictures->wait(descriptors, milliseconds);
  });
  process.on_health([&] { return pictures ? pictures->condition() : runtime::Process::Condition{}; });
  process.run();
}

}  // namespace

int main(int argc, char** argv) {
  const runtime::Program program{"camera_driver", "Brings pictures of a camera, a video or a folder to the bus."};
  return runtime::main(program, argc, argv, [](runtime::Process& process) {
    process.publishes<fathom_lcm::camera_t>(wire::kCamera);
    const Config config = process.config();
    if (config.has("device") == config.has("pictures")) {
      config.fail("device", "state either 'device' (a camera) or 'pictures' (a folder or a video)");
    }
    if (config.has("pictures")) return serve<RecordedPictures>(process, RecordedSettings::from(config));
    if (!config.text("device").starts_with("tcp:")) return serve<DeviceCamera>(process, DeviceSettings::from(config));
    serve<NetworkCamera>(
        process,
        NetworkSettings{.camera = config.text("camera"),
                        .endpoint = link::Endpoint::parse(config.text("device"), config.where("device")),
                        .latency = config.not_negative("latency", "s"),
                        .rate = config.has("rate") ? std::optional{config.positive("rate", "Hz")} : std::nullopt});
  });
}
