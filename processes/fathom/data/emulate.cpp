// fathom emulate: plays an instrument at a pseudo-terminal or a TCP port, at its real rate, and answers what a driver
// asks, so that a whole chain can be tried without hardware.
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include "common/base/error.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/protocols.hpp"
#include "common/link/raw_log.hpp"
#include "common/link/server.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

// s; a driver that opens a line throws away what waits in it, and on a busy machine it takes its time to do so.
constexpr double kHears = 0.3;

struct EmulateOptions {
  std::string protocol, to, file, sent;
  double seconds{0.0}, rate{0.0};
  std::vector<std::string> transponders, conditions;
};

// What an instrument says next: a recording piece by piece, or reports of an emulated motion.
class PlayedBytes {
 public:
  PlayedBytes(const EmulateOptions& options, const devices::Settings& settings)
      : protocol_{options.protocol}, settings_{settings}, begin_{link::wall_seconds()} {
    period_ = 1.0 / (options.rate > 0.0 ? options.rate : devices::emulated_rate(options.protocol));
    if (options.file.empty()) return;
    const int baud = devices::protocol(protocol_, "fathom emulate").baud;
    recording_.emplace(options.file, 0, baud > 0 ? baud / 10.0 : 1e5);  // ten bits on the line for eight
    piece_ = recording_->next();
    if (piece_) first_ = piece_->utime;
  }
  /// s since the start when the next bytes are due; nothing at the end.
  [[nodiscard]] std::optional<double> due() const {
    if (!recording_) return period_ * static_cast<double>(count_);
    if (!piece_) return {};
    return seconds_between(first_, piece_->utime);
  }
  [[nodiscard]] std::string next(devices::EmulatedAnswers& answers) {
    if (recording_) {
      std::string bytes{devices::as_text(piece_->bytes)};
      piece_ = recording_->next();
      return bytes;
    }
    const double since = period_ * static_cast<double>(count_++);
    devices::Instant now = devices::emulated_motion(begin_ + since, since, settings_);
    now.thrusters.pwm_us = answers.applied();
    now.vehicle = answers.vehicle();
    answers.vehicle().words.clear();
    return devices::emulate(protocol_, now, settings_);
  }

 private:
  std::string protocol_;
  const devices::Settings& settings_;
  double begin_, period_;
  std::uint64_t count_{};
  std::optional<link::RawReader> recording_;
  std::optional<link::RawPiece> piece_;
  Utime first_{};
};

void run_emulate(const EmulateOptions& options) {
  (void)devices::protocol(options.protocol, "fathom emulate");
  std::signal(SIGPIPE, SIG_IGN);  // a client may go at any time
  devices::Settings settings;
  settings.transponders = options.transponders;
  devices::EmulatedAnswers answers{options.protocol};
  std::vector<devices::PlayedCondition> conditions;
  for (const std::string& each : options.conditions) conditions.push_back(devices::PlayedCondition::parse(each));
  PlayedBytes source{options, settings};
  std::ofstream sent;
  if (!options.sent.empty()) sent.open(options.sent, std::ios::binary);
  if (!options.sent.empty() && !sent) throw InputError(options.sent + ": cannot be written");
  link::Server server{options.to};
  std::printf("%s speaks at %s\n", options.protocol.c_str(), server.name().c_str());
  std::fflush(stdout);
  const double begin = link::wall_seconds();
  const auto elapsed = [&] { return link::wall_seconds() - begin; };
  const auto say = [&](const std::string& bytes) {
    if (bytes.empty()) return;
    const std::size_t written = server.send(bytes);
    sent.write(bytes.data(), static_cast<std::streamsize>(written));
  };
  // A recording waits for who hears it, so that its beginning is not lost.
  std::optional<double> start;
  if (options.file.empty()) start = 0.0;
  while (options.seconds <= 0.0 || elapsed() < options.seconds) {
    if (!start && server.connected() && answers.sends_data()) start = elapsed() + kHears;
    auto due = source.due();
    if (!due && options.seconds <= 0.0) break;
    if (due) due = start ? std::optional{*start + *due} : std::nullopt;
    const double pause = due ? *due - elapsed() : 0.1;
    say(answers.hear(server.wait(std::max(0.0, std::min(pause, 0.1)))));
    answers.at(elapsed());
    std::erase_if(conditions, [&](const devices::PlayedCondition& each) {
      const bool now = each.time <= elapsed();
      if (now) devices::play(answers.vehicle(), each.word);
      return now;
    });
    if (due && elapsed() >= *due) {
      const std::string bytes = source.next(answers);
      if (answers.sends_data()) say(bytes);
    }
  }
  server.drain();
}

}  // namespace

void add_emulate(runtime::CommandLine& app) {
  auto options = std::make_shared<EmulateOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("emulate", "play an instrument at a pseudo-terminal or a TCP port");
  command->add_option("protocol", options->protocol, "as for decode")->required();
  command->add_option("--to", options->to, "pty (its name is printed), pty:PATH (a link to it), or tcp:PORT")
      ->required();
  command->add_option("--file", options->file,
                      "bytes to play: of a driver's 'record', or bare; left out: a gentle curve");
  command->add_option("--rate", options->rate, "reports per second; left out: as the instrument does")
      ->within(1e-3, 1e4);
  command->add_option("--seconds", options->seconds, "ends after this time; left out: never, or with the file")
      ->not_negative();
  command->add_option("--sent", options->sent, "writes what was sent to this file");
  command
      ->add_option("--condition", options->conditions,
                   "of the vehicle behind a thruster driver, TIME:CONDITION, more than once if wanted: 0:disarmed, "
                   "5:mode=STABILIZE, 8:says=2,Leak Detected, 9:voltage=9.0, heartbeat=off, failsafe=on, obeys=off")
      ->take_all()
      ->expected(1);
  command->add_option("--transponders", options->transponders, "names, for range_text");
  command->callback([options] { run_emulate(*options); });
}

}  // namespace fathom::tool
