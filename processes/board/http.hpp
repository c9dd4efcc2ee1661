// The board's HTTP side: four texts to whoever asks, in threads of its own, whatever the clients do.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace fathom::board {

class Server {
 public:
  /// Listens from now on; port 0: any free one. InputError with what to do about it when it cannot.
  Server(const std::string& host, int port);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// What the next clients are told.
  void show(std::string json);

 private:
  class Http;
  [[nodiscard]] std::shared_ptr<const std::string> shown() const;

  std::unique_ptr<Http> http_;
  int port_{};
  mutable std::mutex mutex_;
  std::shared_ptr<const std::string> json_;
  std::thread thread_;
};

}  // namespace fathom::board
