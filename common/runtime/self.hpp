// What a process knows of itself: host and number, what it uses of the machine, and whether another one of its name
// speaks on the same bus.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

namespace fathom::runtime {

/// Processor time and memory of this process.
class Usage {
 public:
  struct Figures {
    double cpu{};           ///< share of one core since the last call
    std::int64_t memory{};  ///< resident [B]
  };
  [[nodiscard]] Figures measure();

 private:
  std::chrono::steady_clock::time_point last_{std::chrono::steady_clock::now()};
  double used_{};  ///< s, until then
};

/// "vehicle" or "topside": the host's name.
[[nodiscard]] std::string host_name();

/// Hears everybody's HEALTH and looks for a process of the same name elsewhere.
class Twins {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kRemembered{3};  ///< HEALTH comes each second; one may be lost

  Twins(std::string name, std::string host, std::int32_t pid);
  void hear(std::span<const std::uint8_t> health, Clock::time_point now);
  /// One line while there is another; empty otherwise.
  [[nodiscard]] std::string complaint(Clock::time_point now) const;

 private:
  std::string name_, host_;
  std::int32_t pid_;
  std::string other_;
  Clock::time_point heard_{};
};

}  // namespace fathom::runtime
