// fathom repair-log: the whole events of a damaged log, before the damage and behind it, into a new one.
#include <cstdio>
#include <memory>

#include "common/base/log_salvage.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct RepairLogOptions {
  std::string log, out;
};

unsigned long long number(std::uint64_t value) { return value; }

void run_repair_log(const RepairLogOptions& options) {
  const Salvage result = salvage(options.log, options.out);
  std::printf("%s: kept %llu events, %llu bytes\n", options.out.c_str(), number(result.events), number(result.bytes));
  if (result.parts.size() > 1) {
    std::printf("%s: %zu recordings joined together, each to a file of its own:\n", options.log.c_str(),
                result.parts.size());
    for (const Salvage::Part& part : result.parts)
      std::printf("  %s: from byte %llu, after event %llu\n", part.path.c_str(), number(part.begin),
                  number(part.events_before));
  }
  for (const auto& [channel, count] : result.channels) std::printf("  %-20s %llu\n", channel.c_str(), number(count));
  if (result.damages.empty()) {
    std::printf("%s: no damage\n", options.log.c_str());
    return;
  }
  const std::uint64_t before = result.damages.front().events_before;
  std::printf("%s: %zu damaged stretches, %llu bytes left out; %llu events before the first one, %llu behind it\n",
              options.log.c_str(), result.damages.size(), number(result.lost()), number(before),
              number(result.events - before));
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < result.damages.size() && i < kMost; ++i) {
    const Salvage::Damage& each = result.damages[i];
    std::printf("  byte %llu: %llu bytes, after event %llu\n", number(each.offset), number(each.bytes),
                number(each.events_before));
  }
  if (result.damages.size() > kMost) std::printf("  and %zu more\n", result.damages.size() - kMost);
}

}  // namespace

void add_repair_log(runtime::CommandLine& app) {
  auto options = std::make_shared<RepairLogOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("repair-log", "take what is whole out of a damaged log, part joined ones");
  command->add_option("log", options->log, "damaged LCM log; it stays as it is")->required();
  command->add_option("--out", options->out, "the new log")->required();
  command->callback([options] { run_repair_log(*options); });
}

}  // namespace fathom::tool
