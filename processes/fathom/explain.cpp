// fathom explain, fathom diff: what a diagnosis decided and why, and what changed between two.
#include "common/result/explain.hpp"

#include <cstdio>
#include <memory>

#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {

void add_explain(runtime::CommandLine& app) {
  struct Options {
    std::string first, second;
  };
  auto options = std::make_shared<Options>();
  runtime::CommandLine* explain =
      app.add_subcommand("explain", "why a diagnosis says what it says, with values and thresholds");
  explain->add_option("result", options->first, "result.json of fathom diagnose, or its folder")->required();
  explain->callback([options] { std::fputs(result::explained(result::read_result(options->first)).c_str(), stdout); });
  runtime::CommandLine* diff = app.add_subcommand("diff", "two diagnoses compared, before and after a repair");
  diff->add_option("first", options->first, "result.json of the first diagnosis, or its folder")->required();
  diff->add_option("second", options->second, "result.json of the second")->required();
  diff->callback([options] {
    const result::Stored first = result::read_result(options->first), second = result::read_result(options->second);
    std::fputs(result::difference(first, second).c_str(), stdout);
  });
}

}  // namespace fathom::tool
