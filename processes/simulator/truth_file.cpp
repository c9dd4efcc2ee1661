#include "processes/simulator/truth_file.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

namespace fathom::simulator {

void write_truth(const Options& options, const model::Vehicle& vehicle, const model::Site& site,
                 const simulation::Simulator& simulator) {
  if (options.out_dir.empty()) return;
  const simulation::Secrets secrets = simulator.secrets();
  nlohmann::ordered_json file;
  file["vehicle"] = vehicle.name;
  file["site"] = site.name;
  file["seed"] = options.setup.seed;
  file["origin_utime"] = simulator.origin();
  file["seconds"] = seconds_between(simulator.origin(), simulator.now());
  file["control_interval_s"] = static_cast<double>(simulator.interval()) * 1e-6;
  for (const model::BaseParameter parameter : model::base_parameters()) {
    file["parameters"][std::string{model::name(parameter)}] = {{"value", secrets.theta[model::index(parameter)]},
                                                               {"unit", model::unit(parameter)}};
  }
  file["effects"] = nlohmann::ordered_json::array();
  for (const model::ActiveEffect& effect : secrets.effects) {
    nlohmann::ordered_json one{{"name", effect.effect->name()}, {"variant", effect.variant_name}};
    for (std::size_t i = 0; i < effect.theta.size(); ++i) {
      if (!effect.effect->is_told(effect.variant, i)) continue;
      const model::EffectParameter& parameter = effect.effect->parameters()[i];
      one["parameters"][std::string{parameter.name}] = {{"value", effect.theta[i]},
                                                        {"unit", effect.effect->unit(effect.variant, i)}};
    }
    file["effects"].push_back(std::move(one));
  }
  file["instruments"] = simulator.sensors();
  for (const auto& [name, value] : secrets.drawn) file["drawn"][name] = value;
  file["contacts"] = {
      {"walls", secrets.contacts.walls}, {"floor", secrets.contacts.floor}, {"surface", secrets.contacts.surface}};
  std::error_code error;
  std::filesystem::create_directories(options.out_dir, error);
  const std::string path = options.out_dir + "/truth.json";
  std::ofstream out{path};
  out << file.dump(2) << "\n";
  out.close();
  if (!out) throw InputError(path + ": cannot be written; check that the folder is yours and the disk not full");
}

}  // namespace fathom::simulator
