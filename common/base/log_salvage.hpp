// Takes the whole events out of a damaged log: those before the damage and those behind it; and parts recordings that
// were joined into one file.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace fathom {

struct Salvage {
  struct Damage {
    std::uint64_t offset{}, bytes{};  ///< in the damaged log
    std::uint64_t events_before{};    ///< kept until there
  };
  struct Part {
    std::string path;               ///< where it was written; empty when it was handed on
    std::uint64_t begin{};          ///< byte in the damaged log
    std::uint64_t events_before{};  ///< kept of the parts before it
  };
  std::uint64_t events{}, bytes{};                ///< kept
  std::vector<Part> parts;                        ///< recordings, one in most logs
  std::map<std::string, std::uint64_t> channels;  ///< events kept of each
  std::vector<Damage> damages;                    ///< what was left out, in order
  [[nodiscard]] std::uint64_t lost() const;       ///< bytes
};

/// Hands every whole event to `keep`, byte for byte, with the number of its recording, counted from 0. An event counts
/// as whole when another one or the end of the file follows it, or rubbish without any whole event inside what the
/// event says is its length.
[[nodiscard]] Salvage salvage(std::span<const std::uint8_t> log,
                              const std::function<void(std::span<const std::uint8_t>, std::size_t part)>& keep);

/// The same from file to file; several recordings go to "TO-1.lcmlog", "TO-2.lcmlog" and so on. InputError when one
/// cannot be read, the other exists or cannot be written, or nothing whole is in it.
[[nodiscard]] Salvage salvage(const std::string& from, const std::string& to);

}  // namespace fathom
