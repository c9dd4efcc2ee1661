// The instrument's end of a line, for emulators: a pseudo-terminal or a TCP port with one client at a time.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fathom::link {

class Server {
 public:
  /// "pty", "pty:PATH" (PATH becomes a symbolic link to the terminal), "tcp:PORT" (0: any free one) on this host only.
  explicit Server(const std::string& to);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Somebody is at the other end.
  [[nodiscard]] bool connected() const;
  /// Waits for bytes from the client, at most so long; returns what came.
  [[nodiscard]] std::string wait(double seconds);
  /// Returns how many bytes were taken; the rest is lost, as on a line that nobody reads. Nothing without a client.
  std::size_t send(std::string_view bytes);
  /// Waits until a client has read what was sent, or takes nothing for five seconds: a line that ends takes the rest
  /// with it.
  void drain();

 private:
  void accept_client();

  std::string name_, link_path_;
  int listener_{-1}, descriptor_{-1};
  bool terminal_{false};
};

/// s since 1970.
[[nodiscard]] double wall_seconds();

}  // namespace fathom::link
