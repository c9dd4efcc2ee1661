#include "common/wire/launch.hpp"

#include <cmath>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

#include "common/wire/plausible.hpp"

namespace fathom::wire {
namespace {

LaunchCommand from(const procman_lcm::cmd_t& message) {
  return {.id = message.command_id,
          .exec = message.exec_str,
          .group = message.group,
          .auto_respawn = message.auto_respawn != 0,
          .stop_signal = message.stop_signal,
          .stop_time_allowed = message.stop_time_allowed};
}

procman_lcm::cmd_t to(const LaunchCommand& sample) {
  procman_lcm::cmd_t message{};
  message.command_id = sample.id;
  message.exec_str = sample.exec;
  message.group = sample.group;
  message.auto_respawn = sample.auto_respawn ? 1 : 0;
  message.stop_signal = sample.stop_signal;
  message.stop_time_allowed = sample.stop_time_allowed;
  return message;
}

}  // namespace

std::optional<LaunchOrders> decode(const procman_lcm::orders_t& message) {
  if (!length(message.ncmds, message.cmds.size())) return {};
  LaunchOrders sample{
      .utime = message.utime, .deputy = message.deputy_id, .sheriff = message.sheriff_id, .commands = {}};
  for (const auto& each : message.cmds) {
    if (!std::isfinite(each.cmd.stop_time_allowed)) return {};
    sample.commands.push_back({from(each.cmd), each.desired_runid, each.force_quit != 0});
  }
  return sample;
}

std::optional<DeputyInfo> decode(const procman_lcm::deputy_info_t& message) {
  if (!length(message.ncmds, message.cmds.size()) || !std::isfinite(message.cpu_load)) return {};
  DeputyInfo sample{.utime = message.utime,
                    .deputy = message.deputy_id,
                    .cpu_load = message.cpu_load,
                    .memory_total = message.phys_mem_total_bytes,
                    .memory_free = message.phys_mem_free_bytes,
                    .swap_total = message.swap_total_bytes,
                    .swap_free = message.swap_free_bytes,
                    .commands = {}};
  for (const auto& each : message.cmds) {
    if (!std::isfinite(each.cmd.stop_time_allowed) || !std::isfinite(each.cpu_usage)) return {};
    sample.commands.push_back({from(each.cmd), each.pid, each.actual_runid, each.exit_code, each.cpu_usage,
                               each.mem_vsize_bytes, each.mem_rss_bytes});
  }
  return sample;
}

std::optional<LaunchDiscovery> decode(const procman_lcm::discovery_t& message) {
  return LaunchDiscovery{.utime = message.utime, .transmitter = message.transmitter_id, .nonce = message.nonce};
}

std::optional<LaunchOutput> decode(const procman_lcm::output_t& message) {
  if (!length(message.num_commands, message.command_ids.size()) || !length(message.num_commands, message.text.size()))
    return {};
  LaunchOutput sample{.utime = message.utime, .deputy = message.deputy_id, .texts = {}};
  for (std::size_t i = 0; i < message.text.size(); ++i)
    sample.texts.push_back({message.command_ids[i], message.text[i]});
  return sample;
}

procman_lcm::orders_t encode(const LaunchOrders& sample) {
  procman_lcm::orders_t message{};
  message.utime = sample.utime;
  message.deputy_id = sample.deputy;
  message.sheriff_id = sample.sheriff;
  message.ncmds = count(sample.commands);
  for (const CommandOrder& each : sample.commands) {
    procman_lcm::cmd_desired_t one{};
    one.cmd = to(each.command);
    one.desired_runid = each.run;
    one.force_quit = each.stop ? 1 : 0;
    message.cmds.push_back(one);
  }
  return message;
}

procman_lcm::deputy_info_t encode(const DeputyInfo& sample) {
  procman_lcm::deputy_info_t message{};
  message.utime = sample.utime;
  message.deputy_id = sample.deputy;
  message.cpu_load = sample.cpu_load;
  message.phys_mem_total_bytes = sample.memory_total;
  message.phys_mem_free_bytes = sample.memory_free;
  message.swap_total_bytes = sample.swap_total;
  message.swap_free_bytes = sample.swap_free;
  message.ncmds = count(sample.commands);
  for (const CommandStatus& each : sample.commands) {
    procman_lcm::cmd_status_t one{};
    one.cmd = to(each.command);
    one.pid = each.pid;
    one.actual_runid = each.run;
    one.exit_code = each.wait_status;
    one.cpu_usage = each.cpu;
    one.mem_vsize_bytes = each.virtual_memory;
    one.mem_rss_bytes = each.resident_memory;
    message.cmds.push_back(one);
  }
  return message;
}

procman_lcm::discovery_t encode(const LaunchDiscovery& sample) {
  procman_lcm::discovery_t message{};
  message.utime = sample.utime;
  message.transmitter_id = sample.transmitter;
  message.nonce = sample.nonce;
  return message;
}

procman_lcm::output_t encode(const LaunchOutput& sample) {
  procman_lcm::output_t message{};
  message.utime = sample.utime;
  message.deputy_id = sample.deputy;
  message.num_commands = static_cast<std::int16_t>(std::min<std::size_t>(sample.texts.size(), 32767));
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.num_commands); ++i) {
    message.command_ids.push_back(sample.texts[i].id);
    message.text.push_back(sample.texts[i].text);
  }
  return message;
}

}  // namespace fathom::wire
