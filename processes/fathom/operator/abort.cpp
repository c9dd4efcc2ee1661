// fathom abort: done when the vehicle says so, not when it was said.
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "common/orders/abort_watch.hpp"
#include "processes/fathom/operator/orders.hpp"

namespace fathom::tool {
namespace {

constexpr double kLook = 0.05;  // s between two looks at the clock

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

double seconds_now() { return std::chrono::duration<double>(Console::Clock::now().time_since_epoch()).count(); }

}  // namespace

void abort_now(Console& console, bool checked) {
  orders::AbortWatch watch{unforeseeable(), seconds_now()};
  console.asked = watch.number();
  console.answers.clear();
  console.on_answer = [&](const Answer& heard) { watch.hear(heard); };
  console.on_thrusters = [&](const Thrusters& heard) { watch.hear(heard); };
  console.on_vehicle = [&](const VehicleCondition& heard) { watch.hear(heard); };
  std::optional<orders::AbortWatch::Outcome> outcome;
  while (!(outcome = watch.outcome(seconds_now()))) {
    if (watch.speaks(seconds_now()))
      console.say({.utime = console.vehicle_time().value_or(wall_clock()), .sequence = watch.number(), .abort = true});
    console.listen(kLook, [&] { return watch.outcome(seconds_now()).has_value(); });
  }
  console.on_answer = {};
  console.on_thrusters = {};
  console.on_vehicle = {};
  for (const auto& [process, each] : watch.answers())
    std::printf("%-16s %s\n", printable(process).c_str(), printable(each.text).c_str());
  std::fflush(stdout);
  if (!outcome->confirmed) throw InputError(outcome->text);
  std::printf("%s%s\n", outcome->text.c_str(),
              checked ? "" : " (with --operator the answer's signature is checked, too)");
}

}  // namespace fathom::tool
