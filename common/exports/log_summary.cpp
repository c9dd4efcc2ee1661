#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/base/event_log.hpp"
#include "common/base/utc.hpp"
#include "common/exports/any_message.hpp"
#include "common/exports/log_export.hpp"

namespace fathom::exports {
namespace {

constexpr double kRegular =
    2.0;  // intervals that nine in ten stay below, over the median: else the channel has no rate

struct Gathered {
  ChannelSummary summary;
  std::vector<Utime> stamps;
};

/// When a message was true, where its type says so; else when it was logged.
Utime stamp_of(const LogEvent& event, const Type* type) {
  const bool stamped = type != nullptr && !type->fields.empty() && type->fields.front().name == "utime" &&
                       type->fields.front().type == "int64_t" && event.data.size() >= 16;
  return stamped ? static_cast<Utime>(event_format::big_endian<std::uint64_t>(event.data.subspan(8))) : event.time;
}

void measure(Gathered& gathered, Utime begin) {
  ChannelSummary& summary = gathered.summary;
  std::vector<Utime>& stamps = gathered.stamps;
  summary.rate = std::numeric_limits<double>::quiet_NaN();
  if (stamps.size() < 2) return;
  std::ranges::sort(stamps);
  const double length = seconds_between(stamps.front(), stamps.back());
  if (length > 0.0) summary.rate = static_cast<double>(stamps.size() - 1) / length;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals.push_back(seconds_between(stamps[i - 1], stamps[i]));
    if (intervals.back() <= summary.longest) continue;
    summary.longest = intervals.back();
    summary.longest_at = seconds_between(begin, stamps[i - 1]);
  }
  std::vector<double> sorted = intervals;
  std::ranges::sort(sorted);
  const double usual = sorted[sorted.size() / 2], most = sorted[sorted.size() * 9 / 10];
  if (most > kRegular * usual) return;
  summary.gaps = static_cast<std::uint64_t>(
      std::ranges::count_if(intervals, [&](double interval) { return interval > kGap * usual; }));
}

/// One value of a signal_t.
void count(const nlohmann::ordered_json& message, std::map<std::string, SignalSummary>& signals) {
  if (!message.at("value").is_number()) return;
  const double value = message.at("value").get<double>();
  const auto [at, fresh] = signals.try_emplace(message.at("name").get<std::string>());
  SignalSummary& one = at->second;
  if (fresh) one = {message.at("name"), message.at("quantity"), message.at("unit"), 0, value, value};
  ++one.messages;
  one.least = std::min(one.least, value);
  one.largest = std::max(one.largest, value);
}

std::string number_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

LogSummary summary_of(const std::string& log) {
  const Definitions& definitions = Definitions::built_in();
  LogSummary summary;
  std::map<std::string, Gathered> channels;
  std::map<std::string, ProcessSummary> processes;
  std::map<std::string, SignalSummary> signals;
  EventLog events{log};
  while (const auto event = events.next()) {
    if (summary.events++ == 0) summary.begin = event->time;
    summary.end = event->time;
    const Type* type = definitions.type_of(event->data);
    Gathered& gathered = channels[std::string{event->channel}];
    gathered.summary.channel = event->channel;
    if (type != nullptr) gathered.summary.type = type->name;
    ++gathered.summary.messages;
    gathered.summary.bytes += event->data.size();
    gathered.stamps.push_back(stamp_of(*event, type));
    if (type == nullptr) continue;
    const auto message = decoded(definitions, *type, event->data, Bytes::kCount);
    if (!message) {
      ++gathered.summary.damaged;
    } else if (type->name == "signal_t") {
      count(*message, signals);
    } else if (type->name == "process_info_t") {
      ProcessSummary& process = processes[message->at("process").get<std::string>()];
      process = {message->at("process"), message->at("version"), message->at("config")};
    }
  }
  for (auto& [channel, gathered] : channels) {
    measure(gathered, summary.begin);
    summary.channels.push_back(std::move(gathered.summary));
  }
  for (auto& [name, one] : signals) summary.signals.push_back(std::move(one));
  for (auto& [name, process] : processes) summary.processes.push_back(std::move(process));
  summary.warning = events.warning();
  return summary;
}

std::string words_of(const std::string& log, const LogSummary& summary) {
  std::string text;
  char line[256];
  const auto add = [&](const char* format, auto... values) {
    std::snprintf(line, sizeof line, format, values...);
    text += line;
  };
  const double length = seconds_between(summary.begin, summary.end);
  text += log + "\n";
  add("  %llu messages in %.1f s", static_cast<unsigned long long>(summary.events), length);
  if (const auto date = utc_text(summary.begin)) text += ", from " + *date;
  text += "\n";
  if (!summary.warning.empty()) text += "  ! " + summary.warning + "\n";
  add("\n  %-16s %-18s %9s %9s %9s  %s\n", "channel", "type", "messages", "Hz", "kB", "longest pause");
  for (const ChannelSummary& one : summary.channels) {
    add("  %-16s %-18s %9llu ", one.channel.c_str(), one.type.empty() ? "unknown here" : one.type.c_str(),
        static_cast<unsigned long long>(one.messages));
    if (std::isfinite(one.rate)) {
      add("%9.4g ", one.rate);
    } else {
      add("%9s ", "-");
    }
    add("%9.4g  ", static_cast<double>(one.bytes) / 1000.0);
    if (one.messages > 1) add("%.3g s at %.1f s", one.longest, one.longest_at);
    if (one.gaps > 0) add("; %llu gaps", static_cast<unsigned long long>(one.gaps));
    if (one.damaged > 0) add("; %llu damaged", static_cast<unsigned long long>(one.damaged));
    text += "\n";
  }
  if (!summary.signals.empty()) text += "\n  columns carried by SIGNAL\n";
  for (const SignalSummary& one : summary.signals)
    text += "  " + one.name + (one.quantity.empty() ? "" : " (" + one.quantity + ")") + ": " +
            std::to_string(one.messages) + " values from " + number_of(one.least) + " to " + number_of(one.largest) +
            (one.unit.empty() ? "" : " " + one.unit) + "\n";
  if (summary.processes.empty()) return text + "\n  no PROCESS_INFO: no configuration is embedded\n";
  text += "\n  configuration embedded ('fathom info LOG --config PROCESS' prints it)\n";
  for (const ProcessSummary& one : summary.processes)
    add("  %-16s version %s, %zu lines\n", one.process.c_str(), one.version.c_str(),
        static_cast<std::size_t>(std::ranges::count(one.config, '\n')));
  return text;
}

}  // namespace fathom::exports
