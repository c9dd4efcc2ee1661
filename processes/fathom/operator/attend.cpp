// Who armed a vehicle over a link stays with it: without his signs of life the supervisor does what operator_lost says.
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "common/runtime/stop_signal.hpp"
#include "processes/fathom/operator/orders.hpp"

namespace fathom::tool {

double promised(const OperatorOptions& options, const Console& console) {
  constexpr double kOverALink = 5.0;  // s: a cable that moves is silent for less
  if (options.leave) return 0.0;
  if (options.attend > 0.0) return options.attend;
  return console.over_a_link() ? kOverALink : 0.0;
}

void attend(Console& console, Orders& orders, double promised, bool supervised) {
  constexpr double kSigns = 4.0;  // within what was promised: three may be lost
  runtime::StopSignal stop;
  std::printf("stays with it, a sign of life every %.2g s; Ctrl-C aborts\n", promised / kSigns);
  std::fflush(stdout);
  std::string said;
  console.excitation.reset();  // of before
  while (true) {
    orders.say({});
    console.listen(promised / kSigns, {}, stop.descriptor());
    if (stop.raised()) {
      abort_now(console, true);
      throw InputError("aborted by Ctrl-C");
    }
    const bool silent = supervised && console.silence() > kNobody;
    if (!silent && !console.excitation) continue;
    const std::string now = silent ? kNobodySays : console.excitation->phase + ": " + console.excitation->reason;
    if (now != said) {
      std::printf("%s\n", printable(now).c_str());
      std::fflush(stdout);
      said = now;
    }
    if (silent || !console.excitation->mode.empty()) continue;
    if (console.excitation->phase == "done") return;
    throw InputError("the trial has ended: " + printable(now));
  }
}

}  // namespace fathom::tool
