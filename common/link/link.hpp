// One line to an instrument, whatever it is made of. Opens itself again with growing pauses; one thread, no blocking.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/link/endpoint.hpp"

namespace fathom::link {

class Link {
 public:
  using Received = std::function<void(std::span<const std::uint8_t> bytes, Utime arrival)>;
  /// `why` is one line that names the remedy; empty when the link is up.
  using Changed = std::function<void(bool up, const std::string& why)>;

  Link(Endpoint endpoint, Received received, Changed changed);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Serves the line until a descriptor is readable, something was received, or the time is up.
  void wait(std::span<const int> descriptors, int milliseconds);
  /// Queued; dropped when the link is down.
  void send(std::span<const std::uint8_t> bytes);
  void send(const std::string& text);
  [[nodiscard]] bool up() const;
  /// A file has been read to its end.
  [[nodiscard]] bool finished() const;
  [[nodiscard]] std::uint64_t openings() const;  ///< times that the link came up
  [[nodiscard]] const Endpoint& endpoint() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fathom::link
