#include "processes/fathom/operator/console.hpp"

#include <poll.h>

#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>

#include "common/base/error.hpp"
#include "common/runtime/bus_filter.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "common/wire/signature.hpp"
#include "common/wire/vehicle.hpp"

namespace fathom::tool {

Console::Console(const std::string& url, Hears what, const std::optional<OperatorKeys>& keys)
    : url_{runtime::Url::parse(url, "--bus")},
      keys_{keys},
      heard_{{wire::kExcitation, 1}},
      input_{{url_},
             [&] {
               if (what == Hears::kAll) {
                 heard_.insert(heard_.end(), {{wire::kThrusters, 100},
                                              {wire::kAnswer, 100},
                                              {wire::kHealth, 200},
                                              {wire::kState, 1},
                                              {wire::kVehicle, 1}});
               }
               return heard_;
             }()},
      output_{url_} {
  if (!url_.live()) throw InputError("--bus " + url + ": an operator needs a live bus");
}

void Console::listen(double seconds, const std::function<bool()>& enough, int wake) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  const auto woken = [&] {
    pollfd one{.fd = wake, .events = POLLIN, .revents = 0};
    return wake >= 0 && poll(&one, 1, 0) > 0;
  };
  while (Clock::now() < end && !(enough && enough()) && !woken()) {
    input_.wait(wake, 20);
    while (const auto message = input_.next()) hear(*message);
  }
}

void Console::say(const Operator& order) {
  const auto message = keys_ ? wire::encode_signed(order, keys_->order) : wire::encode(order);
  runtime::say(output_, wire::kOperator, message);
}

std::optional<Utime> Console::vehicle_time() const {
  if (!gate) return {};
  return utime_after(gate->utime, std::chrono::duration<double>(Clock::now() - gate_at_).count());
}

double Console::silence() const { return std::chrono::duration<double>(Clock::now() - excitation_came_).count(); }

bool Console::over_a_link() const { return !runtime::BusAddress::of(url_.text).one_host; }

void Console::hear(Answer answer) {
  if (!answer.authentic && keys_) {
    foreign = true;
    return;
  }
  if (!is_time(answer.utime)) return;  // without a key anybody's answers are heard
  if (answer.gate) {
    gates.insert(answer.process + " " + std::to_string(answer.challenge));
    gate_at_ = Clock::now();
    gate = answer;
  }
  if (on_answer) on_answer(answer);
  if (asked != 0 && answer.sequence == asked) answers.emplace(answer.process, std::move(answer));
}

void Console::hear(const runtime::LiveInput::Message& message) {
  const std::string& channel = heard_[message.subscription].channel;
  if (channel == wire::kThrusters) {
    const auto one = runtime::message_of<fathom_lcm::thrusters_t>(message.bytes);
    if (const auto heard = one ? wire::decode(*one) : std::nullopt; heard && on_thrusters) on_thrusters(*heard);
  } else if (channel == wire::kAnswer) {
    const auto one = runtime::message_of<fathom_lcm::answer_t>(message.bytes);
    if (auto heard = one ? wire::open(*one, keys_ ? keys_->answer : Key{}) : std::nullopt) hear(std::move(*heard));
  } else if (channel == wire::kExcitation) {
    const auto one = runtime::message_of<fathom_lcm::excitation_t>(message.bytes);
    excitation = one ? wire::decode(*one) : std::nullopt;
    if (excitation) excitation_came_ = Clock::now();
  } else if (channel == wire::kHealth) {
    if (const auto one = runtime::message_of<fathom_lcm::health_t>(message.bytes)) {
      const auto heard = wire::decode(*one);
      if (!heard || !speakers_.believes(*one)) return;
      health[heard->process] = *heard;
      health_came_[heard->process] = Clock::now();
    }
  } else if (channel == wire::kVehicle) {
    if (const auto one = runtime::message_of<fathom_lcm::vehicle_condition_t>(message.bytes))
      vehicle = wire::decode(*one);
    vehicle_came_ = Clock::now();
    if (vehicle && on_vehicle) on_vehicle(*vehicle);
  } else if (const auto one = runtime::message_of<fathom_lcm::state_t>(message.bytes)) {
    state = wire::decode(*one);
    state_came_ = Clock::now();
  }
}

excitation::PreflightInput Console::heard() const {
  const auto age = [now = Clock::now()](Clock::time_point came) {
    return std::chrono::duration<double>(now - came).count();
  };
  excitation::PreflightInput input;
  for (const auto& [name, one] : health) input.health[name] = {one, age(health_came_.at(name))};
  if (state) input.state = {*state, age(state_came_)};
  if (vehicle) input.vehicle = {*vehicle, age(vehicle_came_)};
  return input;
}

}  // namespace fathom::tool
