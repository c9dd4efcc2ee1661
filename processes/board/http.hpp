// The board's HTTP side: some texts to whoever asks, and the one order that a page may give: to abort. One thread
// serves all clients, each as far as it has come, so that no number of slow ones keeps another one waiting.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fathom::board {

class Server {
 public:
  /// Listens from now on; port 0: any free one. `names`: by which a browser may call this host, beside its addresses,
  /// its own name and "localhost". InputError with what to do about it when it cannot.
  /// `aborting`: ABORT is heard, from this host; false where a log is played.
  Server(const std::string& host, int port, const std::vector<std::string>& names = {}, bool aborting = true);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// What the next clients are told.
  void show(std::string json);
  /// Can be read when somebody has pressed ABORT, until taken().
  [[nodiscard]] int aborts() const { return aborts_; }
  /// Whether somebody has, since it was asked last.
  [[nodiscard]] bool taken() const;

 private:
  class Http;
  struct Client;
  [[nodiscard]] std::shared_ptr<const std::string> shown() const;
  void serve();
  void accept_clients();
  /// False when the client has come to its end.
  [[nodiscard]] bool attend(Client& client, short events);

  std::unique_ptr<Http> http_;
  int port_{}, listener_{-1}, wake_{-1}, aborts_{-1};
  mutable std::mutex mutex_;
  std::shared_ptr<const std::string> json_;
  std::list<Client> clients_;  ///< the oldest first
  std::thread thread_;
};

}  // namespace fathom::board
