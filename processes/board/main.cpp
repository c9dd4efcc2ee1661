// board: a page for the engineer at the tank. It listens to the bus and shows what is said there; nothing can be
// commanded through it.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <memory>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/board/board.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "processes/board/http.hpp"

using namespace fathom;

namespace {

constexpr double kPeriod = 0.25;  // s between two texts; the page asks twice a second

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Options {
  std::string host{"127.0.0.1"};
  int port{8077};
  std::vector<std::string> names;
  bool serves{true};  ///< not when it is only asked for its --interface
};

template <class Message>
void show(runtime::Process& process, const char* channel, board::Board& board) {
  // A log that is played twice or a simulator's own time are no reason to start over: only arrival counts here.
  process.listens_to<Message>(channel, [&process, &board, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(channel);
    board.hear(*sample, seconds_now());
  });
}

void poll_for(std::span<const int> descriptors, int milliseconds) {
  std::vector<pollfd> all;
  for (const int each : descriptors) all.push_back({.fd = each, .events = POLLIN, .revents = 0});
  (void)::poll(all.data(), all.size(), milliseconds);
}

void run(runtime::Process& process, const Options& options) {
  if (process.reads_logs()) throw InputError("--in: the board shows a live bus; play the log with lcm-logplayer");
  const char* bus = std::getenv("LCM_DEFAULT_URL");
  board::Board board{{.host = runtime::host_name(), .pid = getpid(), .bus = bus == nullptr ? "" : bus}};
  runtime::Speakers speakers{runtime::host_name(), runtime::Speakers::Home::kAnywhere};
  process.listens_to<fathom_lcm::health_t>(wire::kHealth, [&](const fathom_lcm::health_t& message) {
    const auto health = wire::decode(message);
    if (!health || !speakers.believes(message)) return process.reject(wire::kHealth);
    board.hear(*health, seconds_now());
  });
  show<fathom_lcm::excitation_t>(process, wire::kExcitation, board);
  show<fathom_lcm::thrusters_t>(process, wire::kThrusters, board);
  show<fathom_lcm::wrench_command_t>(process, wire::kWrenchCommand, board);
  show<fathom_lcm::battery_t>(process, wire::kBattery, board);
  show<fathom_lcm::state_t>(process, wire::kState, board);
  show<fathom_lcm::model_t>(process, wire::kModel, board);
  show<fathom_lcm::effects_t>(process, wire::kEffects, board);
  std::unique_ptr<board::Server> server;
  double shown = 0.0;
  std::int64_t number = 0;
  if (options.serves) {
    server = std::make_unique<board::Server>(options.host, options.port, options.names);
    // Two people may look on: no board is another one's twin. It has this name from its first word on.
    process.goes_by("board@" + runtime::host_name() + ":" + std::to_string(server->port()));
    process.log_info("look at http://" + (options.host == "0.0.0.0" ? runtime::host_name() : options.host) + ":" +
                     std::to_string(server->port()) + "/");
  }
  process.waits_with([&](std::span<const int> descriptors, int milliseconds) {
    if (const double now = seconds_now(); now - shown >= kPeriod) {
      shown = now;
      server->show(board.json(now, ++number));
    }
    poll_for(descriptors, milliseconds);
  });
  process.run();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.serves = std::none_of(argv, argv + argc, [](const char* each) { return std::string{each} == "--interface"; });
  const runtime::Program program{"board", "Serves a page that shows a live trial."};
  return runtime::main(
      program, argc, argv, [&](runtime::Process& process) { run(process, options); },
      [&](runtime::CommandLine& app) {
        app.add_option("--port", options.port, "of the page (8077); 0: any that is free")->within(0, 65535);
        app.add_option("--host", options.host, "address to listen at (127.0.0.1: this host alone)");
        app.add_option("--name", options.names,
                       "by which browsers call this host, beside its addresses, its own name and localhost");
      });
}
