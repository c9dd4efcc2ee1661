// The section `estimator` of a trial's pipeline, with one section for each aid that is used.
#include "common/base/config.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/model/mounts.hpp"
#include "common/model/site.hpp"

namespace fathom::estimation {
namespace {

AidSettings aid_from(const Config& config, const std::string& key, bool velocity, bool vertical_alone) {
  AidSettings aid;
  if (!config.has(key)) return aid;
  const Config section = config.section(key);
  aid.used = true;
  aid.delay = section.not_negative("delay", "s");
  aid.max_age = section.positive("max_age", "s");
  aid.noise = section.not_negative("noise", velocity ? "m/s" : "m");
  if (key == "tags" && section.has("vertical_noise")) aid.vertical_noise = section.positive("vertical_noise", "m");
  if (section.has("systematic")) aid.systematic = section.not_negative("systematic", velocity ? "m/s" : "m");
  if (!vertical_alone) aid.cutoff = section.positive("cutoff", "rad/s");
  if (key != "flow") aid.vertical_cutoff = section.positive("vertical_cutoff", "rad/s");
  if (velocity) aid.damping = section.positive("damping", "");
  if (velocity && section.has("scale")) {
    aid.scale = section.vector3("scale", "");
    if (!(aid.scale.minCoeff() > 0.0)) section.fail("scale", "'scale' is true over read, three numbers above zero");
  }
  if (key != "flow") aid.vertical_damping = section.positive("vertical_damping", "");
  return aid;
}

}  // namespace

NavigatorSettings NavigatorSettings::from(const Config& config) {
  NavigatorSettings s;
  s.published_gains = config.either("gains", "published", "computed");
  s.gate = config.positive("gate", "");
  s.max_gap = config.positive("max_gap", "s");
  s.attitude_noise = config.positive("attitude_noise", "rad");
  if (config.has("attitude_systematic")) s.attitude_systematic = config.not_negative("attitude_systematic", "rad");
  s.heading_systematic =
      config.has("heading_systematic") ? config.not_negative("heading_systematic", "rad") : s.attitude_systematic;
  s.rate_noise = config.positive("rate_noise", "rad/s");
  s.acceleration_noise = config.positive("acceleration_noise", "m/s");
  s.vertical_acceleration_noise = config.has("vertical_acceleration_noise")
                                      ? config.positive("vertical_acceleration_noise", "m/s")
                                      : s.acceleration_noise;
  s.bias_walk = config.positive("bias_walk", "m/s^2");
  s.bias_prior = config.positive("bias_prior", "m/s^2");
  s.unknown_acceleration = config.positive("unknown_acceleration", "m/s^2");
  s.largest_position_sigma = config.positive("largest_position_sigma", "m");
  s.largest_velocity_sigma = config.positive("largest_velocity_sigma", "m/s");
  s.tags = aid_from(config, "tags", false, false);
  s.flow = aid_from(config, "flow", true, false);
  s.laser = aid_from(config, "laser", false, true);
  s.dvl = aid_from(config, "dvl", true, false);
  s.usbl = aid_from(config, "usbl", false, false);
  s.depth = aid_from(config, "depth", false, true);
  if (s.published_gains && (s.dvl.used || s.usbl.used || s.depth.used)) {
    config.fail("gains", "the paper publishes gains for tags, flow and laser alone; use gains: computed");
  }
  return s;
}

NavigatorPlaces NavigatorPlaces::of(const model::Mounts& mounts, const model::Site& site) {
  NavigatorPlaces places;
  for (const model::CameraMount& camera : mounts.cameras) {
    places.cameras[camera.name] = {.p_BC = camera.mount.p_BS, .R_BC = camera.mount.R_BS};
  }
  for (const model::Tag& tag : site.tags) places.tags[tag.number()] = tag.p_WT;
  places.floor = site.floor;
  places.walls = {Eigen::Vector2d{site.south, site.west}, Eigen::Vector2d{site.north, site.east}};
  places.gravity = site.gravity;
  if (mounts.ahrs) places.p_BI = mounts.ahrs->p_BS;
  return places;
}

}  // namespace fathom::estimation
