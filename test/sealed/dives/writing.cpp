#include "test/sealed/dives/writing.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "test/sealed/dives/other_writing.hpp"
#include "test/sealed/judging/reference.hpp"

namespace fathom::sealed {
namespace {

using Json = nlohmann::ordered_json;

__attribute__((format(printf, 2, 3))) void add(std::string& text, const char* format, ...) {
  char buffer[256];
  va_list list;
  va_start(list, format);
  std::vsnprintf(buffer, sizeof buffer, format, list);
  va_end(list);
  text += buffer;
}

void write_file(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

double folded(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

/// Whether a file has a column of voltage. Thrust that falls with time is that of a battery nobody watches.
bool shows_voltage(const SealedSet& set, const Dive& run) {
  const bool unwatched = std::ranges::find(set.plan.names, "battery_sag") != set.plan.names.end();
  return !run.voltage.empty() || (set.plan.voltage && !unwatched);
}

Json numbers(const Vector6& values) { return Json(std::vector<double>(values.begin(), values.end())); }

}  // namespace

Places places(const std::string& out, std::uint64_t seed, const std::string& way) {
  std::string number = std::to_string(seed);
  number.insert(0, number.size() < 5 ? 5 - number.size() : 0, '0');
  return {out + "/data/" + number, out + "/truth/" + number + ".json",
          out + "/found" + (way.empty() ? "" : "-" + way) + "/" + number};
}

std::string to_csv(const SealedSet& set, const Dive& run) {
  const std::size_t jets = set.craft.jets.size();
  std::string text = "t,x,y,z,phi,theta,psi,u,v,w,p,q,r";
  const bool commands = logs_commands(set.craft);
  if (set.plan.wrench) {
    text += ",X,Y,Z,K,M,N";
  } else {
    for (std::size_t i = 1; i <= jets; ++i) add(text, commands ? ",c%zu" : ",f%zu", i);
  }
  const bool voltage = shows_voltage(set, run);
  text += voltage ? ",voltage\n" : "\n";
  const auto allocation = set.craft.allocation();
  Random volts(set.plan.seed, "voltage");
  for (std::size_t k = 0; k < run.size(); ++k) {
    const double t = run.begin + static_cast<double>(k) * run.dt;
    const Eigen::Vector3d p = run.sensed.position[k] + run.pose_noise[k].head<3>();
    const Eigen::Vector3d e = run.sensed.euler[k] + run.pose_noise[k].tail<3>();
    const Vector6 nu = run.sensed.nu[k] + run.nu_noise[k];
    add(text, "%.2f,%.5f,%.5f,%.5f,%.6f,%.6f,%.6f", t, p[0], p[1], p[2], folded(e[0]), folded(e[1]), folded(e[2]));
    for (const double x : nu) add(text, ",%.5f", x);
    const Eigen::VectorXd drive = set.plan.wrench ? Eigen::VectorXd(allocation * run.command(k)) : run.command(k);
    for (Eigen::Index i = 0; i < drive.size(); ++i) {
      if (commands) {
        add(text, ",%.7g", command_of(set.craft, set.craft.jets[static_cast<std::size_t>(i)], drive[i]));
      } else {
        add(text, ",%.4f", drive[i]);
      }
    }
    if (voltage) {
      const double idle = set.craft.nominal_voltage * (1.05 - 0.0002 * t);
      add(text, ",%.3f", (run.voltage.empty() ? idle : run.voltage[k]) + 0.01 * volts.normal());
    }
    text += '\n';
  }
  return text;
}

std::string to_vehicle_file(const SealedSet& set) {
  const Craft& craft = set.craft;
  const Hull& hull = craft.hull;
  Random owner(set.plan.seed, "owner");
  std::string text;
  add(text, "name: Vehicle %llu\n", static_cast<unsigned long long>(set.plan.seed));
  const bool rov = craft.craft_class == CraftClass::kRov;
  if (rov)
    text += craft.actuated[3] ? "dof: [surge, sway, heave, roll, pitch, yaw]\n" : "dof: [surge, sway, heave, yaw]\n";
  add(text, "mass: %.4g kg\n", hull.mass * owner.uniform(0.98, 1.02));
  if (craft.actuated[3] || owner.chance(0.5)) {
    const double wrong = owner.uniform(0.85, 1.15);
    add(text, "inertia: %.3g %.3g %.3g kg m^2\n", hull.inertia[0] * wrong, hull.inertia[1] * wrong,
        hull.inertia[2] * wrong);
  }
  add(text, "water_density: %.0f kg/m^3\n", owners_density(craft));
  add(text, "nominal_voltage: %.1f V\n", craft.nominal_voltage);
  if (!rov) text += other_keys(craft);
  if (!set.plan.wrench && rov) {
    text += "thrusters:\n";
    for (std::size_t i = 0; i < craft.jets.size(); ++i) {
      const Jet& jet = craft.jets[i];
      add(text, "  - {name: T%zu, position: %.6f %.6f %.6f m, axis: %.8f %.8f %.8f}\n", i + 1, jet.position[0],
          jet.position[1], jet.position[2], jet.axis[0], jet.axis[1], jet.axis[2]);
    }
  }
  const auto names = base_names(craft);
  if (craft.actuated[3] && !craft.states_moments) {
    text += "parameters: [";
    for (std::size_t j = 0; j < names.size(); ++j) text += (j > 0 ? ", " : "") + names[j];
    text += "]\n";
  }
  if (set.plan.priors) {
    const Eigen::VectorXd truth = base_values(craft, hull);
    text += "priors:\n";
    for (std::size_t j = 0; j < names.size(); ++j) {
      const std::string& name = names[j];
      const bool drag = name.find('_') == 1 && name[0] != 'm' && name[0] != 'I' && name[0] != 'G';
      const bool turns = name[0] == 'I' || (drag && name.find_first_of("KMN") == 0);
      std::string unit = name[0] == 'm' ? "kg" : name[0] == 'I' ? "kg m^2" : name[0] == 'G' ? "N m" : "N";
      if (drag) {
        unit = std::string(turns ? "N m/(rad/s)" : "N/(m/s)") + (name.find('|') != std::string::npos ? "^2" : "");
      }
      const double value = truth[static_cast<Eigen::Index>(j)];
      const bool balance = name == "W-B" || name[0] == 'G';
      const double mean = balance ? 0.0 : value * owner.uniform(0.6, 1.6);
      const double sigma = name == "W-B"    ? 0.05 * hull.mass * kGravity
                           : name[0] == 'G' ? 0.1 * hull.mass * kGravity * craft.extent.x()
                                            : std::abs(mean) * (drag ? 3.0 : 1.0);
      add(text, "  %s: {mean: %.3g %s, sigma: %.3g %s}\n", name.c_str(), mean, unit.c_str(), sigma, unit.c_str());
    }
  }
  return text;
}

std::string to_truth(const SealedSet& set) {
  const Plan& plan = set.plan;
  Json truth;
  truth["generator"] = kGenerator;
  truth["seed"] = plan.seed;
  truth["kind"] = kKindNames[static_cast<std::size_t>(plan.kind)];
  truth["size"] = kSizeNames[static_cast<std::size_t>(plan.size)];
  truth["effects"] = Json::array();
  for (std::size_t i = 0; i < set.mechanisms.size(); ++i) {
    Json one;
    one["name"] = set.mechanisms[i]->name();
    one["form"] = set.mechanisms[i]->form();
    one["share"] = set.shares[i];
    one["parameters"] = set.mechanisms[i]->parameters();
    truth["effects"].push_back(one);
  }
  truth["class_reached"] = set.reached;
  truth["family"] = set.craft.family;
  // Names by which a lifting hull's own flow may be told: neither an effect that was hidden nor a wrong one.
  if (set.craft.craft_class != CraftClass::kRov)
    truth["nature"] = {"body_lift", "cross_flow", "speed_drag", "turning_resistance"};
  truth["one_clock"] = plan.one_clock;
  truth["train_files"] = plan.train_files;
  truth["validates"] = plan.validates;
  truth["wrench"] = plan.wrench;
  truth["priors"] = plan.priors;
  truth["between_rows"] = kHoldNames[static_cast<std::size_t>(plan.hold)];
  const auto names = base_names(set.craft);
  const Eigen::VectorXd values = base_values(set.craft, set.craft.hull);
  for (std::size_t j = 0; j < names.size(); ++j) truth["base"][names[j]] = values[static_cast<Eigen::Index>(j)];
  truth["residual_rms"] = numbers(set.fit.residual);
  truth["applied_rms"] = numbers(set.fit.applied);
  const Floor floor = prediction_floor(set);
  truth["floor"] = {{"truth", floor.truth}, {"base", floor.base}, {"truth_rmse", numbers(floor.truth_rmse)}};
  if (plan.kind == Kind::kClean) {
    const Bound bound = cramer_rao(set);
    for (std::size_t j = 0; j < names.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      truth["bound"][names[j]] = {{"speeds", bound.speeds[i]}, {"all", bound.all[i]}};
    }
  }
  return truth.dump(1) + "\n";
}

void write_set(const SealedSet& set, const Places& where) {
  write_file(where.data + "/vehicle.yaml", to_vehicle_file(set));
  for (std::size_t i = 0; i < set.train.size(); ++i) {
    write_file(where.data + "/train-" + std::to_string(i + 1) + ".csv", to_csv(set, set.train[i]));
  }
  if (set.validate) write_file(where.data + "/validate.csv", to_csv(set, *set.validate));
  if (logs_commands(set.craft))
    write_file(where.data + "/map.yaml", to_map(set.craft, shows_voltage(set, set.train.front())));
  write_file(where.truth, to_truth(set));
}

}  // namespace fathom::sealed
