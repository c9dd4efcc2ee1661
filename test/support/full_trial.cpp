#include "test/support/full_trial.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <variant>

#include "common/base/error.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/joint/live_identifier.hpp"
#include "common/live/live_diagnoser.hpp"
#include "common/model/regressor.hpp"
#include "test/common/excitation/tank_run.hpp"

namespace fathom::test {

namespace {

/// A file of the repository with some of its text replaced.
Config changed(const std::string& path, const std::vector<std::pair<std::string, std::string>>& changes) {
  std::ifstream file{path};
  std::string text{std::istreambuf_iterator<char>{file}, {}};
  for (const auto& [old, replacement] : changes) {
    const auto at = text.find(old);
    if (at == std::string::npos) throw InputError(path + ": there is no '" + old + "' to be changed");
    if (text.find(old, at + 1) != std::string::npos)
      throw InputError(path + ": '" + old + "' stands there more than once");
    text.replace(at, old.size(), replacement);
  }
  return Config::parse(text, path);
}

std::vector<Learnt> learnt_of(const ModelEstimate& model, const model::BaseTheta& truth) {
  std::vector<Learnt> learnt;
  for (const auto& p : model.parameters)
    learnt.push_back({p.name, p.value, p.std, truth[model::index(*model::parameter_from_name(p.name))]});
  return learnt;
}

// What the learnt numbers foretell for the true motion up to `until`, beside what the true ones do.
void foretell(const std::map<Utime, Truth>& truths, Utime from, Utime until, const model::BaseTheta& truth,
              const std::array<bool, 6>& dof, Progress& progress) {
  model::BaseTheta wrong = model::BaseTheta::Zero();
  for (const Learnt& p : progress.learnt) wrong[model::index(*model::parameter_from_name(p.name))] = p.value - p.truth;
  Vector6d error = Vector6d::Zero(), applied = Vector6d::Zero();
  for (auto it = truths.lower_bound(from); it != truths.end() && it->first <= until; ++it) {
    const auto Y = model::base_regressor(it->second.nu_dot, it->second.nu, it->second.q_WB.toRotationMatrix());
    error += (Y * wrong).cwiseAbs2();
    applied += (Y * truth).cwiseAbs2();
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!dof[static_cast<std::size_t>(i)]) error[i] = applied[i] = 0.0;
  }
  progress.force = std::sqrt(error.head<3>().sum() / applied.head<3>().sum());
  progress.moment = std::sqrt(error.tail<3>().sum() / applied.tail<3>().sum());
}

/// A file as PROCESS_INFO tells it.
std::string told_file(const std::string& path) {
  std::ifstream file{path};
  return "# file " + path + "\n" + std::string{std::istreambuf_iterator<char>{file}, {}};
}

void keep(const simulation::Sample& sample, Recording& recording) {
  const auto into = [&](const auto& one) {
    using T = std::decay_t<decltype(one)>;
    if constexpr (std::is_same_v<T, Ahrs>) recording.ahrs.push_back(one);
    if constexpr (std::is_same_v<T, Dvl>) recording.dvl.push_back(one);
    if constexpr (std::is_same_v<T, Depth>) recording.depth.push_back(one);
    if constexpr (std::is_same_v<T, Usbl>) recording.usbl.push_back(one);
    if constexpr (std::is_same_v<T, Ranges>) recording.ranges.push_back(one);
    if constexpr (std::is_same_v<T, Loads>) recording.loads.push_back(one);
    if constexpr (std::is_same_v<T, TagPose>) recording.tag_pose.push_back(one);
    if constexpr (std::is_same_v<T, OpticalFlow>) recording.optical_flow.push_back(one);
    if constexpr (std::is_same_v<T, LaserRange>) recording.laser_range.push_back(one);
    if constexpr (std::is_same_v<T, Thrusters>) recording.thrusters.push_back(one);
    if constexpr (std::is_same_v<T, Battery>) recording.battery.push_back(one);
    if constexpr (std::is_same_v<T, Truth>) recording.truth.push_back(one);
  };
  std::visit(into, sample);
}

}  // namespace

FullTrial run_trial(const FullTrialOptions& options) {
  const auto& [seed, optimal, diagnose, joint, times, limit, site_name, hide, vehicle, changes, of_simulation,
               recording] = options;
  const std::string root = FATHOM_SOURCE_DIR;
  auto all_changes = changes;
  if (optimal) {
    all_changes.emplace_back("excitation: paper", "excitation: optimal");
    all_changes.emplace_back("schedule: [yaw, surge, sway, heave, total]", "schedule: [total]");
  }
  const Config pipeline = changed(root + "/config/pipelines/" + site_name + ".yaml", all_changes);
  auto s = tank_settings();
  s.vehicle = vehicle_from_repository(vehicle);
  const model::Site site = model::Site::load(root + "/config/sites/" + site_name + ".yaml");
  s.supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), s.vehicle, site);
  s.identifier = identification::IdentifierSettings::from(pipeline.section("identifier"));
  s.supervisor.seed = seed;
  simulation::Simulator simulator{
      s.vehicle,
      site,
      changed(root + "/config/simulation/" + vehicle + ".yaml", of_simulation).section("simulator"),
      {.seed = seed, .hide = hide, .duration = limit}};
  const auto navigator_settings = estimation::NavigatorSettings::from(pipeline.section("estimator"));
  const auto places = estimation::NavigatorPlaces::of(s.vehicle.mounts, site);
  const std::unique_ptr<joint::LiveIdentifier> mind =
      joint ? std::make_unique<joint::LiveIdentifier>(
                  s.identifier, s.vehicle, joint::JointSettings::from(pipeline.section("identifier").section("joint")),
                  navigator_settings, places)
            : std::make_unique<joint::LiveIdentifier>(s.identifier, s.vehicle);
  joint::LiveIdentifier& identifier = *mind;
  estimation::Navigator navigator{navigator_settings, places};
  excitation::Supervisor supervisor{ready(s.supervisor, s.vehicle)};
  std::unique_ptr<live::LiveDiagnoser> diagnoser;
  if (diagnose)
    diagnoser =
        std::make_unique<live::LiveDiagnoser>(live::LiveSettings::from(pipeline.section("diagnoser")), s.vehicle, site);
  FullTrial trial;
  const auto rank = [&](const std::optional<EffectRanking>& ranking) {
    if (!ranking) return;
    identifier.hear(*ranking);
    trial.rankings.push_back(*ranking);
  };
  const auto learnt = [&](const ModelEstimate& model) {
    supervisor.hear(model);
    if (recording != nullptr) recording->model.push_back(model);
  };
  double n = 0.0;
  bool armed = false;
  StateEstimate last;
  std::map<Utime, Truth> truths;
  Utime armed_at{};
  std::vector<std::pair<Utime, ModelEstimate>> told;  // by the times of `when`
  const auto use = [&](const StateEstimate& state) {
    last = state;
    for (const auto& model : identifier.step(state).models) learnt(model);
    if (diagnoser) rank(diagnoser->step(state));
    const auto& output = supervisor.step(state);
    if (recording != nullptr && output.excitation) recording->excitation.push_back(*output.excitation);
    if (output.command) simulator.command(*output.command);
    if (output.excitation) identifier.hear(*output.excitation);
    const double t = seconds_between(1'700'000'000'000'000, state.utime);
    if (!armed && t > 1.0 && state.valid) {
      supervisor.hear(order_to_arm(state.utime));
      armed = true;
      armed_at = state.utime;
    }
    if (armed && told.size() < options.when.size() &&
        seconds_between(armed_at, state.utime) >= options.when[told.size()])
      told.emplace_back(state.utime, identifier.model());
  };
  std::map<Utime, StateEstimate> states;
  if (recording != nullptr) {
    recording->process_info.push_back({.process = "estimator",
                                       .config = told_file(root + "/config/pipelines/" + site_name + ".yaml") +
                                                 told_file(root + "/config/vehicles/" + vehicle + ".yaml") +
                                                 told_file(root + "/config/sites/" + site_name + ".yaml")});
  }
  while (seconds_between(1'700'000'000'000'000, simulator.now()) < limit) {
    for (const simulation::Sample& sample : simulator.step()) {
      if (recording != nullptr) keep(sample, *recording);
      std::visit(
          [&](const auto& one) {
            using T = std::decay_t<decltype(one)>;
            if constexpr (requires { navigator.step(one); }) {
              identifier.hear(one);
              if (diagnoser) diagnoser->hear(one);
              for (const StateEstimate& state : navigator.step(one)) {
                use(state);
                if (recording != nullptr) recording->state.push_back(state);
                states[state.utime] = state;
              }
            } else if constexpr (std::is_same_v<T, Thrusters>) {
              for (const auto& model : identifier.step(one).models) learnt(model);
              if (diagnoser) diagnoser->hear(one);
            } else if constexpr (std::is_same_v<T, Battery>) {
              if (diagnoser) diagnoser->hear(one);
            } else if constexpr (std::is_same_v<T, Truth>) {
              truths[one.utime] = one;
            }
          },
          sample);
    }
    using excitation::Phase;
    if (armed && (supervisor.phase() == Phase::kAborted || supervisor.phase() == Phase::kLost)) break;
    if (supervisor.phase() == Phase::kDone && supervisor.visits().size() == s.supervisor.schedule.size()) break;
  }
  if (diagnoser) rank(diagnoser->finish());
  for (const auto& [utime, truth] : truths) {
    const auto found = states.lower_bound(utime);
    if (found == states.end() || found->first - utime > 5'000 || seconds_between(1'700'000'000'000'000, utime) < 5.0)
      continue;
    const double dt = seconds_between(utime, found->first);
    const StateEstimate& state = found->second;
    if (!state.valid) continue;
    n += 1.0;
    const Eigen::Vector3d dp = state.p_WB - truth.p_WB - dt * (truth.q_WB * truth.nu.head<3>());
    const Eigen::Vector3d dv = state.nu.head<3>() - truth.nu.head<3>() - dt * truth.nu_dot.head<3>();
    trial.velocity_mean += dv;
    trial.position += dp.cwiseAbs2();
    trial.velocity += dv.cwiseAbs2();
    trial.nees_position += dp.cwiseQuotient(state.sigma.head<3>()).cwiseAbs2();
    trial.nees_velocity += dv.cwiseQuotient(state.sigma.segment<3>(6)).cwiseAbs2();
  }
  trial.position = (trial.position / n).cwiseSqrt();
  trial.velocity = (trial.velocity / n).cwiseSqrt();
  trial.velocity_mean /= n;
  trial.nees_position /= n;
  trial.nees_velocity /= n;
  trial.ended = seconds_between(1'700'000'000'000'000, simulator.now()) - 1.0;
  trial.phase = supervisor.phase();
  trial.visits = supervisor.visits();
  trial.contacts = simulator.contacts();
  trial.model = identifier.model();
  std::ostringstream text;
  text << "seed " << seed << ": " << name(supervisor.phase()) << ", " << supervisor.reason() << "; ended "
       << trial.ended << " s; contacts " << trial.contacts.walls << " " << trial.contacts.floor << " "
       << trial.contacts.surface << "\n  position [mm] " << 1e3 * trial.position.transpose() << " velocity [mm/s] "
       << 1e3 * trial.velocity.transpose() << " mean " << 1e3 * trial.velocity_mean.transpose() << " NEES "
       << trial.nees_position.transpose() << " | " << trial.nees_velocity.transpose() << "\n";
  for (const auto& v : trial.visits)
    text << "  " << v.mode << " " << v.begun << " to " << v.ended << (v.left ? " left" : " given up: ") << v.missing
         << "\n";
  text << "  ratio " << trial.model.residual_ratio.transpose() << " mean " << trial.model.residual_mean.transpose()
       << "\n";
  const model::BaseTheta truth = simulator.secrets().theta;
  for (const auto& [utime, model] : told) {
    Progress progress{.seconds = seconds_between(armed_at, utime), .learnt = learnt_of(model, truth)};
    const auto size = static_cast<Eigen::Index>(progress.learnt.size());
    Eigen::VectorXd off(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Learnt& p = progress.learnt[static_cast<std::size_t>(i)];
      off[i] = p.value - p.truth;
    }
    progress.nees = off.dot(Eigen::Map<const Eigen::MatrixXd>(model.covariance.data(), size, size).ldlt().solve(off));
    foretell(truths, armed_at, utime, truth, s.vehicle.dof, progress);
    trial.progress.push_back(std::move(progress));
  }
  trial.learnt = learnt_of(trial.model, truth);
  for (const auto& p : trial.learnt) {
    const double value = p.truth;
    const double z = (p.value - value) / p.std;
    trial.covered += std::abs(z) < 1.96 ? 1 : 0;
    trial.within += std::abs(p.value - value) < 0.05 * std::abs(value) ? 1 : 0;
    text << "  " << p.name << " " << p.value << " +- " << p.std << " truth " << value << " error "
         << 100.0 * (p.value / value - 1.0) << " %, z " << z << "\n";
  }
  for (const EffectRanking& ranking : trial.rankings) {
    text << "  " << seconds_between(1'700'000'000'000'000, ranking.utime) << " s: " << ranking.verdict;
    if (!ranking.against.empty()) text << " against " << ranking.against;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, ranking.candidates.size()); ++i) {
      const EffectEvidence& one = ranking.candidates[i];
      text << "; " << one.name << " " << one.variant << " " << one.log_odds << " " << one.error_reduction;
      for (const double number : one.numbers) text << (i == 0 ? " " + std::to_string(number) : "");
    }
    text << "\n";
  }
  for (const std::string& effect : trial.model.effects) text << "  adopted " << effect << "\n";
  for (const NamedValue& p : trial.model.effect_numbers)
    text << "  " << p.name << " " << p.value << " +- " << p.std << "\n";
  for (const auto& [reason, count] : identifier.rejected()) text << "  " << reason << " " << count << "\n";
  for (const auto& [reason, count] : navigator.rejected()) text << "  " << reason << " " << count << "\n";
  text << "  " << navigator.complaint() << "\n";
  trial.text = text.str();
  return trial;
}

}  // namespace fathom::test
