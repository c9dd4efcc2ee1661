#include "processes/fathom/console.hpp"

#include <chrono>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>

#include "common/base/error.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/vehicle.hpp"

namespace fathom::tool {
namespace {

template <class Message>
std::optional<Message> message_of(const std::vector<std::uint8_t>& bytes) {
  Message message{};
  const int length = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, length) != length) return {};
  return message;
}

}  // namespace

Console::Console(const std::string& url, Hears what)
    : url_{runtime::Url::parse(url, "--bus")},
      heard_{{wire::kExcitation, 1}},
      input_{{url_},
             [&] {
               if (what == Hears::kAll) {
                 heard_.insert(heard_.end(),
                               {{wire::kThrusters, 1}, {wire::kHealth, 200}, {wire::kState, 1}, {wire::kVehicle, 1}});
               }
               return heard_;
             }()},
      output_{url_} {
  if (!url_.live()) throw InputError("--bus " + url + ": an operator needs a live bus");
}

void Console::listen(double seconds, const std::function<bool()>& enough) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end && !(enough && enough())) {
    input_.wait(-1, 20);
    while (const auto message = input_.next()) hear(*message);
  }
}

void Console::say(const Operator& order) {
  const auto message = wire::encode(order);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  output_.write(wire::kOperator, bytes, message.utime);
}

void Console::hear(const runtime::LiveInput::Message& message) {
  const std::string& channel = heard_[message.subscription].channel;
  if (channel == wire::kThrusters) {
    if (const auto one = message_of<fathom_lcm::thrusters_t>(message.bytes)) vehicle_time = one->utime;
  } else if (channel == wire::kExcitation) {
    if (const auto one = message_of<fathom_lcm::excitation_t>(message.bytes)) excitation = wire::decode(*one);
  } else if (channel == wire::kHealth) {
    if (const auto one = message_of<fathom_lcm::health_t>(message.bytes)) {
      const auto heard = wire::decode(*one);
      if (!heard) return;
      health[heard->process] = *heard;
      health_came_[heard->process] = Clock::now();
    }
  } else if (channel == wire::kVehicle) {
    if (const auto one = message_of<fathom_lcm::vehicle_condition_t>(message.bytes)) vehicle = wire::decode(*one);
    vehicle_came_ = Clock::now();
  } else if (const auto one = message_of<fathom_lcm::state_t>(message.bytes)) {
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
