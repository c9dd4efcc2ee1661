#include "processes/simulator/options.hpp"

#include <algorithm>
#include <charconv>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"

namespace fathom::simulator {

void Options::add_to(runtime::CommandLine& app) {
  app.add_option("--seed", setup.seed, "of every random number (1)");
  app.add_option("--hide", setup.hide,
                 "an effect in the truth that the others shall find: NAME or NAME=parameter:value,...")
      ->take_all()
      ->expected(1);
  app.add_option("--model", setup.model,
                 "result.json of fathom diagnose: its numbers, effects and learned force are the truth")
      ->type_name("FILE");
  app.add_option("--fail", setup.fail,
                 "an instrument that fails: NAME=silent|frozen|nan|delay|jump[,from:S][,to:S][,by:S]")
      ->take_all()
      ->expected(1);
  app.add_flag("--camera", setup.pictures, "pictures on CAMERA in place of what is measured in them");
  app.add_option("--camera-at", camera_at,
                 "tcp:PORT: as --camera, and the camera sends its pictures there for camera_driver, in real time")
      ->each([this](const std::string&) { setup.pictures = true; });
  app.add_option("--duration", setup.duration, "virtual seconds until the run ends by itself (330)");
  app.add_flag("--until-done", until_done, "end when the supervisor says that it is done, aborted or lost");
  app.add_option("--speed", speed, "virtual over real seconds (1); 0: as fast as possible, with --wait-for")
      ->not_negative();
  app.add_option("--wait-for", wait_for, "processes started with --lockstep: wait for each of them")->delimiter(',');
  app.add_option("--order", orders, "the operator's word at a virtual time: SECONDS=enable, abort, hold, identify, fly")
      ->take_all()
      ->expected(1);
  app.add_option("--bytes", drivers,
                 "a drivers' file: plays its instruments at the other ends of their links, in real time")
      ->type_name("FILE");
  app.add_option("--manoeuvre", manoeuvre,
                 "fly line, zigzag or circle here, open loop, and obey no commands; the run ends with it");
  app.add_option("--out-dir", out_dir, "where truth.json is written");
}

std::vector<Operator> Options::schedule() const {
  std::vector<Operator> schedule;
  for (const std::string& text : orders) {
    const auto equals = text.find('=');
    double seconds{};
    const char* end = text.data() + std::min(equals, text.size());
    const auto [stop, error] = std::from_chars(text.data(), end, seconds);
    const std::string word = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool known = word == "enable" || word == "abort" || word == "hold" || word == "identify" || word == "fly";
    if (error != std::errc{} || stop != end || !(seconds >= 0.0) || !known) {
      throw InputError("--order " + text + ": write SECONDS=WORD, WORD one of enable, abort, hold, identify, fly");
    }
    schedule.push_back({.utime = utime_after(setup.origin, seconds),
                        .abort = word == "abort",
                        .enable = word == "enable" || word == "identify" || word == "fly",
                        .order = word == "abort"    ? ""
                                 : word == "enable" ? "identify"
                                                    : word,
                        .authentic = true});
  }
  std::stable_sort(schedule.begin(), schedule.end(),
                   [](const Operator& a, const Operator& b) { return a.utime < b.utime; });
  return schedule;
}

void Options::check() const {
  if (!(setup.duration > 0.0)) throw InputError("--duration: must be positive");
  for (std::size_t i = 0; i < wait_for.size(); ++i) {
    if (std::count(wait_for.begin(), wait_for.end(), wait_for[i]) > 1) {
      throw InputError("--wait-for: " + wait_for[i] + " stands there twice");
    }
  }
  if (!drivers.empty() && (speed != 1.0 || !wait_for.empty())) {
    throw InputError("--bytes: instruments speak in real time; leave out --speed and --wait-for");
  }
  if (!camera_at.empty() && (speed != 1.0 || !wait_for.empty() || !drivers.empty())) {
    throw InputError("--camera-at: a camera sends in real time; leave out --speed, --wait-for and --bytes");
  }
  if (!drivers.empty() && !manoeuvre.empty()) throw InputError("--manoeuvre: leave out --bytes; nobody is commanded");
  if (speed == 0.0 && wait_for.empty()) {
    throw InputError("--speed 0: say with --wait-for which processes to wait for, or nobody could keep up");
  }
}

}  // namespace fathom::simulator
