// board: a page for the engineer at the tank. It listens to the bus and shows what is said there; the one order that
// can be given through it is to abort, which needs no key. It plays logs, too.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/learned_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/signing.hpp"
#include "common/board/board.hpp"
#include "common/orders/abort_watch.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/runtime/stop_signal.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "common/wire/signature.hpp"
#include "common/wire/vehicle.hpp"
#include "processes/board/http.hpp"
#include "processes/board/replay.hpp"

using namespace fathom;

namespace {

constexpr double kPeriod = 0.25;  // s between two texts; the page asks twice a second
constexpr int kTick = 50;         // ms between two looks at a log that is played

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

struct Options {
  std::string host{"127.0.0.1"};
  int port{8077};
  std::vector<std::string> names;
  std::string replay;
  double speed{1.0};
  bool serves{true};  ///< not when it is only asked for its --interface
};

/// Where messages come from: a live bus or a log that is played; `now` [s] is the time on the page.
struct Source {
  runtime::Process& process;
  board::Replay* replay;
  std::function<double()> now;
};

/// use(message) for every message of a channel; false: it is refused.
template <class Message, class Use>
void each(const Source& source, const char* channel, Use use) {
  if (source.replay != nullptr) {
    source.replay->on(channel, [use](std::span<const std::uint8_t> bytes) {
      if (const auto message = runtime::message_of<Message>(bytes)) static_cast<void>(use(*message));
    });
    return;
  }
  // A log that is played twice or a simulator's own time are no reason to start over: only arrival counts here.
  source.process.listens_to<Message>(channel, [&process = source.process, channel, use](const Message& message) {
    if (!use(message)) process.reject(channel);
  });
}

/// Who has pressed ABORT on a page is told what became of it.
class Aborting {
 public:
  Aborting(runtime::Process& process, board::Board& board) : process_{process}, board_{board} {}

  void press() {
    if (!watch_) watch_.emplace(unforeseeable(), seconds_now());
    board_.tell_abort("asked", "", seconds_now());
    process_.log_warning("ABORT was pressed on a page");
    look();
  }
  void look() {
    if (!watch_) return;
    const double now = seconds_now();
    if (watch_->speaks(now))
      process_.publish(wire::kOperator,
                       wire::encode({.utime = wall_clock(), .sequence = watch_->number(), .abort = true}));
    const auto outcome = watch_->outcome(now);
    if (!outcome) return;
    board_.tell_abort(outcome->confirmed ? "confirmed" : "not confirmed", outcome->text, now);
    process_.log_warning(outcome->text);
    watch_.reset();
  }
  template <class Sample>
  void hear(const Sample& sample) {
    if (watch_) watch_->hear(sample);
  }

 private:
  runtime::Process& process_;
  board::Board& board_;
  std::optional<orders::AbortWatch> watch_;
};

void listen(const Source& source, board::Board& board, runtime::Speakers& speakers, Aborting& aborting) {
  const auto show = [&]<class Message>(const char* channel) {
    each<Message>(source, channel, [&board, now = source.now](const Message& message) {
      const auto sample = wire::decode(message);
      if (sample) board.hear(*sample, now());
      return sample.has_value();
    });
  };
  const bool live = source.replay == nullptr;
  each<fathom_lcm::health_t>(source, wire::kHealth, [&, live, now = source.now](const fathom_lcm::health_t& message) {
    const auto health = wire::decode(message);
    if (!health || (live && !speakers.believes(message))) return false;
    board.hear(*health, now());
    return true;
  });
  each<fathom_lcm::answer_t>(source, wire::kAnswer, [&, now = source.now](const fathom_lcm::answer_t& message) {
    const auto answer = wire::open(message, Key{});  // the board has no key: answers are shown, and give nothing
    if (!answer) return false;
    board.hear(*answer, now());
    aborting.hear(*answer);
    return true;
  });
  each<fathom_lcm::thrusters_t>(source, wire::kThrusters, [&, now = source.now](const auto& message) {
    const auto sample = wire::decode(message);
    if (!sample) return false;
    board.hear(*sample, now());
    aborting.hear(*sample);
    return true;
  });
  each<fathom_lcm::vehicle_condition_t>(source, wire::kVehicle, [&, now = source.now](const auto& message) {
    const auto sample = wire::decode(message);
    if (!sample) return false;
    board.hear(*sample, now());
    aborting.hear(*sample);
    return true;
  });
  show.operator()<fathom_lcm::excitation_t>(wire::kExcitation);
  show.operator()<fathom_lcm::wrench_command_t>(wire::kWrenchCommand);
  show.operator()<fathom_lcm::battery_t>(wire::kBattery);
  show.operator()<fathom_lcm::state_t>(wire::kState);
  show.operator()<fathom_lcm::model_t>(wire::kModel);
  show.operator()<fathom_lcm::effects_t>(wire::kEffects);
  show.operator()<fathom_lcm::learned_t>(wire::kLearned);
  show.operator()<fathom_lcm::residual_t>(wire::kResidual);
  show.operator()<fathom_lcm::process_info_t>(wire::kProcessInfo);
}

void poll_for(std::span<const int> descriptors, int more, int milliseconds) {
  std::vector<pollfd> all;
  for (const int each : descriptors) all.push_back({.fd = each, .events = POLLIN, .revents = 0});
  if (more >= 0) all.push_back({.fd = more, .events = POLLIN, .revents = 0});
  (void)::poll(all.data(), all.size(), milliseconds);
}

void tell_address(runtime::Process& process, const Options& options, const board::Server& server) {
  process.log_info("look at http://" + (options.host == "0.0.0.0" ? runtime::host_name() : options.host) + ":" +
                   std::to_string(server.port()) + "/");
}

/// The log as the trial went; at its end the page stays.
void play(runtime::Process& process, const Options& options, board::Board& board, board::Replay& replay) {
  runtime::StopSignal stop;  // before the server's thread begins
  board::Server server{options.host, options.port, options.names, false};
  tell_address(process, options, server);
  const double begin = seconds_now();
  double shown = -kPeriod;
  std::int64_t number = 0;
  while (!stop.raised()) {
    const double elapsed = seconds_now() - begin;
    replay.play(elapsed);
    if (elapsed - shown >= kPeriod) {
      shown = elapsed;
      board.tell_replay({.at = replay.at(), .length = replay.length(), .over = replay.over()});
      board.watch(replay.at());
      server.show(board.json(replay.at(), ++number));
    }
    poll_for({}, stop.descriptor(), kTick);
  }
}

void run(runtime::Process& process, const Options& options) {
  if (process.reads_logs()) throw InputError("--in: the board shows a live bus; --replay RUN.lcmlog shows a log");
  const char* bus = std::getenv("LCM_DEFAULT_URL");
  board::Board board{{.host = runtime::host_name(),
                      .pid = options.replay.empty() ? getpid() : 0,
                      .bus = !options.replay.empty() ? options.replay
                             : bus == nullptr        ? ""
                                                     : bus}};
  for (const char* key : {"dof", "site", "supervisor"}) {
    if (process.has_config(key)) board.take(Config::load(process.config_path(key)));
  }
  std::optional<board::Replay> replay;
  if (!options.replay.empty()) replay.emplace(options.replay, options.speed);
  runtime::Speakers speakers{runtime::host_name(), runtime::Speakers::Home::kAnywhere};
  Aborting aborting{process, board};
  listen({process, replay ? &*replay : nullptr, [&]() -> double { return replay ? replay->at() : seconds_now(); }},
         board, speakers, aborting);
  if (replay) return play(process, options, board, *replay);
  process.publishes<fathom_lcm::operator_t>(wire::kOperator);
  std::unique_ptr<board::Server> server;
  double shown = 0.0;
  std::int64_t number = 0;
  if (options.serves) {
    server = std::make_unique<board::Server>(options.host, options.port, options.names);
    // Two people may look on: no board is another one's twin. It has this name from its first word on.
    process.goes_by("board@" + runtime::host_name() + ":" + std::to_string(server->port()));
    tell_address(process, options, *server);
  }
  process.waits_with([&](std::span<const int> descriptors, int milliseconds) {
    if (server->taken()) aborting.press();
    aborting.look();
    if (const double now = seconds_now(); now - shown >= kPeriod) {
      shown = now;
      board.watch(now);
      server->show(board.json(now, ++number));
    }
    poll_for(descriptors, server->aborts(), milliseconds);
  });
  process.run();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.serves = std::none_of(argv, argv + argc, [](const char* each) { return std::string{each} == "--interface"; });
  const runtime::Program program{"board", "Serves a page that shows a live trial, or a log of one."};
  return runtime::main(
      program, argc, argv, [&](runtime::Process& process) { run(process, options); },
      [&](runtime::CommandLine& app) {
        app.add_option("--port", options.port, "of the page (8077); 0: any that is free")->within(0, 65535);
        app.add_option("--host", options.host, "address to listen at (127.0.0.1: this host alone)");
        app.add_option("--name", options.names,
                       "by which browsers call this host, beside its addresses, its own name and localhost");
        app.add_option("--replay", options.replay, "RUN.lcmlog: shows this log as the trial went, in place of a bus");
        app.add_option("--speed", options.speed, "with --replay: so many times as fast (1)")->within(0.01, 1000.0);
      });
}
