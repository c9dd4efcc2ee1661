// fathom bus: what a live bus loses and how long it takes, until Ctrl-C: messages by LCM's sequence numbers, the raw
// round trip beside the way from an instrument's message to MODEL, and what every process uses. Beside its pings it
// only listens.
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <map>
#include <memory>

#include "common/runtime/command_line.hpp"
#include "common/runtime/stop_signal.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "processes/fathom/bus/bus_packets.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

using Clock = std::chrono::steady_clock;
using runtime::message_of;

constexpr char kPing[] = "BUS_PING", kPong[] = "BUS_PONG";
constexpr std::size_t kPingSize = 200;  // B, as most messages
constexpr double kPingPeriod = 0.1;     // s
constexpr std::size_t kRemembered = 5000;

struct BusOptions {
  std::string url{"udpm://239.255.76.67:7667?ttl=0"};
  double seconds{0.0};
};

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Answers every ping, as a process of its own: what is measured is two ways between two processes.
[[noreturn]] void echo(const runtime::Url& url, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  runtime::LiveInput input{{url}, {{kPing, 100}}};
  runtime::Output output{url};
  while (true) {
    input.wait(-1, 1000);
    while (auto message = input.next()) output.write(kPong, message->bytes, 0);
  }
}

/// One line of milliseconds.
void tell(const char* what, std::vector<double> seconds) {
  if (seconds.empty()) return;
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](double share) {
    return 1e3 *
           seconds[std::min(seconds.size() - 1, static_cast<std::size_t>(share * static_cast<double>(seconds.size())))];
  };
  std::printf("| %s | %.3f | %.3f | %.3f | %zu |\n", what, at(0.5), at(0.99), 1e3 * seconds.back(), seconds.size());
}

struct Figures {
  std::vector<std::pair<double, std::int64_t>> memory;  ///< when, B
  double cpu{};
  std::int64_t received{}, dropped{}, rejected{};
};

class Listener {
 public:
  explicit Listener(const BusOptions& options)
      : url_{runtime::Url::parse(options.url, "--bus")},
        packets_{options.url},
        input_{{url_},
               {{kPong, 100},
                {wire::kAhrs, 1000},
                {wire::kState, 1000},
                {wire::kThrusters, 1000},
                {wire::kModel, 1000},
                {wire::kHealth, 1000}}},
        output_{url_} {}

  void round() {
    if (since(pinged_) > kPingPeriod) ping();
    input_.wait(packets_.descriptor(), 20);
    packets_.read();
    while (const auto message = input_.next()) hear(message->subscription, message->bytes);
  }

  void report() const {
    packets_.report(since(begun_));
    std::printf("\n| latency, ms | median | 99 %% | largest | of |\n|---|---|---|---|---|\n");
    tell("raw LCM round trip, 200 B", trips_);
    tell("AHRS to STATE", states_);
    tell("AHRS to MODEL of the same time (it waits for the next THRUSTERS)", models_);
    tell("newest STATE or THRUSTERS to MODEL", answers_);
    std::printf(
        "\n| process | received | dropped | rejected | CPU | memory at 1/4, 1/2, 3/4, end, MB "
        "|\n|---|---|---|---|---|---|\n");
    for (const auto& [name, f] : processes_) {
      const double ends = f.memory.back().first, begins = f.memory.front().first;
      std::printf("| %s | %lld | %lld | %lld | %.0f %% |", name.c_str(), static_cast<long long>(f.received),
                  static_cast<long long>(f.dropped), static_cast<long long>(f.rejected),
                  100.0 * f.cpu / static_cast<double>(f.memory.size()));
      for (const double share : {0.25, 0.5, 0.75, 1.0}) {
        const auto found = std::find_if(f.memory.begin(), f.memory.end(), [&](const auto& each) {
          return each.first >= begins + share * (ends - begins);
        });
        std::printf(" %.1f",
                    1e-6 * static_cast<double>(found == f.memory.end() ? f.memory.back().second : found->second));
      }
      std::printf(" |\n");
    }
  }

 private:
  void ping() {
    pinged_ = Clock::now();
    std::vector<std::uint8_t> bytes(kPingSize);
    bytes[0] = ++number_;
    output_.write(kPing, bytes, 0);
  }

  void hear(std::size_t subscription, const std::vector<std::uint8_t>& bytes) {
    const double now = since(begun_);
    if (subscription == 0) {
      if (!bytes.empty() && bytes[0] == number_) trips_.push_back(since(pinged_));
    } else if (subscription == 1) {
      const auto ahrs = message_of<fathom_lcm::ahrs_t>(bytes);
      if (ahrs) sensed_[ahrs->utime] = now;
      if (sensed_.size() > kRemembered) sensed_.erase(sensed_.begin());
    } else if (subscription == 2) {
      newest_ = now;
      const auto state = message_of<fathom_lcm::state_t>(bytes);
      if (state && sensed_.contains(state->utime)) states_.push_back(now - sensed_[state->utime]);
    } else if (subscription == 3) {
      newest_ = now;
    } else if (subscription == 4) {
      const auto model = message_of<fathom_lcm::model_t>(bytes);
      if (model && sensed_.contains(model->utime)) models_.push_back(now - sensed_[model->utime]);
      answers_.push_back(now - newest_);
    } else {
      const auto message = message_of<fathom_lcm::health_t>(bytes);
      const auto health = message ? wire::decode(*message) : std::nullopt;
      if (!health || (processes_.size() > 100 && !processes_.contains(health->process))) return;
      Figures& figures = processes_[health->process];
      figures.memory.emplace_back(now, health->memory);
      figures.cpu += health->cpu;
      figures.received = health->received;
      figures.dropped = health->dropped;
      figures.rejected = health->rejected;
    }
  }

  runtime::Url url_;
  BusPackets packets_;
  runtime::LiveInput input_;
  runtime::Output output_;
  Clock::time_point begun_{Clock::now()}, pinged_{};
  std::uint8_t number_{};
  std::map<Utime, double> sensed_;  ///< AHRS, when it came
  double newest_{};
  std::vector<double> trips_, states_, models_, answers_;
  std::map<std::string, Figures> processes_;
};

void run_bus(const BusOptions& options) {
  runtime::StopSignal stop;
  const pid_t parent = getpid(), child = fork();
  if (child == 0) echo(runtime::Url::parse(options.url, "--bus"), parent);
  Listener listener{options};
  const auto begin = Clock::now();
  while (!stop.raised() && (options.seconds <= 0.0 || since(begin) < options.seconds)) listener.round();
  kill(child, SIGKILL);
  listener.report();
}

}  // namespace

void add_bus(runtime::CommandLine& app) {
  auto options = std::make_shared<BusOptions>();
  if (const char* url = std::getenv("LCM_DEFAULT_URL"); url != nullptr && *url != '\0') options->url = url;
  runtime::CommandLine* command =
      app.add_subcommand("bus", "what a live bus loses and how long it takes: a table, at Ctrl-C");
  command->add_option("--bus", options->url, "LCM URL (LCM_DEFAULT_URL)");
  command->add_option("--seconds", options->seconds, "end after so long");
  command->callback([options] { run_bus(*options); });
}

}  // namespace fathom::tool
