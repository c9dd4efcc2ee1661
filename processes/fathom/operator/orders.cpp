#include "processes/fathom/operator/orders.hpp"

#include <algorithm>
#include <cstdio>

#include "common/base/error.hpp"

namespace fathom::tool {
namespace {

/// What to do about a refusal whose words do not say it.
std::string remedy_of(const std::string& refusal) {
  const auto says = [&](const char* words) { return refusal.find(words) != std::string::npos; };
  if (says("tilted too far")) return "; set it upright, then arm again";
  if (says(": too far ")) return "; bring it inside the room, by hand or by its own ground station, then arm again";
  if (says("the state is not valid")) return "; 'fathom status' says what the estimator hears";
  return {};
}

}  // namespace

Orders::Orders(Console& console) : console_{console} {
  console.listen(kMeet, [&] { return console.gate.has_value(); });
  if (!console.gate && console.foreign) {
    throw InputError("who moves the thrusters has another key: is --operator a copy of the vehicle's file?");
  }
  if (!console.gate)
    throw InputError(
        "nobody on this bus moves thrusters: no ANSWER of a thruster driver (or a simulator) within 2.5 s; "
        "is it running, and is --bus the vehicle's?");
  console.listen(0.6);  // should there be another one, it speaks twice a second
  if (console.gates.size() > 1) {
    std::string names;
    for (const std::string& each : console.gates) names += (names.empty() ? "" : ", ") + each.substr(0, each.find(' '));
    throw InputError("more than one moves thrusters on this bus (" + names + "): stop all but one");
  }
}

Operator Orders::numbered(Operator order) {
  if (console_.gate->challenge != challenge_) given_ = 0;  // another life, with numbers of its own
  challenge_ = order.challenge = console_.gate->challenge;
  given_ = order.sequence = std::max(given_, console_.gate->accepted) + 1;
  order.utime = *console_.vehicle_time();
  return order;
}

void Orders::say(Operator order) { console_.say(numbered(std::move(order))); }

void Orders::give(Operator wanted, bool supervisor) {
  constexpr int kTries = 3;        // two operators may have taken the same number
  constexpr double kAgain = 0.25;  // s until what is not answered is said again
  const char* kGo = "the vehicle may not do what you want; fathom status tells more, fathom abort stops it";
  for (int i = 0;; ++i) {
    const Operator order = numbered(wanted);
    console_.asked = order.sequence;
    console_.answers.clear();
    const auto answer = [&](bool gate) -> const Answer* {
      for (const auto& [process, each] : console_.answers) {
        if (each.gate == gate) return &each;
      }
      return nullptr;
    };
    const auto all = [&] {
      const Answer* gate = answer(true);
      return gate != nullptr && (!gate->done || !supervisor || answer(false) != nullptr);
    };
    for (double waited = 0.0; waited < kReply && !all(); waited += kAgain) {
      console_.say(order);
      console_.listen(kAgain, all);
    }
    // What is armed when its order is answered may have been aborted meanwhile, and that was an answer, too.
    const auto done = [&](const Answer& one) { return one.done && (one.armed || !wanted.enable); };
    const Answer* gate = answer(true);
    const auto was_late = [](const Answer* one) { return one != nullptr && !one->done && one->text == "heard before"; };
    if ((was_late(gate) || (supervisor && was_late(answer(false)))) && i + 1 < kTries) continue;
    for (const auto& [process, each] : console_.answers) {
      std::printf("%-16s %s%s\n", process.c_str(), done(each) ? "" : "REFUSED: ", each.text.c_str());
    }
    if (gate == nullptr) throw InputError(std::string{"NOT CONFIRMED: the thrusters did not answer; "} + kGo);
    if (!done(*gate)) throw InputError("refused by " + gate->process + ": " + gate->text);
    if (!supervisor) return;
    const Answer* other = answer(false);
    if (other == nullptr)
      throw InputError(std::string{"NOT CONFIRMED: no supervisor answered (is it running? has it this key?); "} + kGo);
    if (!done(*other)) throw InputError("refused by " + other->process + ": " + other->text + remedy_of(other->text));
    return;
  }
}

void go_through(Console& console, const std::vector<std::string>& needs, bool supervisor) {
  constexpr double kLongest = 2.5;  // s: HEALTH comes each second
  const auto lines = [&] {
    return supervisor ? excitation::preflight(console.heard(), needs) : excitation::vehicle_lines(console.heard());
  };
  const bool simulated = console.gate && console.gate->process == "simulator";  // nothing stands behind it
  console.listen(kLongest, [&] {
    const auto all = lines();
    return excitation::all_ok(all) && (simulated || !all.empty());
  });
  for (const excitation::PreflightLine& line : lines()) std::printf("%s\n", excitation::shown(line).c_str());
  std::fflush(stdout);
  if (!excitation::all_ok(lines())) throw InputError("not armed: see to what is NOT OK above, then arm again");
}

}  // namespace fathom::tool
