#include "common/devices/sample_fields.hpp"

#include <array>
#include <cstdio>

namespace fathom::devices {
namespace {

template <std::size_t N>
void add(Fields& fields, const std::array<const char*, N>& names, const Eigen::Vector3d& v, bool there) {
  static_assert(N == 3);
  for (std::size_t i = 0; i < N; ++i) {
    fields.add(names[i], there ? std::optional{v(static_cast<Eigen::Index>(i))} : std::nullopt);
  }
}

template <class T>
const T* as(const Sample& sample) {
  const auto* held = std::get_if<const T*>(&sample);
  return held != nullptr ? *held : nullptr;
}

void describe(const Ahrs* sample, Fields& fields) {
  const Ahrs value = sample != nullptr ? *sample : Ahrs{};
  add(fields, std::array{"SI p [rad/s]", "SI q [rad/s]", "SI r [rad/s]"}, value.w_WB_B, value.has_rates);
  add(fields, std::array{"SI fx [m/s^2]", "SI fy [m/s^2]", "SI fz [m/s^2]"}, value.f_B, value.has_specific_force);
  const std::array q{value.q_WB.w(), value.q_WB.x(), value.q_WB.y(), value.q_WB.z()};
  const std::array names{"SI qw", "SI qx", "SI qy", "SI qz"};
  for (std::size_t i = 0; i < q.size(); ++i) {
    fields.add(names[i], value.has_attitude ? std::optional{q[i]} : std::nullopt);
  }
}

void describe(const Dvl* sample, Fields& fields) {
  const bool valid = sample != nullptr && sample->valid;
  add(fields, std::array{"SI u [m/s]", "SI v [m/s]", "SI w [m/s]"},
      valid ? sample->v_WB_B : Eigen::Vector3d{Eigen::Vector3d::Zero()}, valid);
  const bool altitude = sample != nullptr && sample->altitude > 0.0;
  fields.add("SI altitude [m]", altitude ? std::optional{sample->altitude} : std::nullopt);
  fields.add("SI valid", sample != nullptr ? std::optional<int>{sample->valid ? 1 : 0} : std::nullopt);
}

void describe(const Usbl* sample, Fields& fields) {
  const Usbl value = sample != nullptr ? *sample : Usbl{};
  const bool there = sample != nullptr;
  add(fields, std::array{"SI north [m]", "SI east [m]", "SI down [m]"}, value.p_WB, there);
  fields.add("SI sigma [m]", there ? std::optional{value.sigma.x()} : std::nullopt);
  fields.add("SI valid", there ? std::optional<int>{value.valid ? 1 : 0} : std::nullopt);
}

void describe(const Ranges* sample, const Settings& settings, Fields& fields) {
  const std::size_t count = settings.transponders.empty() ? 8 : settings.transponders.size();
  for (std::size_t i = 0; i < count; ++i) {
    std::array<char, 48> name{};
    std::snprintf(name.data(), name.size(), "SI range%zu [m]", i + 1);
    const bool valid = sample != nullptr && i < sample->range.size() && sample->valid[i] != 0;
    fields.add(name.data(), valid ? std::optional{sample->range[i]} : std::nullopt);
  }
}

void describe(const Loads* sample, const Settings& settings, Fields& fields) {
  const std::size_t count = settings.cells.empty() ? 1 : settings.cells.size();
  for (std::size_t i = 0; i < count; ++i) {
    std::array<char, 48> name{};
    std::snprintf(name.data(), name.size(), "SI load%zu [N]", i + 1);
    const bool there = sample != nullptr && i < sample->load.size();
    fields.add(name.data(), there ? std::optional{sample->load[i]} : std::nullopt);
  }
}

}  // namespace

void describe_sample(const Sample& sample, Kind kind, const Settings& settings, Fields& fields) {
  switch (kind) {
    case Kind::kAhrs:
      return describe(as<Ahrs>(sample), fields);
    case Kind::kDvl:
      return describe(as<Dvl>(sample), fields);
    case Kind::kUsbl:
      return describe(as<Usbl>(sample), fields);
    case Kind::kRanges:
      return describe(as<Ranges>(sample), settings, fields);
    case Kind::kLoads:
      return describe(as<Loads>(sample), settings, fields);
    case Kind::kThrusters: {
      const auto* battery = as<Battery>(sample);
      fields.add("SI voltage [V]", battery != nullptr ? std::optional{battery->voltage} : std::nullopt);
      return;
    }
    case Kind::kDepth: {
      const auto* depth = as<Depth>(sample);
      fields.add("SI z [m]", depth != nullptr ? std::optional{depth->z} : std::nullopt);
    }
  }
}

bool marked_invalid(const Sample& sample) {
  const auto* dvl = as<Dvl>(sample);
  const auto* usbl = as<Usbl>(sample);
  return (dvl != nullptr && !dvl->valid) || (usbl != nullptr && !usbl->valid);
}

}  // namespace fathom::devices
