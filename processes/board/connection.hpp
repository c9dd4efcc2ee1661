// One client's connection for cpp-httplib. The library's own waits anew for every byte, so that a client which sends
// one every few seconds holds a thread for ever; this one has so long, and so many bytes, for the whole request.
#pragma once

#include <httplib.h>

#include <array>
#include <atomic>
#include <chrono>

namespace fathom::board {

class Connection : public httplib::Stream {
 public:
  static constexpr std::chrono::seconds kPatience{3};  ///< for request and answer together
  static constexpr std::size_t kMostBytes = 16'384;    ///< of a request; browsers send less than one thousand

  /// Gives up when `leaving` becomes true.
  Connection(socket_t socket, const std::atomic<bool>& leaving) : socket_{socket}, leaving_{leaving} {}
  [[nodiscard]] bool is_readable() const override;
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* to, std::size_t size) override;
  ssize_t write(const char* from, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override { nowhere(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { nowhere(ip, port); }
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  static void nowhere(std::string& ip, int& port) {
    ip.clear();
    port = 0;
  }
  [[nodiscard]] bool ready(short events) const;

  socket_t socket_;
  const std::atomic<bool>& leaving_;
  std::chrono::steady_clock::time_point end_{std::chrono::steady_clock::now() + kPatience};
  std::array<char, 2048> buffer_{};
  std::size_t begin_{}, filled_{}, received_{};
};

}  // namespace fathom::board
