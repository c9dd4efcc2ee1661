// What a map says of aids beside the usual ones: acoustic fixes, tags, optical flow and laser dots.
#include <algorithm>

#include "common/tables/map_keys.hpp"
#include "common/tables/map_sections.hpp"

namespace fathom::tables::map_sections {

using namespace map_keys;  // NOLINT(google-build-using-namespace)

UsblColumns usbl_of(const Config& config) {
  UsblColumns usbl;
  const Config position = config.section("position");
  usbl.position = whole_vector(position, "m");
  usbl.position.to_house = world_frame(position, "frame");
  if (config.is_section("sigma")) {
    usbl.sigma = whole_vector(config.section("sigma"), "m");
    usbl.sigma->to_house = usbl.position.to_house.cwiseAbs();
  } else {
    usbl.stated_sigma = config.positive("sigma", "m");
  }
  usbl.invalid_where = invalid_of(config);
  return usbl;
}

TagColumns tags_of(const Config& config) {
  TagColumns tags;
  tags.camera = config.text("camera");
  tags.tag = column_or_number(config, "tag", "");
  tags.position = whole_vector(config.section("position"), "m");
  tags.quaternion.columns = quaternion_columns(config.section("quaternion"));
  if (config.has("reprojection_error")) tags.error = column_or_number(config, "reprojection_error", "");
  tags.invalid_where = invalid_of(config);
  return tags;
}

FlowColumns flow_of(const Config& config) {
  FlowColumns flow;
  flow.camera = config.text("camera");
  flow.flow = whole_vector(config.section("flow"), "rad/s", 2);
  flow.interval = column_or_number(config, "interval", "s");
  flow.sigma = column_or_number(config, "sigma", "rad/s");
  if (config.has("tracks")) flow.tracks = column_or_number(config, "tracks", "");
  flow.invalid_where = invalid_of(config);
  return flow;
}

LaserColumns laser_of(const Config& config) {
  LaserColumns laser;
  laser.camera = config.text("camera");
  laser.position = whole_vector(config.section("position"), "m");
  laser.sigma = column_or_number(config, "sigma", "m");
  laser.invalid_where = invalid_of(config);
  return laser;
}

}  // namespace fathom::tables::map_sections
