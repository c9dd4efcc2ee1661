#include "common/wire/minds.hpp"

#include <algorithm>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/learned_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/smoothed_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/truth_t.hpp>
#include <utility>

#include "common/wire/plausible.hpp"

namespace fathom::wire {
namespace {

bool take(const std::vector<fathom_lcm::named_value_t>& from, std::vector<NamedValue>& to) {
  to.reserve(from.size());
  for (const auto& part : from) {
    if (!finite(part.value) || !finite(part.std)) return false;
    to.push_back({.name = part.name, .value = part.value, .std = part.std, .unit = part.unit});
  }
  return true;
}

void put(const std::vector<NamedValue>& from, std::vector<fathom_lcm::named_value_t>& to) {
  for (const NamedValue& part : from) {
    auto& one = to.emplace_back();
    one.name = part.name;
    one.value = part.value;
    one.std = part.std;
    one.unit = part.unit;
  }
}

}  // namespace

std::optional<StateEstimate> decode(const fathom_lcm::state_t& message) {
  if (!finite(message.p_WB) || !unit(message.q_WB) || !finite(message.nu) || !finite(message.sigma)) return {};
  if (!finite(message.covariance) || !finite(message.age)) return {};
  StateEstimate sample{.utime = message.utime,
                       .p_WB = vector(message.p_WB),
                       .q_WB = quaternion(message.q_WB),
                       .nu = vector(message.nu),
                       .sigma = vector(message.sigma),
                       .valid = message.valid != 0};
  sample.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.covariance);
  std::copy(std::begin(message.age), std::end(message.age), sample.age.begin());
  return sample;
}

fathom_lcm::state_t encode(const StateEstimate& sample) {
  fathom_lcm::state_t message{};
  message.utime = sample.utime;
  put(sample.p_WB, message.p_WB);
  put(sample.q_WB, message.q_WB);
  put(sample.nu, message.nu);
  put(sample.sigma, message.sigma);
  message.valid = sample.valid;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{message.covariance} = sample.covariance;
  std::copy(sample.age.begin(), sample.age.end(), message.age);
  return message;
}

std::optional<SmoothedState> decode(const fathom_lcm::smoothed_t& message) {
  if (!finite(message.p_WB) || !unit(message.q_WB) || !finite(message.nu)) return {};
  if (!finite(message.nu_dot) || !finite(message.sigma)) return {};
  return SmoothedState{.utime = message.utime,
                       .p_WB = vector(message.p_WB),
                       .q_WB = quaternion(message.q_WB),
                       .nu = vector(message.nu),
                       .nu_dot = vector(message.nu_dot),
                       .sigma = vector(message.sigma)};
}

fathom_lcm::smoothed_t encode(const SmoothedState& sample) {
  fathom_lcm::smoothed_t message{};
  message.utime = sample.utime;
  put(sample.p_WB, message.p_WB);
  put(sample.q_WB, message.q_WB);
  put(sample.nu, message.nu);
  put(sample.nu_dot, message.nu_dot);
  put(sample.sigma, message.sigma);
  return message;
}

std::optional<ModelEstimate> decode(const fathom_lcm::model_t& message) {
  if (!length(message.n_parameters, message.parameters.size())) return {};
  if (!length(message.n_effects, message.effects.size())) return {};
  if (!length(message.n_effect_numbers, message.effect_numbers.size())) return {};
  if (!length(message.n_modes, message.modes.size()) || !length(message.n_frozen, message.frozen.size())) return {};
  if (!length(message.n_covariance, message.covariance.size()) || !finite(message.covariance)) return {};
  if (!finite(message.residual_ratio) || !finite(message.residual_mean) || !finite(message.residual_excess)) return {};
  ModelEstimate sample{
      .utime = message.utime, .parameters = {}, .effects = message.effects, .updates = message.updates};
  if (!take(message.parameters, sample.parameters) || !take(message.effect_numbers, sample.effect_numbers)) return {};
  for (const auto& part : message.modes) {
    if (!finite(part.sum) || !finite(part.scaled)) return {};
    sample.modes.push_back({.mode = part.mode, .sum = part.sum, .scaled = part.scaled});
  }
  sample.covariance = message.covariance;
  sample.residual_ratio = vector(message.residual_ratio);
  sample.residual_mean = vector(message.residual_mean);
  sample.residual_excess = vector(message.residual_excess);
  sample.frozen = message.frozen;
  sample.joint = message.joint != 0;
  return sample;
}

fathom_lcm::model_t encode(const ModelEstimate& sample) {
  fathom_lcm::model_t message{};
  message.utime = sample.utime;
  message.n_parameters = count(sample.parameters);
  put(sample.parameters, message.parameters);
  message.n_effect_numbers = count(sample.effect_numbers);
  put(sample.effect_numbers, message.effect_numbers);
  message.n_effects = count(sample.effects);
  message.effects = sample.effects;
  message.updates = sample.updates;
  message.n_modes = count(sample.modes);
  for (const ModeMetric& part : sample.modes) {
    auto& to = message.modes.emplace_back();
    to.mode = part.mode;
    to.sum = part.sum;
    to.scaled = part.scaled;
  }
  message.n_covariance = count(sample.covariance);
  message.covariance = sample.covariance;
  put(sample.residual_ratio, message.residual_ratio);
  put(sample.residual_mean, message.residual_mean);
  put(sample.residual_excess, message.residual_excess);
  message.n_frozen = count(sample.frozen);
  message.frozen = sample.frozen;
  message.joint = sample.joint;
  return message;
}

std::optional<Residual> decode(const fathom_lcm::residual_t& message) {
  if (!finite(message.wrench)) return {};
  return Residual{.utime = message.utime, .wrench = vector(message.wrench)};
}

fathom_lcm::residual_t encode(const Residual& sample) {
  fathom_lcm::residual_t message{};
  message.utime = sample.utime;
  put(sample.wrench, message.wrench);
  return message;
}

std::optional<EffectRanking> decode(const fathom_lcm::effects_t& message) {
  if (!length(message.n_candidates, message.candidates.size())) return {};
  if (!finite(message.duration)) return {};
  EffectRanking sample{.utime = message.utime,
                       .verdict = message.verdict,
                       .candidates = {},
                       .against = message.against,
                       .segment = message.segment,
                       .duration = message.duration};
  sample.candidates.reserve(message.candidates.size());
  for (const auto& part : message.candidates) {
    if (!finite(part.log_odds) || !finite(part.error_reduction)) return {};
    if (!length(part.n_numbers, part.numbers.size()) || !finite(part.numbers)) return {};
    sample.candidates.push_back({.name = part.name,
                                 .log_odds = part.log_odds,
                                 .error_reduction = part.error_reduction,
                                 .variant = part.variant,
                                 .numbers = part.numbers});
  }
  return sample;
}

fathom_lcm::effects_t encode(const EffectRanking& sample) {
  fathom_lcm::effects_t message{};
  message.utime = sample.utime;
  message.verdict = sample.verdict;
  message.n_candidates = count(sample.candidates);
  for (const auto& part : sample.candidates) {
    auto& to = message.candidates.emplace_back();
    to.name = part.name;
    to.log_odds = part.log_odds;
    to.error_reduction = part.error_reduction;
    to.variant = part.variant;
    to.n_numbers = count(part.numbers);
    to.numbers = part.numbers;
  }
  message.against = sample.against;
  message.segment = sample.segment;
  message.duration = sample.duration;
  return message;
}

std::optional<LearnedTold> decode(const fathom_lcm::learned_t& message) {
  if (!length(message.n_numbers, message.numbers.size())) return {};
  if (!finite(message.log_odds) || !finite(message.size) || !finite(message.held_out)) return {};
  LearnedTold sample{.utime = message.utime,
                     .adopted = message.adopted != 0,
                     .log_odds = message.log_odds,
                     .size = message.size,
                     .held_out = message.held_out,
                     .words = message.words,
                     .equation = message.equation,
                     .numbers = {}};
  if (!take(message.numbers, sample.numbers)) return {};
  return sample;
}

fathom_lcm::learned_t encode(const LearnedTold& sample) {
  fathom_lcm::learned_t message{};
  message.utime = sample.utime;
  message.adopted = sample.adopted ? 1 : 0;
  message.log_odds = sample.log_odds;
  message.size = sample.size;
  message.held_out = sample.held_out;
  message.words = sample.words;
  message.equation = sample.equation;
  message.n_numbers = count(sample.numbers);
  put(sample.numbers, message.numbers);
  return message;
}

std::optional<Truth> decode(const fathom_lcm::truth_t& message) {
  if (!finite(message.p_WB) || !unit(message.q_WB) || !finite(message.nu)) return {};
  if (!finite(message.nu_dot) || !finite(message.v_WF) || !finite(message.tau_felt)) return {};
  return Truth{.utime = message.utime,
               .p_WB = vector(message.p_WB),
               .q_WB = quaternion(message.q_WB),
               .nu = vector(message.nu),
               .nu_dot = vector(message.nu_dot),
               .v_WF = vector(message.v_WF),
               .tau_felt = vector(message.tau_felt)};
}

fathom_lcm::truth_t encode(const Truth& sample) {
  fathom_lcm::truth_t message{};
  message.utime = sample.utime;
  put(sample.p_WB, message.p_WB);
  put(sample.q_WB, message.q_WB);
  put(sample.nu, message.nu);
  put(sample.nu_dot, message.nu_dot);
  put(sample.v_WF, message.v_WF);
  put(sample.tau_felt, message.tau_felt);
  return message;
}

std::optional<Health> decode(const fathom_lcm::health_t& message) {
  if (!finite(message.busy) || !finite(message.cpu)) return {};
  if (!length(message.n_channels, message.channels.size())) return {};
  std::vector<ChannelHealth> channels;
  for (const auto& part : message.channels) {
    if (!finite(part.rate) || !finite(part.age)) return {};
    channels.push_back({.channel = part.channel, .rate = part.rate, .age = part.age});
  }
  return Health{.utime = message.utime,
                .process = message.process,
                .host = message.host,
                .pid = message.pid,
                .start = message.start,
                .sequence = message.sequence,
                .state = message.state,
                .received = message.received,
                .published = message.published,
                .dropped = message.dropped,
                .rejected = message.rejected,
                .busy = message.busy,
                .cpu = message.cpu,
                .memory = message.memory,
                .detail = message.detail,
                .channels = std::move(channels)};
}

fathom_lcm::health_t encode(const Health& sample) {
  fathom_lcm::health_t message{};
  message.utime = sample.utime;
  message.process = sample.process;
  message.host = sample.host;
  message.pid = sample.pid;
  message.start = sample.start;
  message.sequence = sample.sequence;
  message.state = sample.state;
  message.received = sample.received;
  message.published = sample.published;
  message.dropped = sample.dropped;
  message.rejected = sample.rejected;
  message.busy = sample.busy;
  message.cpu = sample.cpu;
  message.memory = sample.memory;
  message.detail = sample.detail;
  message.n_channels = count(sample.channels);
  for (const ChannelHealth& part : sample.channels) {
    auto& to = message.channels.emplace_back();
    to.channel = part.channel;
    to.rate = part.rate;
    to.age = part.age;
  }
  return message;
}

std::optional<ProcessInfo> decode(const fathom_lcm::process_info_t& message) {
  return ProcessInfo{.utime = message.utime,
                     .process = message.process,
                     .version = message.version,
                     .config = message.config,
                     .channels = message.channels};
}

fathom_lcm::process_info_t encode(const ProcessInfo& sample) {
  fathom_lcm::process_info_t message{};
  message.utime = sample.utime;
  message.process = sample.process;
  message.version = sample.version;
  message.config = sample.config;
  message.channels = sample.channels;
  return message;
}

}  // namespace fathom::wire
