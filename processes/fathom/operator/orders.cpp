#include "processes/fathom/operator/orders.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include "common/base/error.hpp"
#include "common/orders/words.hpp"

namespace fathom::tool {
namespace {

constexpr double kAgain = 0.25;  // s until what is not answered is said again
constexpr const char* kGo = "the vehicle may not do what you want; fathom status tells more, fathom abort stops it";
constexpr const char* kNoSupervisor = "NOT CONFIRMED: no supervisor answered (is it running? has it this key?)";

/// What is armed when its order is answered may have been aborted meanwhile, and that was an answer, too.
bool done(const Answer& one, const Operator& wanted) { return one.done && (one.armed || !wanted.enable); }

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

const Answer* Orders::answer(bool gate) const {
  for (const auto& [process, each] : console_.answers) {
    if (each.gate == gate) return &each;
  }
  return nullptr;
}

Operator Orders::exchange(const Operator& wanted, const std::function<bool()>& enough) {
  constexpr int kTries = 3;  // two operators may have taken the same number
  for (int i = 0;; ++i) {
    const Operator order = numbered(wanted);
    console_.asked = order.sequence;
    console_.answers.clear();
    for (double waited = 0.0; waited < kReply && !enough(); waited += kAgain) {
      console_.say(order);
      console_.listen(kAgain, enough);
    }
    const bool late = std::ranges::any_of(
        console_.answers, [](const auto& each) { return !each.second.done && each.second.text == "heard before"; });
    if (!late || i + 1 == kTries) return order;
  }
}

std::optional<Answer> Orders::ask(const Operator& order) {
  exchange(order, [&] { return answer(false) != nullptr; });
  const Answer* said = answer(false);
  return said == nullptr ? std::nullopt : std::optional{*said};
}

/// The thrusters hear the supervisor's refusal by themselves; said again, it refuses again.
void Orders::see_it_disarmed(const Operator& order, bool was_armed) {
  const auto disarmed = [&] { return !console_.gate->armed; };
  for (double waited = 0.0; waited < kReply && !disarmed(); waited += kAgain) {
    console_.say(order);
    console_.listen(kAgain, disarmed);
  }
  if (disarmed()) {
    std::printf("%-16s not armed\n", console_.gate->process.c_str());
  } else if (was_armed) {
    std::printf("%-16s still armed by an earlier order; fathom abort makes thrust zero\n",
                console_.gate->process.c_str());
  } else {
    abort_now(console_, true);
  }
  std::fflush(stdout);
}

void Orders::give(const Operator& wanted, bool supervisor) {
  const bool was_armed = console_.gate->armed;
  const Operator order = exchange(wanted, [&] {
    const Answer* gate = answer(true);
    return gate != nullptr && (!gate->done || !supervisor || answer(false) != nullptr);
  });
  const std::map<std::string, Answer> answers = console_.answers;
  for (const auto& [process, each] : answers) {
    std::printf("%-16s %s%s\n", process.c_str(), done(each, wanted) ? "" : "REFUSED: ", each.text.c_str());
  }
  const auto found = [&](bool gate) {
    const auto one = std::ranges::find_if(answers, [&](const auto& each) { return each.second.gate == gate; });
    return one == answers.end() ? nullptr : &one->second;
  };
  const Answer *gate = found(true), *other = found(false);
  if (gate == nullptr) throw InputError(std::string{"NOT CONFIRMED: the thrusters did not answer; "} + kGo);
  if (!done(*gate, wanted)) throw InputError("refused by " + gate->process + ": " + gate->text);
  if (!supervisor) return;
  if (other == nullptr) {
    if (!wanted.enable || was_armed) throw InputError(std::string{kNoSupervisor} + "; " + kGo);
    abort_now(console_, true);  // armed for nobody
    throw InputError(std::string{kNoSupervisor} + "; nothing is armed");
  }
  if (done(*other, wanted)) return;
  if (wanted.enable && !other->armed) see_it_disarmed(order, was_armed);
  throw InputError("refused by " + other->process + ": " + other->text + excitation::remedy_of(other->text));
}

void go_through(Console& console, Orders& orders, const std::vector<std::string>& needs, bool supervisor) {
  constexpr double kLongest = 2.5;  // s: HEALTH comes each second
  excitation::PreflightInput heard;
  std::optional<Answer> place;
  const auto lines = [&] {
    heard = console.heard();
    heard.place = place;
    return supervisor ? excitation::preflight(heard, needs) : excitation::vehicle_lines(heard);
  };
  const auto is_place = [](const excitation::PreflightLine& line) { return line.name == excitation::kPlace; };
  const bool simulated = console.gate && console.gate->process == "simulator";  // nothing stands behind it
  console.listen(kLongest, [&] {
    const auto all = lines();
    return std::ranges::all_of(all, [&](const auto& line) { return line.ok || is_place(line); }) &&
           (simulated || !all.empty());
  });
  const bool judged = std::ranges::any_of(lines(), is_place);  // a supervisor runs that can be asked
  if (judged) place = orders.ask({.order = orders::kPreflight});
  const auto all = lines();
  for (const excitation::PreflightLine& line : all) std::printf("%s\n", excitation::shown(line).c_str());
  std::fflush(stdout);
  if (judged && !place) throw InputError(std::string{kNoSupervisor} + "; nothing is armed");
  if (!excitation::all_ok(all)) throw InputError("not armed: see to what is NOT OK above, then arm again");
}

}  // namespace fathom::tool
