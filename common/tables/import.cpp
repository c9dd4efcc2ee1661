#include "common/tables/import.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/tables/angle_unit.hpp"
#include "common/tables/header_units.hpp"
#include "common/tables/streams/ahrs_import.hpp"
#include "common/tables/streams/beside_imports.hpp"
#include "common/tables/streams/camera_imports.hpp"
#include "common/tables/streams/dvl_import.hpp"
#include "common/tables/streams/plain_imports.hpp"
#include "common/tables/streams/pose_import.hpp"

namespace fathom::tables {

struct TableImport::Streams {
  std::optional<PoseImport> pose;
  std::optional<AhrsImport> ahrs;
  std::optional<DvlImport> dvl;
  std::optional<ThrusterImport> thrusters;
  std::optional<ScalarImport<Depth>> depth;
  std::optional<ScalarImport<Battery>> battery;
  std::optional<UsblImport> usbl;
  std::optional<RangesImport> ranges;
  std::optional<LoadsImport> loads;
  std::optional<TagImport> tags;
  std::optional<FlowImport> flow;
  std::optional<LaserImport> laser;
  std::optional<SignalImport> wind, signals;

  template <typename Use>
  void each(const Use& use) {
    if (pose) use(*pose);
    if (ahrs) use(*ahrs);
    if (dvl) use(*dvl);
    if (thrusters) use(*thrusters);
    if (depth) use(*depth);
    if (battery) use(*battery);
    if (usbl) use(*usbl);
    if (ranges) use(*ranges);
    if (loads) use(*loads);
    if (tags) use(*tags);
    if (flow) use(*flow);
    if (laser) use(*laser);
    if (wind) use(*wind);
    if (signals) use(*signals);
  }
};

TableImport::TableImport(const CsvTable& table, ColumnMap map, const std::optional<SimulatedAxes>& simulated)
    : table_{table}, map_{std::move(map)}, resolve_{table}, streams_{std::make_unique<Streams>()} {
  if (const std::string note = complete_groups(map_, table.path, simulated); !note.empty()) notes_.push_back(note);
  rows_ = read_time(table, resolve_, map_, notes_);
  check_angle_unit(resolve_, map_, rows_, table);
  if (map_.pose_capture) streams_->pose.emplace(resolve_, *map_.pose_capture, rows_, notes_);
  if (map_.ahrs) streams_->ahrs.emplace(resolve_, *map_.ahrs);
  if (map_.dvl) streams_->dvl.emplace(resolve_, *map_.dvl);
  if (map_.thrusters) streams_->thrusters.emplace(resolve_, *map_.thrusters);
  if (map_.depth && map_.depth->group.columns.front().name == "z" && map_.depth->group.columns.front().where.empty())
    notes_.emplace_back("'z' without 'x' and 'y' is read as the column 'depth' (m, positive down)");
  if (map_.depth) streams_->depth.emplace(resolve_, *map_.depth, &Depth::z, "depth");
  if (map_.battery) streams_->battery.emplace(resolve_, *map_.battery, &Battery::voltage, "battery");
  if (map_.usbl) streams_->usbl.emplace(resolve_, *map_.usbl);
  if (map_.ranges) streams_->ranges.emplace(resolve_, *map_.ranges);
  if (map_.loads) streams_->loads.emplace(resolve_, *map_.loads);
  if (map_.tag_pose) streams_->tags.emplace(resolve_, *map_.tag_pose);
  if (map_.optical_flow) streams_->flow.emplace(resolve_, *map_.optical_flow);
  if (map_.laser_range) streams_->laser.emplace(resolve_, *map_.laser_range);
  if (map_.wind) streams_->wind.emplace(resolve_, *map_.wind);
  if (map_.signals) streams_->signals.emplace(resolve_, *map_.signals);
}

TableImport::~TableImport() = default;

bool TableImport::all_at_once() const {
  // What is turned by an attitude needs those around it.
  return (streams_->ahrs && streams_->ahrs->turns()) || (streams_->dvl && streams_->dvl->turns());
}

std::optional<Utime> TableImport::end_of_next(std::size_t rows) const {
  if (rows_left() == 0) return std::nullopt;
  return rows_.utime[taken_ + std::min(rows, rows_left()) - 1];
}

bool TableImport::next_until(Utime end, Recording& out) {
  std::size_t rows = 0;
  while (rows < rows_left() && rows_.utime[taken_ + rows] <= end) ++rows;
  return rows > 0 && next(rows, out);
}

bool TableImport::next(std::size_t rows, Recording& out) {
  const std::size_t left = rows_left();
  const std::size_t count = all_at_once() ? left : std::min(rows, left);
  if (count == 0) return false;
  Slice slice;
  for (std::size_t k = taken_; k < taken_ + count; ++k) {
    slice.index.push_back(rows_.index[k]);
    slice.utime.push_back(rows_.utime[k]);
  }
  taken_ += count;
  if (streams_->pose) streams_->pose->take(slice, out);
  if (streams_->ahrs) streams_->ahrs->take(slice, out);
  if (streams_->dvl) streams_->dvl->take(slice, out);
  if (streams_->thrusters) streams_->thrusters->take(slice, out);
  if (streams_->depth) streams_->depth->take(slice, out.depth);
  if (streams_->battery) streams_->battery->take(slice, out.battery);
  if (streams_->usbl) streams_->usbl->take(slice, out);
  if (streams_->ranges) streams_->ranges->take(slice, out);
  if (streams_->loads) streams_->loads->take(slice, out);
  if (streams_->tags) streams_->tags->take(slice, out);
  if (streams_->flow) streams_->flow->take(slice, out);
  if (streams_->laser) streams_->laser->take(slice, out);
  const std::size_t before = out.signals.size();
  if (streams_->wind) streams_->wind->take(slice, out);
  if (streams_->signals) streams_->signals->take(slice, out);
  std::stable_sort(out.signals.begin() + static_cast<std::ptrdiff_t>(before), out.signals.end(),
                   [](const Signal& a, const Signal& b) { return a.utime < b.utime; });
  return true;
}

std::vector<std::string> TableImport::finish() {
  streams_->each([&](auto& stream) { stream.report(table_, notes_); });
  if (const auto unused = resolve_.unused(); !unused.empty()) notes_.push_back("columns not used: " + joined(unused));
  return std::move(notes_);
}

Imported import_table(const CsvTable& table, ColumnMap map, const std::optional<SimulatedAxes>& simulated) {
  Imported out;
  out.recording.name = std::filesystem::path(table.path).stem().string();
  out.source = map.source;
  out.licence = map.licence;
  TableImport import(table, std::move(map), simulated);
  import.next(table.rows(), out.recording);
  out.notes = import.finish();
  return out;
}

MappedTable read_mapped(const std::string& csv_path, const std::string& map_path) {
  MappedTable out;
  if (map_path.empty()) {
    out.table = read_csv(csv_path);
    out.notes = to_si(out.table);
    out.map = canonical_map(out.table);
  } else {
    out.map = ColumnMap::load(map_path);
    out.table = read_csv(csv_path);
  }
  return out;
}

Imported import_csv(const std::string& csv_path, const std::string& map_path,
                    const std::optional<SimulatedAxes>& simulated) {
  MappedTable mapped = read_mapped(csv_path, map_path);
  Imported imported = import_table(mapped.table, std::move(mapped.map), simulated);
  imported.notes.insert(imported.notes.begin(), mapped.notes.begin(), mapped.notes.end());
  return imported;
}

}  // namespace fathom::tables
