// What systemd wants to hear of a service of "Type=notify": that it is ready, that it goes on (its watchdog), that it
// stops. A datagram each to the socket that systemd names (sd_notify(3)); without one nothing is said.
#pragma once

#include <string>

namespace fathom::deputy {

class Systemd {
 public:
  /// Takes NOTIFY_SOCKET and WATCHDOG_USEC out of the environment: they are not for the programs that a deputy starts.
  Systemd();
  ~Systemd();
  Systemd(const Systemd&) = delete;
  Systemd& operator=(const Systemd&) = delete;

  void ready(const std::string& status);
  void stopping();
  /// To be called in every round, with a steady clock [s]: tells the watchdog as often as it wants. Seconds until it
  /// should be called again.
  [[nodiscard]] double alive(double now);

 private:
  void say(const std::string& text) const;
  std::string address_;
  int socket_{-1};
  double period_{0.0};  ///< s between two words, half of what the watchdog waits; 0: it does not
  double next_{0.0};
};

}  // namespace fathom::deputy
