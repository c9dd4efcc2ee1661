#include "common/runtime/lockstep.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/recorder.hpp"

namespace fathom::runtime {
namespace {

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& each : names) text += (text.empty() ? "" : ", ") + each;
  return text;
}

}  // namespace

bool is_free_channel(const std::string& channel) {
  return std::ranges::find(kFreeChannels, channel) != std::end(kFreeChannels);
}

bool travels_alone(const std::string& channel) { return is_free_channel(channel) || is_picture(channel); }

void Said::add(const std::string& name, std::span<const std::uint8_t> message) {
  const bool alone = travels_alone(name);
  channel.push_back(name);
  size.push_back(alone ? 0 : static_cast<std::int32_t>(message.size()));
  if (!alone) bytes.insert(bytes.end(), message.begin(), message.end());
}

std::vector<std::span<const std::uint8_t>> enclosed(const fathom_lcm::lockstep_t& phase) {
  std::vector<std::span<const std::uint8_t>> messages;
  messages.reserve(phase.channel.size());
  std::span<const std::uint8_t> left = phase.bytes;
  for (std::size_t i = 0; i < phase.channel.size(); ++i) {
    const std::int32_t size = i < phase.size.size() ? phase.size[i] : 0;
    if (size < 0 || static_cast<std::size_t>(size) > left.size()) {
      throw InputError(
          "LOCKSTEP: a phase whose sizes are not those of its messages; is every process of the same build?");
    }
    messages.push_back(left.first(static_cast<std::size_t>(size)));
    left = left.subspan(static_cast<std::size_t>(size));
  }
  return messages;
}

Follower::Follower(std::string name, std::vector<std::string> heard)
    : name_{std::move(name)}, heard_{std::move(heard)}, waiting_(heard_.size()) {}

bool Follower::heard(const std::string& channel) const {
  return std::find(heard_.begin(), heard_.end(), channel) != heard_.end();
}

void Follower::arrived(std::size_t hearing, std::vector<std::uint8_t> bytes) {
  waiting_[hearing].push_back(std::move(bytes));
}

void Follower::announced(const fathom_lcm::lockstep_t& phase) {
  started_ = true;
  if (phase.phase < 0) {
    const bool all = phase.channel.empty();
    if (!all && phase.channel.front() != name_) return;
    ends_ = true;
    answer_ = {};
    said_ = {};
    answer_.utime = phase.utime;
    answer_.process = name_;
    answer_.tick = phase.tick;
    answer_.phase = phase.phase;
  } else if (std::any_of(phase.channel.begin(), phase.channel.end(), [&](const auto& each) { return heard(each); })) {
    phases_.push_back(phase);
  }
}

std::optional<std::vector<Follower::Message>> Follower::next() {
  if (phases_.empty()) return {};
  const fathom_lcm::lockstep_t& phase = phases_.front();
  const std::vector<std::span<const std::uint8_t>> bodies = enclosed(phase);
  std::vector<std::size_t> wanted(heard_.size(), 0);
  struct Entry {
    std::size_t hearing;
    std::span<const std::uint8_t> body;
  };
  std::vector<Entry> order;
  for (std::size_t i = 0; i < phase.channel.size(); ++i) {
    const auto found = std::find(heard_.begin(), heard_.end(), phase.channel[i]);
    if (found == heard_.end()) continue;
    order.push_back({static_cast<std::size_t>(found - heard_.begin()), bodies[i]});
    if (bodies[i].empty()) ++wanted[order.back().hearing];
  }
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    if (waiting_[i].size() < wanted[i]) return {};
  }
  std::vector<Message> messages;
  const auto take = [&](std::size_t hearing) {
    messages.push_back({hearing, std::move(waiting_[hearing].front())});
    waiting_[hearing].pop_front();
  };
  // What came from outside of lockstep, an operator's word, goes first; the conductor's own keeps its place.
  for (std::size_t i = 0; i < heard_.size() && phase.phase == 0; ++i) {
    while (is_free_channel(heard_[i]) && waiting_[i].size() > wanted[i]) take(i);
  }
  for (const Entry& each : order) {
    if (each.body.empty()) {
      take(each.hearing);
    } else {
      messages.push_back({each.hearing, {each.body.begin(), each.body.end()}});
    }
  }
  answer_ = {};
  said_ = {};
  answer_.utime = phase.utime;
  answer_.process = name_;
  answer_.tick = phase.tick;
  answer_.phase = phase.phase;
  phases_.pop_front();
  return messages;
}

void Follower::said(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (!is_free_channel(channel)) said_.add(channel, bytes);
}

fathom_lcm::lockstep_ack_t Follower::answer() {
  answer_.said = std::move(said_.channel);
  answer_.size = std::move(said_.size);
  answer_.bytes = std::move(said_.bytes);
  said_ = {};
  answer_.n_said = static_cast<std::int32_t>(answer_.said.size());
  answer_.n_bytes = static_cast<std::int32_t>(answer_.bytes.size());
  answer_.n_heard = 0;
  return answer_;
}

fathom_lcm::lockstep_ack_t Follower::hello() const {
  fathom_lcm::lockstep_ack_t ack{};
  ack.process = name_;
  ack.tick = -1;
  ack.n_heard = static_cast<std::int32_t>(heard_.size());
  ack.heard = heard_;
  return ack;
}

Conductor::Conductor(std::vector<std::string> names) : names_{std::move(names)} { phase_.tick = -1; }

std::vector<std::string> Conductor::absent() const {
  std::vector<std::string> missing;
  for (const std::string& name : names_) {
    if (!heard_.contains(name)) missing.push_back(name);
  }
  return missing;
}

void Conductor::hear(const fathom_lcm::lockstep_ack_t& ack) {
  const bool known = std::find(names_.begin(), names_.end(), ack.process) != names_.end();
  if (!known && ending_.empty()) {
    throw InputError("lockstep: " + ack.process + " follows but nobody waits for it; name it with --wait-for");
  }
  if (ack.tick < 0) {
    if (phase_.tick >= 0) {
      // Hellos overlap with the first intervals; a process that answered once and says hello again has restarted.
      const auto recorder = recorded_.find(ack.process);
      if (said_.contains(ack.process) || (recorder != recorded_.end() && recorder->second >= 0)) {
        throw InputError("lockstep: " + ack.process +
                         " was started anew in the middle of the run; begin the run again");
      }
      return;
    }
    heard_[ack.process] = ack.heard;
    if (ack.heard == std::vector<std::string>{kEveryChannel}) recorded_[ack.process] = -1;
    return;
  }
  if (const auto recorder = recorded_.find(ack.process); recorder != recorded_.end()) {
    recorder->second = ack.tick;
    return;
  }
  if (ack.tick != phase_.tick || ack.phase != phase_.phase) return;
  const auto asked = std::find(waiting_for_.begin(), waiting_for_.end(), ack.process);
  if (asked == waiting_for_.end()) {
    throw InputError("lockstep: two processes answer as " + ack.process + "; stop one of them");
  }
  waiting_for_.erase(asked);
  said_[ack.process] = {ack.said, ack.size, ack.bytes};
  for (const std::string& channel : ack.said) ++total_[channel];
  answered_ = waiting_for_.empty();
}

// Who hears a channel of the phase must answer.
void Conductor::call() {
  waiting_for_.clear();
  answered_ = false;
  for (const std::string& name : names_) {
    const std::vector<std::string>& heard = heard_[name];
    const bool concerned = std::any_of(phase_.channel.begin(), phase_.channel.end(), [&](const std::string& channel) {
      return std::find(heard.begin(), heard.end(), channel) != heard.end();
    });
    if (concerned) waiting_for_.push_back(name);
  }
  phase_.n_messages = static_cast<std::int32_t>(phase_.channel.size());
  phase_.n_bytes = static_cast<std::int32_t>(phase_.bytes.size());
}

void Conductor::clear() {
  phase_.channel.clear();
  phase_.size.clear();
  phase_.bytes.clear();
}

void Conductor::enclose(Said&& said) {
  said.size.resize(said.channel.size(), 0);
  phase_.channel.insert(phase_.channel.end(), said.channel.begin(), said.channel.end());
  phase_.size.insert(phase_.size.end(), said.size.begin(), said.size.end());
  phase_.bytes.insert(phase_.bytes.end(), said.bytes.begin(), said.bytes.end());
  said = {};
}

fathom_lcm::lockstep_t Conductor::begin(Utime utime, Said said) {
  phase_.utime = utime;
  ++phase_.tick;
  phase_.phase = 0;
  clear();
  enclose(std::move(said));
  call();
  return phase_;
}

std::optional<fathom_lcm::lockstep_t> Conductor::next() {
  if (!answered_) return {};
  answered_ = false;
  clear();
  std::vector<std::string> speakers = names_;
  if (phase_.phase < 0) speakers.push_back(ending_);
  for (const std::string& name : speakers) {
    if (const auto said = said_.find(name); said != said_.end()) enclose(std::move(said->second));
  }
  ++phase_.phase;
  call();
  if (waiting_for_.empty() && (recorded_.empty() || phase_.channel.empty())) return {};
  return phase_;
}

// A recorder is not waited for in each interval, but it must not fall behind what the bus can hold.
bool Conductor::over() const {
  return waiting_for_.empty() && !answered_ && std::all_of(recorded_.begin(), recorded_.end(), [&](const auto& each) {
           return each.second + kRecorderBehind > phase_.tick;
         });
}

std::int64_t Conductor::said(const std::string& channel) const {
  const auto found = total_.find(channel);
  return found == total_.end() ? 0 : found->second;
}

std::string Conductor::waiting_for() const {
  if (!waiting_for_.empty()) return list(waiting_for_);
  return recorded_.empty() ? "anybody" : recorded_.begin()->first;
}

std::optional<fathom_lcm::lockstep_t> Conductor::finish(Utime utime) {
  const auto next =
      std::find_if(names_.begin(), names_.end(), [&](const auto& name) { return !recorded_.contains(name); });
  if (next == names_.end()) {
    if (std::exchange(finished_, true)) return {};
    return end(utime);
  }
  phase_.utime = utime;
  ++phase_.tick;
  phase_.phase = -1;
  clear();
  phase_.channel = {*next};
  phase_.size = {0};
  phase_.n_messages = 1;
  phase_.n_bytes = 0;
  waiting_for_ = {*next};
  names_.erase(next);
  ending_ = waiting_for_.front();
  return phase_;
}

fathom_lcm::lockstep_t Conductor::end(Utime utime) const {
  fathom_lcm::lockstep_t last{};
  last.utime = utime;
  last.tick = phase_.tick + 1;
  last.phase = -1;
  return last;
}

}  // namespace fathom::runtime
