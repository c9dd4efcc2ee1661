// A log's channels as files that other programs open, and what a log holds.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/exports/definitions.hpp"

namespace fathom::exports {

struct Exported {
  std::map<std::string, std::uint64_t> written;  ///< messages by channel
  std::map<std::string, std::uint64_t> damaged;  ///< messages that could not be decoded
  std::map<std::string, std::uint64_t> unknown;  ///< of a type that this build does not have
  std::string warning;                           ///< a line where the log was cut off; empty otherwise
};

/// A file CHANNEL.csv for each channel in `folder`, and columns.txt, which says what each column is. `channels`: those
/// alone; empty: all. InputError when the log cannot be read, a channel is not in it, or a file cannot be written.
Exported to_csv(const std::string& log, const std::string& folder, std::span<const std::string> channels);

/// One MCAP file with JSON messages and a JSON schema per channel; log time is the recorder's, publish time the
/// message's own. With the definitions of another project its logs are understood.
Exported to_mcap(const std::string& log, const std::string& file, std::span<const std::string> channels,
                 const Definitions& definitions = Definitions::built_in());

/// One .npz with an array per field, named "CHANNEL/field": a row per message, then the field's own dimensions, in the
/// order of the log. "CHANNEL/t" is [s] since the log's first message. Lists of other lengths are filled with NaN,
/// texts with nothing. "about" is JSON: types, units and comments of all fields.
Exported to_npz(const std::string& log, const std::string& file, std::span<const std::string> channels);

struct ChannelSummary {
  std::string channel, type;  ///< type empty: unknown
  std::uint64_t messages{}, bytes{}, damaged{};
  double rate{};         ///< Hz, from first to last; NaN for less than two
  double longest{};      ///< s, between two messages
  double longest_at{};   ///< s, where that begins, from the log's first message
  std::uint64_t gaps{};  ///< of more than kGap usual intervals, of channels that come regularly
};

inline constexpr double kGap = 5.0;  ///< usual intervals (median) without a message: something was lost

struct ProcessSummary {
  std::string process, version, config;
};

/// One name on the channel SIGNAL.
struct SignalSummary {
  std::string name, quantity, unit;
  std::uint64_t messages{};
  double least{}, largest{};  ///< unit
};

struct LogSummary {
  std::uint64_t events{};
  std::int64_t begin{}, end{};  ///< us, stamps of the first and last event
  std::vector<ChannelSummary> channels;
  std::vector<SignalSummary> signals;     ///< by name
  std::vector<ProcessSummary> processes;  ///< what each said of itself (PROCESS_INFO), the last word of each
  std::string warning;
};

[[nodiscard]] LogSummary summary_of(const std::string& log);
/// For a terminal.
[[nodiscard]] std::string words_of(const std::string& log, const LogSummary& summary);

}  // namespace fathom::exports
