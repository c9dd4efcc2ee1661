#include "common/runtime/bus.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/runtime/bus_filter.hpp"

namespace fathom::runtime {
namespace {

constexpr std::size_t kDrainLimit = 4096;  // then handlers get their turn, even under a flood

std::unique_ptr<lcm::LCM> connect(const Url& url) {
  auto bus = std::make_unique<lcm::LCM>(url.text);
  if (!bus->good()) {
    throw InputError(url.text +
                     ": the bus cannot be opened; most often there is no route to multicast: "
                     "ip link set lo up; ip route add 224.0.0.0/4 dev lo");
  }
  return bus;
}

/// The same URL with ttl 0, or nothing when messages stay on this host anyway (LCM's own choice).
std::string near_url(const std::string& url) {
  const auto at = url.find("ttl=");
  if (at == std::string::npos || url.substr(at + 4, url.find('&', at) - at - 4) == "0") return {};
  const auto end = url.find('&', at);
  return url.substr(0, at) + "ttl=0" + (end == std::string::npos ? "" : url.substr(end));
}

}  // namespace

bool is_picture(const std::string& channel) { return std::ranges::find(kPictures, channel) != std::end(kPictures); }

Url Url::parse(const std::string& text, const std::string& argument) {
  const auto complain = [&](const std::string& what) { return InputError(argument + " " + text + ": " + what); };
  const auto options_at = text.find('?');
  const std::string options = options_at == std::string::npos ? "" : text.substr(options_at + 1);
  if (text.starts_with("file://")) {
    const std::string path = text.substr(7, options_at == std::string::npos ? options_at : options_at - 7);
    if (path.empty()) throw complain("names no file; write file://RUN.lcmlog");
    if (argument == "--in" && !options.empty() && options != "speed=0" && options != "mode=r") {
      throw complain("a log is read as fast as possible; use lcm-logplayer to replay at another speed");
    }
    if (argument == "--out" && !options.empty() && options != "mode=w")
      throw complain("a log is written anew; drop the option");
    return {.text = text, .path = path};
  }
  if (!text.starts_with("udpm://")) throw complain("unknown kind of URL; use udpm://ADDRESS:PORT or file://RUN.lcmlog");
  const std::string address = text.substr(7, options_at == std::string::npos ? options_at : options_at - 7);
  // liblcm accepts an address without port and then waits ten seconds for itself.
  if (!address.empty() && address.find(':') == std::string::npos) {
    throw complain("has no port; write udpm://" + address + ":7667");
  }
  Url url{.text = text, .path = {}};
  // The kernel's default of 208 kB loses nearly every camera frame.
  if (options.find("recv_buf_size=") == std::string::npos) {
    url.text += (options_at == std::string::npos ? "?" : "&") + std::string{"recv_buf_size=2097152"};
  }
  return url;
}

MergedLogs::MergedLogs(const std::vector<Url>& urls) {
  heads_.reserve(urls.size());
  for (const Url& url : urls) {
    heads_.push_back({.log = EventLog{url.path}, .event = {}});
    heads_.back().event = heads_.back().log.next();
  }
}

std::optional<LogEvent> MergedLogs::next() {
  if (delivered_ != nullptr) delivered_->event = delivered_->log.next();
  delivered_ = nullptr;
  for (Head& head : heads_) {
    if (head.event && (delivered_ == nullptr || head.event->time < delivered_->event->time)) delivered_ = &head;
  }
  if (delivered_ == nullptr) return {};
  return delivered_->event;
}

std::vector<std::string> MergedLogs::warnings() const {
  std::vector<std::string> texts;
  for (const Head& head : heads_) {
    if (!head.log.warning().empty()) texts.push_back(head.log.warning());
  }
  return texts;
}

LiveInput::LiveInput(const std::vector<Url>& urls, const std::vector<Subscription>& subscriptions) {
  slots_.reserve(subscriptions.size());
  for (const Subscription& subscription : subscriptions) {
    slots_.push_back({.owner = this,
                      .index = slots_.size(),
                      .capacity = subscription.capacity,
                      .many = subscription.channel.find('*') != std::string::npos});
  }
  if (slots_.empty()) return;  // nothing to hear: a driver that writes to a file needs no bus
  std::vector<std::string> channels;
  channels.reserve(subscriptions.size());
  for (const Subscription& each : subscriptions) channels.push_back(each.channel);
  const bool many = std::ranges::any_of(slots_, [](const Slot& slot) { return slot.many; });
  if (many) channels.clear();  // all of them
  for (const Url& url : urls) {
    buses_.push_back(connect(url));
    const auto socket = listen_filtered(*buses_.back(), url.text);
    for (Slot& slot : slots_) {
      auto* handle = buses_.back()->subscribeFunction(subscriptions[slot.index].channel, &LiveInput::receive, &slot);
      if (handle == nullptr) throw InputError(url.text + ": cannot listen; does multicast come back to this host?");
      handle->setQueueCapacity(std::numeric_limits<int>::max());
    }
    if (socket && !filter(*socket, bus_program(BusAddress::of(url.text), channels)))
      throw InputError(url.text + ": the kernel refuses the filter of channels");
  }
}

LiveInput::~LiveInput() = default;

void LiveInput::receive(const lcm::ReceiveBuffer* buffer, const std::string& channel, Slot* slot) {
  try {
    slot->owner->push(*slot, *buffer, channel);
  } catch (...) {
    slot->owner->failure_ = std::current_exception();
  }
}

void LiveInput::push(Slot& slot, const lcm::ReceiveBuffer& buffer, const std::string& channel) {
  const auto* data = static_cast<const std::uint8_t*>(buffer.data);
  queue_.push_back({.subscription = slot.index,
                    .bytes = {data, data + buffer.data_size},
                    .channel = slot.many ? channel : "",
                    .received = buffer.recv_utime});
  if (slot.waiting < slot.capacity) {
    ++slot.waiting;
  } else {
    ++slot.superseded;
    ++(slot.capacity > 1 ? slot.dropped : slot.skipped);
  }
}

std::vector<int> LiveInput::descriptors() const {
  std::vector<int> found;
  for (const auto& bus : buses_) found.push_back(bus->getFileno());
  return found;
}

void LiveInput::wait(int wake, int milliseconds) {
  if (pending()) return;
  std::vector<pollfd> watched{{.fd = wake, .events = POLLIN, .revents = 0}};
  for (const int each : descriptors()) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  poll(watched.data(), watched.size(), milliseconds);
}

void LiveInput::drain() {
  for (const auto& bus : buses_) {
    for (std::size_t i = 0; i < kDrainLimit && bus->handleTimeout(0) > 0; ++i) {
      if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }
  }
}

std::optional<LiveInput::Message> LiveInput::next() {
  drain();
  while (!queue_.empty()) {
    Message message = std::move(queue_.front());
    queue_.pop_front();
    Slot& slot = slots_[message.subscription];
    if (slot.superseded > 0) {
      --slot.superseded;
      continue;
    }
    --slot.waiting;
    return message;
  }
  return {};
}

Output::Output(const Url& url) : path_{url.path} {
  if (url.live()) {
    bus_ = connect(url);
    near_url_ = near_url(url.text);
    return;
  }
  log_ = std::make_unique<lcm::LogFile>(url.path, "w");
  if (!log_->good()) throw InputError(url.path + ": cannot be written; check that the folder exists and is yours");
}

Output::~Output() = default;

lcm::LCM& Output::bus_for(const std::string& channel) {
  if (near_url_.empty() || !is_picture(channel)) return *bus_;
  if (!near_) near_ = connect({.text = near_url_, .path = {}});
  return *near_;
}

void Output::write(const std::string& channel, std::span<std::uint8_t> bytes, Utime utime) {
  if (bus_) {
    bus_for(channel).publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
    return;
  }
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(bytes.size());
  event.data = bytes.data();
  if (log_->writeEvent(&event) != 0) throw InputError(path_ + ": writing failed; is the disk full?");
}

void Output::finish() {
  if (log_ && std::fflush(log_->getFilePtr()) != 0) throw InputError(path_ + ": writing failed; is the disk full?");
}

}  // namespace fathom::runtime
