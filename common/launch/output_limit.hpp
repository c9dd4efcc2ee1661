// What commands print, collected into messages: a program that prints without pause must not fill the network.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/samples/launch.hpp"

namespace fathom::launch {

class OutputLimit {
 public:
  static constexpr double kRate = 50e3;         ///< B/s of one command, in the long run
  static constexpr double kBurst = 100e3;       ///< B at once
  static constexpr double kReopen = 10e3;       ///< B of allowance that a flood waits for
  static constexpr std::size_t kEnough = 4096;  ///< B that are told without waiting for more
  static constexpr double kWait = 0.010;        ///< s that others are waited for

  void add(const std::string& id, std::string_view text, double now);
  /// What is due; nothing while more may come.
  [[nodiscard]] std::vector<LaunchOutput::Text> take(double now);
  /// Text waits to be taken, be it not due yet.
  [[nodiscard]] bool waiting() const { return waiting_ > 0; }

 private:
  struct Tap {
    std::string text;
    double allowance{kBurst};
    double filled{-1e9};  ///< when the allowance was last added to
    std::size_t lost{};
  };
  std::map<std::string, Tap> taps_;
  std::size_t waiting_{};  ///< B
  double last_{-1e9};
};

}  // namespace fathom::launch
