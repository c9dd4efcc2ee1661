#include "common/model/site.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::model {
namespace {

void add_tag(const Config& config, const std::string& key, Tag tag, bool twice_allowed, Site& site) {
  if (!twice_allowed && site.tag(tag.id) != nullptr)
    config.fail(key, "two tags have the number " + std::to_string(tag.id));
  site.tags.push_back(std::move(tag));
}

// A poster: rows of equal tags in one plane. The first is at the top left as one reads it; numbers rise to the right,
// then downward.
void read_poster(const Config& config, bool twice_allowed, Site& site) {
  const int rows = config.integer("rows"), columns = config.integer("columns"), first = config.integer("first");
  if (rows <= 0) config.fail("rows", "'rows' must be positive");
  if (columns <= 0) config.fail("columns", "'columns' must be positive");
  const double pitch = config.positive("pitch", "m"), size = config.positive("size", "m");
  if (size > pitch) config.fail("pitch", "the tags overlap: 'pitch' is smaller than 'size'");
  const Eigen::Vector3d middle = config.vector3("middle", "m");
  const Eigen::Matrix3d R_WT = rotation_from_euler(config.vector3("rotation", "rad"));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d p_T{pitch * (column - 0.5 * (columns - 1)), pitch * (row - 0.5 * (rows - 1)), 0.0};
      add_tag(config, "first",
              {.id = first + row * columns + column, .size = size, .p_WT = middle + R_WT * p_T, .R_WT = R_WT},
              twice_allowed, site);
    }
  }
}

void read_walls(const Config& config, Site& site) {
  const auto wall = [&](const char* key, double& to) {
    if (config.has(key)) to = config.quantity(key, "m");
  };
  wall("north", site.north);
  wall("south", site.south);
  wall("east", site.east);
  wall("west", site.west);
  if (site.north <= site.south) config.fail("north", "the north wall must lie north of the south wall");
  if (site.east <= site.west) config.fail("east", "the east wall must lie east of the west wall");
}

void read_search(const Config& config, TagSearch& search) {
  search.families = config.texts("families");
  if (search.families.empty()) config.fail("families", "'families' names no family of tags");
  if (config.has("least_margin")) search.least_margin = config.not_negative("least_margin", "");
  if (config.has("map_sigma")) search.map_sigma = config.not_negative("map_sigma", "m");
}

void read_water(const Config& config, Site& site) {
  const Config water = config.section("water");
  site.water_density = water.positive("density", "kg/m^3");
  site.gravity = water.positive("gravity", "m/s^2");
  site.sound_speed = water.positive("sound_speed", "m/s");
  site.surface = water.quantity("surface", "m");
  site.floor = water.quantity("floor", "m");
  if (site.floor <= site.surface) water.fail("floor", "'floor' must lie below the surface: z points down");
}

// Numbers that stand twice are of no use to pictures: neither tag can be told from the other.
void drop_doubtful(Site& site) {
  const auto doubtful = [&](const Tag& tag) {
    return std::count_if(site.tags.begin(), site.tags.end(), [&](const Tag& each) { return each.id == tag.id; }) > 1;
  };
  for (const Tag& tag : site.tags) {
    const auto known = std::find(site.doubtful_tags.begin(), site.doubtful_tags.end(), tag.id);
    if (doubtful(tag) && known == site.doubtful_tags.end()) site.doubtful_tags.push_back(tag.id);
  }
  std::erase_if(site.tags, [&](const Tag& tag) {
    return std::find(site.doubtful_tags.begin(), site.doubtful_tags.end(), tag.id) != site.doubtful_tags.end();
  });
}

Site read(const std::string& path, bool pictures_alone) {
  const Config config = Config::load(path);
  Site site;
  site.name = config.text("site");
  if (!pictures_alone || config.has("water")) read_water(config, site);
  if (!pictures_alone || config.has("declination")) site.declination = config.quantity("declination", "rad");
  if (config.has("walls")) read_walls(config.section("walls"), site);
  if (config.has("tags")) {
    for (const Config& one : config.list("tags")) {
      add_tag(one, "id",
              {.id = one.integer("id"),
               .size = one.positive("size", "m"),
               .p_WT = one.vector3("position", "m"),
               .R_WT = rotation_from_euler(one.vector3("rotation", "rad"))},
              pictures_alone, site);
    }
  }
  if (config.has("tag_search")) read_search(config.section("tag_search"), site.search);
  if (config.has("camera")) site.lens = Lens::from(config.section("camera"));
  if (config.has("poster")) read_poster(config.section("poster"), pictures_alone, site);
  drop_doubtful(site);
  if (config.has("transponders")) {
    for (const Config& one : config.list("transponders")) {
      site.transponders.push_back({.name = one.text("name"), .p_W = one.vector3("position", "m")});
    }
  }
  if (config.has("transceiver")) site.transceiver = config.section("transceiver").vector3("position", "m");
  if (config.has("tether")) site.tether_anchor = config.section("tether").vector3("anchor", "m");
  config.finish();
  return site;
}

}  // namespace

Site Site::load(const std::string& path) { return read(path, false); }

Site Site::load_for_pictures(const std::string& path) { return read(path, true); }

const Tag* Site::tag(int id) const {
  const auto found = std::find_if(tags.begin(), tags.end(), [id](const Tag& each) { return each.id == id; });
  return found == tags.end() ? nullptr : &*found;
}

}  // namespace fathom::model
