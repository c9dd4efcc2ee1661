#include "processes/fathom/mended_map.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/tables/header_units.hpp"
#include "common/tables/import.hpp"
#include "common/tables/map_writer.hpp"
#include "common/tables/writer.hpp"

namespace fathom::tool {
namespace {

using estimation::Corrections;
using estimation::HeadingSense;
using estimation::QuaternionForm;
using estimation::VectorFrame;

constexpr double kSameHeading = 0.5 * kDegree;
constexpr double kNoTurn = 0.05;  // of a matrix: less is no other axes, but small angles that a map does not hold

/// The turn of whole axes that a matrix holds, small angles left out.
Eigen::Matrix3d whole_of(const Eigen::Matrix3d& axes) { return axes.array().round().matrix(); }

void mend_attitude(tables::AttitudeColumns& attitude, const Corrections& c) {
  const bool last = c.quaternion == QuaternionForm::kScalarLast || c.quaternion == QuaternionForm::kScalarLastInverse;
  const bool inverse = c.quaternion == QuaternionForm::kInverse || c.quaternion == QuaternionForm::kScalarLastInverse;
  // Columns stand as w x y z were read; what was read as z is w.
  if (!attitude.euler && last) std::ranges::rotate(attitude.group.columns, attitude.group.columns.begin() + 3);
  if (inverse) attitude.world_to_body = !attitude.world_to_body;
  if (c.heading_sense != HeadingSense::kAsRead) {
    attitude.heading_sign = -attitude.heading_sign;
    attitude.heading_offset =
        (c.heading_sense == HeadingSense::kFromEast ? 90.0 * kDegree : 0.0) - attitude.heading_offset;
  }
  attitude.world_to_house = c.attitude_world * attitude.world_to_house;
  // Only whole turns of axes; small angles are a mount's.
  const Eigen::Matrix3d whole = whole_of(c.attitude_axes);
  if (std::abs(whole.determinant() - 1.0) < 1e-9) attitude.body_to_house = whole.transpose() * attitude.body_to_house;
  attitude.heading_offset = std::remainder(attitude.heading_offset + c.heading, 360.0 * kDegree);
}

bool is_whole(const Eigen::Matrix3d& matrix) {
  return (matrix - whole_of(matrix)).norm() < kNoTurn && !whole_of(matrix).isIdentity();
}

}  // namespace

std::vector<std::string> mend(tables::ColumnMap& map, std::span<const Corrections> corrections) {
  std::vector<std::string> notes;
  if (corrections.empty()) return notes;
  const Corrections& c = corrections.front();
  for (const Corrections& other : corrections) {
    const bool same = other.quaternion == c.quaternion && other.heading_sense == c.heading_sense &&
                      other.attitude_world == c.attitude_world &&
                      whole_of(other.attitude_axes) == whole_of(c.attitude_axes) &&
                      other.position_axes == c.position_axes && other.position_scale == c.position_scale &&
                      other.velocity_frame == c.velocity_frame && other.velocity_world == c.velocity_world &&
                      other.rates_frame == c.rates_frame && other.rates_world == c.rates_world &&
                      other.dvl.base == c.dvl.base && other.gyro.base == c.gyro.base &&
                      std::abs(std::remainder(other.heading - c.heading, 360.0 * kDegree)) < kSameHeading;
    if (!same)
      throw InputError(
          "--write-map: the recordings need different maps (a heading zeroed by each run, say); check each "
          "by itself and give it its own");
  }
  if (map.pose_capture && map.pose_capture->position) {
    tables::ColumnGroup& position = *map.pose_capture->position;
    position.to_house = c.position_axes * position.to_house;
    if (!map.pose_capture->geodetic) {
      position.factor *= c.position_scale;
    } else if (c.position_scale != 1.0) {
      notes.emplace_back("a map scales no latitudes and longitudes; the position's scale stays with the sensor check");
    }
  }
  if (map.pose_capture && map.pose_capture->attitude) {
    mend_attitude(*map.pose_capture->attitude, c);
  } else if (map.ahrs && map.ahrs->attitude) {
    mend_attitude(*map.ahrs->attitude, c);
  }
  if (map.dvl && map.dvl->course_factor == 0.0) {
    if (c.velocity_frame == VectorFrame::kWorld) {
      map.dvl->in_world = true;
      map.dvl->velocity.to_house = c.velocity_world * map.dvl->velocity.to_house;
    }
    if (is_whole(c.dvl.base)) map.dvl->velocity.to_house = c.dvl.base * map.dvl->velocity.to_house;
  }
  if (map.ahrs && map.ahrs->rates) {
    if (c.rates_frame == VectorFrame::kWorld) {
      map.ahrs->rates_in_world = true;
      map.ahrs->rates->to_house = c.rates_world * map.ahrs->rates->to_house;
    }
    map.ahrs->euler_rates = map.ahrs->euler_rates || c.rates_frame == VectorFrame::kEulerRates;
    if (is_whole(c.gyro.base)) map.ahrs->rates->to_house = c.gyro.base * map.ahrs->rates->to_house;
  }
  if (c.pose_shift != 0.0 || c.gyro_shift != 0.0 || c.dvl_shift != 0.0 || c.position_late != 0.0)
    notes.emplace_back("a map holds no delays; they stay with the sensor check");
  const auto small = [](const estimation::SensorFault& fault) {
    return !fault.rotation.isIdentity() || !fault.scale.isOnes() || !fault.bias.isZero() || !fault.lever.isZero();
  };
  if (small(c.gyro) || small(c.dvl) || small(c.accelerometer))
    notes.emplace_back("a map holds no scales, offsets, small turns and lever arms; they stay with the sensor check");
  return notes;
}

std::vector<std::string> write_mended_map(const std::string& path, const std::string& map,
                                          const std::vector<std::string>& runs,
                                          std::span<const Corrections> corrections) {
  tables::ColumnMap mended;
  if (!map.empty()) {
    mended = tables::ColumnMap::load(map);
  } else {
    const auto table = std::ranges::find_if(runs, [](const std::string& run) { return run.ends_with(".csv"); });
    if (table == runs.end())
      throw InputError("--write-map needs the tables (.csv), or the map with which they were imported (--map)");
    tables::CsvTable columns = tables::read_csv(*table);
    static_cast<void>(tables::to_si(columns));
    mended = tables::canonical_map(columns);
  }
  std::vector<std::string> notes = mend(mended, corrections);
  tables::write_file(path, tables::to_yaml(mended));
  return notes;
}

}  // namespace fathom::tool
