#include "common/runtime/recorder.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <limits>

#include "common/base/error.hpp"
#include "common/runtime/arguments.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/live_recorder.hpp"
#include "common/runtime/lockstep.hpp"
#include "common/runtime/record_file.hpp"
#include "common/runtime/stop_signal.hpp"

namespace fathom::runtime {
namespace {

constexpr int kWaitMs = 50;

/// What a recorder must hear itself: all else is enclosed in LOCKSTEP.
std::vector<Subscription> subscriptions(const std::vector<std::string>& without) {
  std::vector<Subscription> found{{kLockstep, std::numeric_limits<std::size_t>::max()}};
  std::vector<std::string> alone{std::begin(kFreeChannels), std::end(kFreeChannels)};
  alone.insert(alone.end(), std::begin(kPictures), std::end(kPictures));
  for (const std::string& channel : alone) {
    if (std::ranges::find(without, channel) == without.end()) {
      found.push_back({channel, std::numeric_limits<std::size_t>::max()});
    }
  }
  return found;
}

void run(const Arguments& arguments, const std::string& path, const std::vector<std::string>& without) {
  StopSignal stop;
  RecordFile log{path};
  Output bus{arguments.out};
  const std::vector<Subscription> heard = subscriptions(without);
  LiveInput live{arguments.in, heard};
  Arrangement arrangement{[&](const std::string& channel, std::vector<std::uint8_t>& bytes, Utime utime) {
                            log.write(channel, bytes, utime);
                          },
                          {without.begin(), without.end()}};
  Utime newest = 0;  // virtual
  const auto tell = [&](std::int64_t tick) {
    fathom_lcm::lockstep_ack_t ack{};
    ack.utime = newest;
    ack.process = "recorder";
    ack.tick = tick;
    if (tick < 0) {
      ack.n_heard = 1;
      ack.heard = {kEveryChannel};
    }
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(ack.getEncodedSize()));
    ack.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    bus.write(kLockstepAck, bytes, newest);
  };
  RecorderHealth health{bus};
  tell(-1);
  auto last_hello = std::chrono::steady_clock::now();
  std::int64_t told = -1;
  bool started = false;
  const auto serve = [&] {
    live.wait(stop.descriptor(), kWaitMs);
    while (auto message = live.next()) {
      health.heard();
      const std::string& channel = heard[message->subscription].channel;
      if (channel != kLockstep) {
        arrangement.arrived(channel, std::move(message->bytes));
        continue;
      }
      fathom_lcm::lockstep_t phase{};
      const int length = static_cast<int>(message->bytes.size());
      if (phase.decode(message->bytes.data(), 0, length) != length) continue;
      started = true;
      newest = phase.utime;
      arrangement.announced(phase);
    }
    if (arrangement.tick() >= told + Conductor::kRecorderEvery) tell(told = arrangement.tick());
    const auto now = std::chrono::steady_clock::now();
    health.tell("", std::to_string(arrangement.written()) + " messages written");
    if (!started && now - last_hello >= std::chrono::milliseconds{200}) {
      last_hello = now;
      tell(-1);
    }
  };
  try {
    while (!stop.raised() && !arrangement.ended()) serve();
    log.keep();
  } catch (const std::exception& error) {  // a full disk: who watches shall know at once
    health.end("fault", error.what());
    throw;
  }
  health.end("stopped", "");
}

}  // namespace

void Arrangement::put(const std::string& channel, Utime utime) {
  auto& waiting = waiting_[channel];
  write_(channel, waiting.front(), utime);
  waiting.pop_front();
  ++count_;
}

void Arrangement::arrived(const std::string& channel, std::vector<std::uint8_t> bytes) {
  if (without_.contains(channel)) return;
  waiting_[channel].push_back(std::move(bytes));
  write_complete();
}

void Arrangement::announced(const fathom_lcm::lockstep_t& phase) {
  if (phase.phase < 0) {
    ended_ = ended_ || phase.channel.empty();  // else one process ends, and its last words are announced
  } else {
    Phase& told = phases_.emplace_back(Phase{phase.utime, phase.tick, phase.phase, {}});
    const auto bodies = enclosed(phase);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (without_.contains(phase.channel[i])) continue;
      told.messages.push_back({phase.channel[i], {bodies[i].begin(), bodies[i].end()}});
    }
  }
  write_complete();
}

void Arrangement::write_complete() {
  while (!phases_.empty()) {
    Phase& phase = phases_.front();
    std::map<std::string, std::size_t> wanted;
    for (const Message& each : phase.messages) {
      if (each.bytes.empty()) ++wanted[each.channel];
    }
    for (const auto& [channel, count] : wanted) {
      if (waiting_[channel].size() < count) return;
    }
    utime_ = phase.utime;
    for (auto& [channel, messages] : waiting_) {  // from outside of lockstep: an operator, health
      while (phase.number == 0 && is_free_channel(channel) && messages.size() > wanted[channel]) put(channel, utime_);
    }
    for (Message& each : phase.messages) {
      if (each.bytes.empty()) {
        put(each.channel, utime_);
      } else {
        write_(each.channel, each.bytes, utime_);
        ++count_;
      }
    }
    if (phase.number == 0) tick_ = phase.tick;
    phases_.pop_front();
  }
  if (!ended_) return;
  for (auto& [channel, messages] : waiting_) {
    while (is_free_channel(channel) && !messages.empty()) put(channel, utime_);
  }
}

int recorder_main(int argc, const char* const* argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is told by what the write returns
  spdlog::logger logger{"recorder", std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
  logger.set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  try {
    std::string path;
    bool number{false};
    std::vector<std::string> without;
    const Program program{"recorder", "Writes all messages of a bus to a log."};
    const auto arguments = Arguments::parse(program, argc, argv, [&](CommandLine& app) {
      app.add_option("--file", path, "the log to be written");
      app.add_flag("--number", number, "add .00, .01, ... to its name, the next number");
      app.add_option("--without", without, "a channel that is not recorded; more than once if wanted")
          ->take_all()
          ->expected(1);
    });
    if (!arguments) return 0;
    if (arguments->interface_only) {
      std::cout << "hears every channel\n";
      return 0;
    }
    if (path.empty()) throw InputError("--file is missing: the log to be written");
    if (!arguments->in.front().live()) throw InputError("--in: a recorder hears a live bus");
    if (arguments->lockstep) {
      run(*arguments, path, without);
    } else {
      record_live(arguments->in, arguments->out, path, number, without);
    }
    return 0;
  } catch (const std::exception& error) {
    logger.critical(error.what());
    return 1;
  }
}

}  // namespace fathom::runtime
