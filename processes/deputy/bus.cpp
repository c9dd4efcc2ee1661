#include "processes/deputy/bus.hpp"

#include <fathom_lcm/health_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <utility>

#include "common/base/error.hpp"
#include "common/runtime/self.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/launch.hpp"
#include "common/wire/minds.hpp"

namespace fathom::deputy {
namespace {

runtime::Url live(const std::string& text) {
  runtime::Url url = runtime::Url::parse(text, "--lcmurl");
  if (!url.live()) throw InputError("--lcmurl " + text + ": orders come over a live bus");
  return url;
}

}  // namespace

Bus::Bus(const std::string& url, const std::string& health_url, Handlers handlers)
    : handlers_{std::move(handlers)},
      procman_{{live(url)}, {{wire::kLaunchOrders, 100}, {wire::kLaunchInfo, 100}, {wire::kLaunchDiscover, 100}}},
      health_{{live(health_url)}, {{wire::kHealth, 1000}}},
      output_{live(url)},
      speakers_{runtime::host_name(), runtime::Speakers::Home::kAnywhere} {}

std::vector<int> Bus::descriptors() const {
  std::vector<int> all = procman_.descriptors();
  for (const int each : health_.descriptors()) all.push_back(each);
  return all;
}

template <class Message, class Handler>
void Bus::hand(const runtime::LiveInput::Message& message, const Handler& handler) {
  const auto decoded = runtime::message_of<Message>(message.bytes);
  const auto sample = decoded ? wire::decode(*decoded) : std::nullopt;
  if (!sample) {
    ++rejected_;
  } else if (handler) {
    handler(*sample);
  }
}

void Bus::serve() {
  while (const auto message = procman_.next()) {
    if (message->subscription == 0) hand<procman_lcm::orders_t>(*message, handlers_.orders);
    if (message->subscription == 1) hand<procman_lcm::deputy_info_t>(*message, handlers_.info);
    if (message->subscription == 2) hand<procman_lcm::discovery_t>(*message, handlers_.discovery);
  }
  while (const auto message = health_.next()) {
    const auto word = runtime::message_of<fathom_lcm::health_t>(message->bytes);
    if (word && !speakers_.believes(*word)) {
      ++rejected_;
      continue;
    }
    hand<fathom_lcm::health_t>(*message, handlers_.health);
  }
}

void Bus::say(const DeputyInfo& info) { runtime::say(output_, wire::kLaunchInfo, wire::encode(info)); }
void Bus::say(const LaunchDiscovery& discovery) {
  runtime::say(output_, wire::kLaunchDiscover, wire::encode(discovery));
}
void Bus::say(const LaunchOutput& output) { runtime::say(output_, wire::kLaunchOutput, wire::encode(output)); }

}  // namespace fathom::deputy
