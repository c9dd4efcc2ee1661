// HEALTH: what a process says of itself once a second, and what it hears of another of its name.
#include <algorithm>
#include <fathom_lcm/health_t.hpp>
#include <utility>

#include "common/base/health_words.hpp"
#include "common/runtime/process_state.hpp"

namespace fathom::runtime {
namespace {

constexpr double kFlood = 1000.0;  // messages a second of one channel; five times the fastest instrument

}  // namespace

void Process::report_health(const std::string& state, const std::string& reason) {
  if (!state_->out || !state_->out->live()) return;
  const auto now = Clock::now();
  fathom_lcm::health_t health{};
  health.utime = wall_clock();
  health.process = state_->known_as;
  health.host = state_->host;
  health.pid = getpid();
  health.start = state_->start;
  health.sequence = ++state_->words;
  const Usage::Figures used = state_->usage.measure();
  health.cpu = used.cpu;
  health.memory = used.memory;
  health.state = state;
  health.detail = reason;
  Condition condition;
  if (state == "running") {
    if (state_->condition) condition = state_->condition();
    // In lockstep the wall's second falls anywhere in virtual time: nothing may follow from it, or two runs would
    // differ.
    if (state_->follower && !condition.unhealthy.empty())
      health.detail = kWithoutConsequence + std::exchange(condition.unhealthy, "") + "; ";
    const std::string twin = state_->twins.complaint(now);
    if (!twin.empty()) condition.unhealthy = twin + (condition.unhealthy.empty() ? "" : "; " + condition.unhealthy);
    if (!condition.unhealthy.empty()) {
      health.state = "unhealthy";
      health.detail = condition.unhealthy + "; ";
    }
  }
  health.received = state_->received;
  health.published = state_->published;
  const std::chrono::duration<double> elapsed = now - state_->last_health;
  const auto tell = [&](const Hearing& hearing, const char* what, std::int64_t count) {
    if (count > 0) health.detail += hearing.channel + " " + what + " " + std::to_string(count) + "; ";
  };
  for (std::size_t i = 0; i < state_->hearings.size(); ++i) {
    Hearing& hearing = state_->hearings[i];
    const bool counts = state_->live && !state_->follower;  // in lockstep every message is kept
    const auto dropped = counts ? static_cast<std::int64_t>(state_->live->dropped(i)) : 0;
    health.dropped += dropped;
    health.rejected += hearing.rejected;
    tell(hearing, "dropped", dropped);
    if (counts) tell(hearing, "skipped", static_cast<std::int64_t>(state_->live->skipped(i)));
    tell(hearing, "rejected", hearing.rejected);
    const double rate = static_cast<double>(std::exchange(hearing.arrived, 0)) / std::max(elapsed.count(), 0.1);
    const bool paced = !state_->follower && hearing.channel != kLockstepAck;  // lockstep is as fast as it can
    const std::chrono::duration<double> age = now - hearing.last.value_or(state_->begun);
    auto& channel = health.channels.emplace_back();
    channel.channel = hearing.channel;
    channel.rate = rate;
    channel.age = std::max(age.count(), 0.0);
    if (rate > kFlood && paced) tell(hearing, "flood, per second", static_cast<std::int64_t>(rate));
  }
  health.n_channels = static_cast<std::int32_t>(health.channels.size());
  if (!condition.detail.empty()) health.detail += condition.detail + "; ";
  health.busy = elapsed.count() > 0.0 ? std::chrono::duration<double>(state_->busy) / elapsed : 0.0;
  state_->busy = {};
  state_->last_health = now;
  publish(kHealthChannel, health);
}

// A second one of this name is told at once: two estimators make nonsense of each other's work.
void Process::watch_twins(std::span<const std::uint8_t> health) {
  const auto now = Clock::now();
  const bool known = !state_->twins.complaint(now).empty();
  state_->twins.hear(health, now);
  if (known || state_->twins.complaint(now).empty()) return;
  state_->logger.warn(state_->twins.complaint(now));
  report_health("running", "");
}

}  // namespace fathom::runtime
