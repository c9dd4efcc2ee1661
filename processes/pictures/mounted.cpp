#include "processes/pictures/mounted.hpp"

#include "common/base/config.hpp"
#include "common/base/error.hpp"

namespace fathom::pictures {

Mounted mounted(const std::string& vehicle, const std::string& camera) {
  Mounted result;
  if (vehicle.empty()) {
    if (!camera.empty()) throw InputError("--camera names one of a vehicle's cameras; state --vehicle too");
    return result;
  }
  const Config file = Config::load(vehicle);
  if (!file.has("sensors")) throw InputError(vehicle + ": has no section 'sensors'");
  const model::Mounts mounts = model::Mounts::from(file.section("sensors"));
  if (mounts.cameras.empty()) throw InputError(vehicle + ": has no cameras");
  const model::CameraMount* found = camera.empty() ? &mounts.cameras.front() : mounts.camera(camera);
  if (found == nullptr) throw InputError(vehicle + ": no camera is called '" + camera + "'");
  result.name = found->name;
  result.lens = found->lens;
  result.R_BC = found->mount.R_BS;
  if (mounts.laser && mounts.laser->camera == found->name) result.laser = mounts.laser;
  return result;
}

}  // namespace fathom::pictures
