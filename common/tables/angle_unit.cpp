#include "common/tables/angle_unit.hpp"

#include <cmath>
#include <string>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

constexpr double kStretch = 1.0;  // s of track against which velocities are held
// Shares of the track that the velocities explain, whatever their own scale and a fixed turn of the world: a compass
// that is off must not look like another unit to a vehicle that holds its heading. The wrong unit turns it many times.
constexpr double kNotAsRead = 0.6, kAsMeant = 0.95;
constexpr std::size_t kFewestStretches = 20;
constexpr double kClearlyBetter = 0.5;  // of what velocities along the world's axes leave: angles 57 times too small
                                        // are nearly zero, and would pass for a heading that is not used at all

struct Columns {
  Group position, velocity, angles;
};

/// Share of the horizontal track that velocities explain when headings are multiplied by `unit`.
double explained(const Columns& columns, const Rows& rows, double unit) {
  double track = 0.0, along = 0.0, across = 0.0, travelled = 0.0;
  std::size_t stretches = 0, first = 0;
  bool whole = true;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), from = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k + 1 < rows.index.size(); ++k) {
    const std::size_t row = rows.index[k];
    whole = whole && columns.position.complete(row) && columns.velocity.complete(row) && columns.angles.complete(row);
    if (k == first) from = columns.position.vector(row).head<2>();
    const double heading = unit * columns.angles.scalar_of(2, row);
    const Eigen::Vector3d v = columns.velocity.vector(row);
    sum += seconds_between(rows.utime[k], rows.utime[k + 1]) *
           Eigen::Vector2d{std::cos(heading) * v.x() - std::sin(heading) * v.y(),
                           std::sin(heading) * v.x() + std::cos(heading) * v.y()};
    if (seconds_between(rows.utime[first], rows.utime[k + 1]) < kStretch) continue;
    const std::size_t end = rows.index[k + 1];
    if (whole && columns.position.complete(end)) {
      const Eigen::Vector2d step = columns.position.vector(end).head<2>() - from;
      track += step.squaredNorm();
      along += step.dot(sum);
      across += step.y() * sum.x() - step.x() * sum.y();
      travelled += sum.squaredNorm();
      ++stretches;
    }
    first = k + 1;
    whole = true;
    sum.setZero();
  }
  if (stretches < kFewestStretches || track <= 0.0 || travelled <= 0.0) return 0.0;
  return (along * along + across * across) / (track * travelled);
}

}  // namespace

void check_angle_unit(Resolver& resolve, const ColumnMap& map, const Rows& rows, const CsvTable& table) {
  const AttitudeColumns* attitude = nullptr;
  if (map.pose_capture && map.pose_capture->attitude) attitude = &*map.pose_capture->attitude;
  if (attitude == nullptr && map.ahrs && map.ahrs->attitude) attitude = &*map.ahrs->attitude;
  if (attitude == nullptr || !attitude->euler || attitude->group.columns[2].absent) return;
  if (!map.pose_capture || !map.pose_capture->position || map.pose_capture->geodetic) return;
  if (!map.dvl || map.dvl->in_world || attitude->heading_sign < 0.0) return;
  const ColumnGroup &position = *map.pose_capture->position, &velocity = map.dvl->velocity;
  for (const auto* turn :
       {&attitude->world_to_house, &attitude->body_to_house, &position.to_house, &velocity.to_house}) {
    if (!turn->isIdentity()) return;
  }
  const Columns columns{Group(resolve, position), Group(resolve, velocity), Group(resolve, attitude->group)};
  const double as_read = explained(columns, rows, 1.0);
  if (as_read > kNotAsRead) return;
  const double in_world = explained(columns, rows, 0.0);
  for (const auto& [unit, read, meant] : {std::tuple{kDegree, "rad", "deg"}, std::tuple{1.0 / kDegree, "deg", "rad"}}) {
    const double otherwise = explained(columns, rows, unit);
    if (otherwise < kAsMeant || 1.0 - otherwise > kClearlyBetter * (1.0 - in_world)) continue;
    throw InputError(table.path + ": column '" + attitude->group.columns[2].name + "' is read as " + read +
                     ", but the velocities follow the track only with headings in " + meant + " (" +
                     std::to_string(std::lround(100.0 * otherwise)) + " % of it, as read " +
                     std::to_string(std::lround(100.0 * as_read)) +
                     " %); convert the angles, or state 'unit: " + meant + "' in a map (--map)");
  }
}

}  // namespace fathom::tables
