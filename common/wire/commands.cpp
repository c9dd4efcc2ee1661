// What is asked of the vehicle, and what became of it (common/samples/commands.hpp), declared in minds.hpp.
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/wire/minds.hpp"
#include "common/wire/plausible.hpp"

namespace fathom::wire {

std::optional<WrenchCommand> decode(const fathom_lcm::wrench_command_t& message) {
  if (!finite(message.tau) || !finite(message.life)) return {};
  return WrenchCommand{.utime = message.utime,
                       .tau = vector(message.tau),
                       .life = message.life,
                       .commander = message.commander,
                       .armed_by = message.armed_by,
                       .challenge = message.challenge,
                       .sequence = message.sequence};
}

fathom_lcm::wrench_command_t encode(const WrenchCommand& sample) {
  fathom_lcm::wrench_command_t message{};
  message.utime = sample.utime;
  put(sample.tau, message.tau);
  message.life = sample.life;
  message.commander = sample.commander;
  message.armed_by = sample.armed_by;
  message.challenge = sample.challenge;
  message.sequence = sample.sequence;
  return message;
}

std::optional<Operator> decode(const fathom_lcm::operator_t& message) {
  // An abort must never be refused for a bad number that nobody will use.
  const bool usable = finite(message.tau) && finite(message.duration) && finite(message.attends);
  if (!usable && message.abort == 0) return {};
  return Operator{.utime = message.utime,
                  .sequence = message.sequence,
                  .challenge = message.challenge,
                  .abort = message.abort != 0,
                  .enable = message.enable != 0,
                  .order = message.order,
                  .tau = usable ? vector(message.tau) : Vector6d(Vector6d::Zero()),
                  .segment = message.segment,
                  .duration = usable ? message.duration : 0.0,
                  .attends = usable ? message.attends : 0.0};
}

fathom_lcm::operator_t encode(const Operator& sample) {
  fathom_lcm::operator_t message{};
  message.utime = sample.utime;
  message.sequence = sample.sequence;
  message.challenge = sample.challenge;
  message.abort = sample.abort;
  message.enable = sample.enable;
  message.order = sample.order;
  put(sample.tau, message.tau);
  message.segment = sample.segment;
  message.duration = sample.duration;
  message.attends = sample.attends;
  return message;
}

std::optional<Answer> decode(const fathom_lcm::answer_t& message) {
  return Answer{.utime = message.utime,
                .process = message.process,
                .gate = message.gate != 0,
                .challenge = message.challenge,
                .accepted = message.accepted,
                .sequence = message.sequence,
                .done = message.done != 0,
                .armed = message.armed != 0,
                .text = message.text};
}

fathom_lcm::answer_t encode(const Answer& sample) {
  fathom_lcm::answer_t message{};
  message.utime = sample.utime;
  message.process = sample.process;
  message.gate = sample.gate;
  message.challenge = sample.challenge;
  message.accepted = sample.accepted;
  message.sequence = sample.sequence;
  message.done = sample.done;
  message.armed = sample.armed;
  message.text = sample.text;
  return message;
}

std::optional<Excitation> decode(const fathom_lcm::excitation_t& message) {
  if (!finite(message.elapsed) || !finite(message.duration) || !finite(message.probe)) return {};
  if (!finite(message.metric) || !finite(message.threshold)) return {};
  if (!length(message.n_frozen, message.frozen.size())) return {};
  return Excitation{.utime = message.utime,
                    .active = message.active != 0,
                    .signal = message.signal,
                    .reason = message.reason,
                    .elapsed = message.elapsed,
                    .duration = message.duration,
                    .probe = vector(message.probe),
                    .mode = message.mode,
                    .phase = message.phase,
                    .metric = message.metric,
                    .threshold = message.threshold,
                    .missing = message.missing,
                    .bent = message.bent != 0,
                    .frozen = message.frozen};
}

fathom_lcm::excitation_t encode(const Excitation& sample) {
  fathom_lcm::excitation_t message{};
  message.utime = sample.utime;
  message.active = sample.active;
  message.signal = sample.signal;
  message.reason = sample.reason;
  message.elapsed = sample.elapsed;
  message.duration = sample.duration;
  put(sample.probe, message.probe);
  message.mode = sample.mode;
  message.phase = sample.phase;
  message.metric = sample.metric;
  message.threshold = sample.threshold;
  message.missing = sample.missing;
  message.bent = sample.bent;
  message.n_frozen = count(sample.frozen);
  message.frozen = sample.frozen;
  return message;
}

}  // namespace fathom::wire
