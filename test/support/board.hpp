// A board of a test at any free port.
#pragma once

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "test/support/bus.hpp"
#include "test/support/http.hpp"

namespace fathom::test {

struct Board {
  explicit Board(const std::string& arguments)
      : background{scratch, "board", program("board") + " --port 0" + arguments}, port{wait()} {}

  [[nodiscard]] nlohmann::json json() const {
    nlohmann::json told;
    for (int i = 0; i < 1000 && !told.contains("number"); ++i) {  // it listens before it has looked for the first time
      httplib::Client client{"127.0.0.1", port};
      client.set_read_timeout(20);
      const auto answer = client.Get("/board.json");
      REQUIRE(answer);
      CHECK(answer->status == 200);
      told = nlohmann::json::parse(answer->body);
      if (!told.contains("number")) ::usleep(20'000);
    }
    REQUIRE(told.contains("number"));
    return told;
  }
  /// What it shows once it is `enough`; the newest when it never is.
  template <class Enough>
  [[nodiscard]] nlohmann::json until(Bus& bus, Enough enough) const {
    nlohmann::json shown;
    static_cast<void>(bus.until([&] { return enough(shown = json()); }));
    return shown;
  }

  Scratch scratch;
  Background background;
  int port;

 private:
  [[nodiscard]] int wait() const {
    const std::string words = "look at http://", path = scratch.path("board.text");
    for (const double end = link::wall_seconds() + 30.0; link::wall_seconds() < end; ::usleep(20'000)) {
      const std::string said = read_bytes(path);
      const auto at = said.find(words);
      const auto colon = said.find(':', at == std::string::npos ? at : at + words.size());
      if (at != std::string::npos && colon != std::string::npos && said.find('/', colon) != std::string::npos)
        return std::stoi(said.substr(colon + 1));
    }
    FAIL(read_bytes(path));
    return 0;
  }
};

}  // namespace fathom::test
