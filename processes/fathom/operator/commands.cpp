// fathom arm, fly, steer, order, abort, status: the operator's console. Orders are signed with the key of the vehicle's
// operator file; number and time come from the vehicle. An abort needs no key.
#include "processes/fathom/commands.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "common/orders/words.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/operator/orders.hpp"

namespace fathom::tool {
namespace {

using Options = OperatorOptions;

void print(const Excitation& e) {
  std::printf("%-10s %s\n", printable(e.phase).c_str(), printable(e.reason).c_str());
  if (e.mode.empty()) return;
  std::printf("mode %s, %.0f of at most %.0f s", printable(e.mode).c_str(), e.elapsed, e.duration);
  if (e.metric >= 0.0) std::printf(", certainty %.3g of %.3g", e.metric, e.threshold);
  std::printf("%s\n", e.bent ? ", bent by the fence" : "");
  if (!e.missing.empty()) std::printf("still missing: %s\n", printable(e.missing).c_str());
}

void order(const Options& options, bool enable, const std::string& word) {
  Console console{options.url, Console::Hears::kAll, operator_keys(options.operator_file)};
  Orders orders{console};
  if (enable) go_through(console, orders, options.needs, !options.no_supervisor);
  const double stays = enable ? promised(options, console) : 0.0;
  orders.give(
      {.enable = enable, .order = word, .segment = options.segment, .duration = options.seconds, .attends = stays},
      !options.no_supervisor);
  if (stays > 0.0) attend(console, orders, stays, !options.no_supervisor);
}

void abort(const Options& options) {
  std::optional<OperatorKeys> keys;
  if (!options.operator_file.empty()) keys = operator_keys(options.operator_file);
  Console console{options.url, Console::Hears::kAll, keys};
  abort_now(console, keys.has_value());
}

void status(const Options& options) {
  Console console{options.url};
  console.listen(1.6);
  if (console.health.empty())
    throw InputError("nobody says HEALTH on this bus; check --bus and that processes are running");
  if (console.excitation) print(*console.excitation);
  if (console.state) {
    const Eigen::Vector3d& p = console.state->p_WB;
    std::printf("state %s, at %.2f %.2f %.2f m\n", console.state->valid ? "valid" : "NOT VALID", p.x(), p.y(), p.z());
  }
  for (const auto& [name, health] : console.health) {
    std::printf("%-16s %-10s busy %3.0f %%, dropped %lld, rejected %lld  %s\n", printable(name).c_str(),
                printable(health.state).c_str(), 100.0 * health.busy, static_cast<long long>(health.dropped),
                static_cast<long long>(health.rejected), printable(health.detail).c_str());
  }
}

runtime::CommandLine* add(runtime::CommandLine& app, const char* name, const char* what,
                          const std::shared_ptr<Options>& options) {
  runtime::CommandLine* command = app.add_subcommand(name, what);
  if (const char* url = std::getenv("LCM_DEFAULT_URL"); url != nullptr && *url != '\0') options->url = url;
  command->add_option("--bus", options->url, "LCM URL (LCM_DEFAULT_URL)");
  return command;
}

}  // namespace

void add_operator(runtime::CommandLine& app) {
  auto options = std::make_shared<Options>();
  const auto with_key = [&](runtime::CommandLine* command) {
    command->add_option("--operator", options->operator_file, "file with the key that the vehicle has, too")
        ->required();
  };
  const auto may_stay = [&](runtime::CommandLine* command) {
    command
        ->add_option("--attend", options->attend,
                     "stay, and give signs of life within so many seconds (5 where the bus leaves this host)")
        ->within(0.5, 600.0);
    command->add_flag("--leave", options->leave, "go away, even where the bus leaves this host");
    command->add_flag(
        "--no-supervisor", options->no_supervisor,
        "a controller of your own commands, and judges for itself: only the vehicle's own conditions are listed");
  };
  runtime::CommandLine* arm = add(app, "arm", "let the thrusters obey the supervisor, and begin", options);
  with_key(arm);
  may_stay(arm);
  const auto with_needs = [&](runtime::CommandLine* command) {
    command->add_option("--needs", options->needs,
                        "processes that must be well, as in the supervisor's section; left out: estimator, "
                        "identifier, thruster_driver or simulator, recorder or simulator");
  };
  with_needs(arm);
  arm->callback([options] { order(*options, true, options->no_supervisor ? orders::kOther : "identify"); });
  runtime::CommandLine* say = add(app, "order", "say hold, identify, skip or retry to an armed supervisor", options);
  with_key(say);
  say->add_option("word", options->word)->required()->one_of({"hold", "identify", "skip", "retry"});
  say->callback([options] { order(*options, false, options->word); });
  runtime::CommandLine* fly =
      add(app, "fly",
          "one segment by its name, as fathom plan and diagnose give it, or a preset: line, zigzag, circle; "
          "without one the diagnoser's proposal",
          options);
  with_key(fly);
  may_stay(fly);
  fly->add_option("segment", options->segment, "for instance 'full steps in surge', or zigzag");
  fly->add_option("--seconds", options->seconds, "of it, again and again (as proposed, else once)")->within(1.0, 600.0);
  with_needs(fly);
  fly->callback([options] { order(*options, true, "fly"); });
  runtime::CommandLine* hand =
      add(app, "steer", "by hand: thrust only while a key, or the joystick's button, is held", options);
  with_key(hand);
  hand->add_option("--force", options->force, "N at full throw (10)")->positive();
  hand->add_option("--moment", options->moment, "N m at full throw (1)")->positive();
  hand->add_option("--joystick", options->joystick,
                   "the kernel's device, for instance /dev/input/js0; else the keyboard");
  hand->add_option("--dead-man", options->dead_man, "button that must be held (4, the left shoulder of most)")
      ->within(0, 31);
  hand->callback([options] { steer(*options); });
  runtime::CommandLine* abort_command =
      add(app, "abort", "thrusters to zero at once; needs no key, and says whether they are", options);
  abort_command->add_option("--operator", options->operator_file, "check the signature of who confirms");
  abort_command->callback([options] { abort(*options); });
  runtime::CommandLine* ask = add(app, "status", "what runs, in which mode, and what is missing", options);
  ask->callback([options] { status(*options); });
}

}  // namespace fathom::tool
