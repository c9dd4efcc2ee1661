#include "common/model/site.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::model {
namespace {

void add_tag(const Config& config, const std::string& key, Tag tag, bool twice_allowed, Site& site) {
  const std::string family = site.family_of(tag);
  const bool twice = site.tag(family, tag.id) != nullptr;
  if (twice && !twice_allowed) config.fail(key, "two tags have the number " + std::to_string(tag.id));
  const Tag* other = site.tag(tag.number());
  if (other != nullptr && !twice) {
    config.fail(key, "tag " + std::to_string(tag.id) + " of " + family + " and tag " + std::to_string(other->id) +
                         " of " + site.family_of(*other) + " would both be number " + std::to_string(tag.number()) +
                         " in TAG_POSE: state another 'number' for one of them");
  }
  site.tags.push_back(std::move(tag));
}

// Of a tag or a poster.
void read_family(const Config& config, const Site& site, Tag& tag) {
  if (config.has("number")) tag.own_number = config.integer("number");
  if (!config.has("family")) return;
  tag.family = config.text("family");
  const std::vector<std::string>& families = site.search.families;
  if (std::none_of(families.begin(), families.end(), [&](const auto& each) { return same_family(each, tag.family); }))
    config.fail("family", "'families' of 'tag_search' does not name " + tag.family + ": nobody would look for it");
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
  Tag tag{.size = size, .R_WT = R_WT};
  read_family(config, site, tag);
  const std::optional<int> first_number = tag.own_number;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d p_T{pitch * (column - 0.5 * (columns - 1)), pitch * (row - 0.5 * (rows - 1)), 0.0};
      const int place = row * columns + column;
      tag.id = first + place;
      tag.p_WT = middle + R_WT * p_T;
      if (first_number) tag.own_number = *first_number + place;
      add_tag(config, "first", tag, twice_allowed, site);
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

// What is printed on two tags is of no use to pictures: neither can be told from the other.
void drop_doubtful(Site& site) {
  const auto alike = [&](const Tag& a, const Tag& b) {
    return a.id == b.id && same_family(site.family_of(a), site.family_of(b));
  };
  std::vector<TagName>& doubtful = site.doubtful_tags;
  for (const Tag& tag : site.tags) {
    if (std::ranges::count_if(site.tags, [&](const Tag& each) { return alike(each, tag); }) < 2) continue;
    const TagName name{site.family_of(*site.tag(site.family_of(tag), tag.id)), tag.id};
    if (std::ranges::find(doubtful, name) == doubtful.end()) doubtful.push_back(name);
  }
  std::erase_if(site.tags, [&](const Tag& tag) {
    return std::ranges::any_of(doubtful, [&](const TagName& each) {
      return each.id == tag.id && same_family(each.family, site.family_of(tag));
    });
  });
}

Site read(const Config& config, bool pictures_alone) {
  Site site;
  site.name = config.text("site");
  if (!pictures_alone || config.has("water")) read_water(config, site);
  if (!pictures_alone || config.has("declination")) site.declination = config.quantity("declination", "rad");
  if (config.has("walls")) read_walls(config.section("walls"), site);
  if (config.has("tag_search")) read_search(config.section("tag_search"), site.search);
  if (config.has("tags")) {
    for (const Config& one : config.list("tags")) {
      Tag tag{.id = one.integer("id"),
              .size = one.positive("size", "m"),
              .p_WT = one.vector3("position", "m"),
              .R_WT = rotation_from_euler(one.vector3("rotation", "rad"))};
      read_family(one, site, tag);
      add_tag(one, "id", tag, pictures_alone, site);
    }
  }
  if (config.has("camera")) site.lens = Lens::from(config.section("camera"));
  if (config.is_section("poster")) {
    read_poster(config.section("poster"), pictures_alone, site);
  } else if (config.has("poster")) {
    for (const Config& one : config.list("poster")) read_poster(one, pictures_alone, site);
  }
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

Site Site::load(const std::string& path) { return from(Config::load(path)); }

Site Site::from(const Config& config) { return read(config, false); }

Site Site::load_for_pictures(const std::string& path) { return read(Config::load(path), true); }

const Tag* Site::tag(int number) const {
  const auto found = std::ranges::find(tags, number, &Tag::number);
  return found == tags.end() ? nullptr : &*found;
}

const Tag* Site::tag(std::string_view family, int id) const {
  const auto found = std::ranges::find_if(
      tags, [&](const Tag& each) { return each.id == id && same_family(family_of(each), family); });
  return found == tags.end() ? nullptr : &*found;
}

const std::string& Site::family_of(const Tag& tag) const {
  return tag.family.empty() ? search.families.front() : tag.family;
}

std::string Site::doubts() const {
  std::string numbers;
  for (const auto& [family, id] : doubtful_tags) {
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(id);
    if (search.families.size() > 1) numbers += " (" + family + ")";
  }
  return numbers.empty() ? "" : "the site's map has two tags of number " + numbers + ": neither is used";
}

void Site::look_for(const std::vector<std::string>& families) {
  const bool named = std::ranges::any_of(tags, [](const Tag& tag) { return !tag.family.empty(); });
  for (Tag& tag : tags) {
    if (named) tag.family = family_of(tag);
  }
  search.families = families;
}

bool same_family(std::string_view a, std::string_view b) {
  constexpr std::string_view kFront = "tag";
  if (a.starts_with(kFront)) a.remove_prefix(kFront.size());
  if (b.starts_with(kFront)) b.remove_prefix(kFront.size());
  return a == b;
}

}  // namespace fathom::model
