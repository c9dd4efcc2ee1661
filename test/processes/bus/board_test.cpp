// The board over a real bus and real HTTP: what it shows, what it refuses, and that no client harms it.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <fathom_lcm/excitation_t.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "common/runtime/self.hpp"
#include "test/support/bus.hpp"
#include "test/support/channels.hpp"
#include "test/support/http.hpp"
#include "test/support/private_network.hpp"
#include "test/support/sleeper.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::program;
using test::Scratch;
using test::shell;
using Json = nlohmann::json;

constexpr char kHost[] = "127.0.0.1";

/// A board at any free port, once it listens.
struct Running {
  explicit Running(Bus& bus)
      : background{scratch, "board", program("board") + " --port 0 --in '" + bus.url + "'"}, port{wait(bus)} {}

  [[nodiscard]] Json json() const {
    httplib::Client client{kHost, port};
    const auto answer = client.Get("/board.json");
    REQUIRE(answer);
    CHECK(answer->status == 200);
    return Json::parse(answer->body);
  }
  /// What it shows once it is `enough`; the newest when it never is.
  template <class Enough>
  [[nodiscard]] Json until(Bus& bus, Enough enough) const {
    Json shown;
    for (int i = 0; i < 100 && !enough(shown = json()); ++i) bus.listen(0.1);
    return shown;
  }

  Scratch scratch;
  Background background;
  int port;

 private:
  [[nodiscard]] int wait(Bus& bus) const {
    const std::string words = std::string{"http://"} + kHost + ":";
    for (int i = 0; i < 200; ++i) {
      const std::string said = test::read_bytes(scratch.path("board.text"));
      if (const auto at = said.find(words); at != std::string::npos && said.find('/', at + words.size()) != said.npos)
        return std::stoi(said.substr(at + words.size()));
      bus.listen(0.05);
    }
    FAIL(test::read_bytes(scratch.path("board.text")));
    return 0;
  }
};

fathom_lcm::health_t health(const std::string& name, int pid) {
  fathom_lcm::health_t message = test::word_of(name);
  message.pid = pid;
  return message;
}

bool is_board(const Json& entry) { return entry["name"].get<std::string>().starts_with("board@"); }

int connected(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  return socket;
}

}  // namespace

TEST_CASE("board: hears and says what docs/messages.md tells, and says nothing but of itself, and an abort") {
  const auto ran = shell(program("board") + " --interface");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const test::Channels actual = test::channels_of(ran.text), stated = test::channels_in_docs("board");
  CHECK(actual.hears == stated.hears);
  CHECK(actual.says == stated.says);
  CHECK(actual.says ==
        std::set<std::string>{"HEALTH", "PROCESS_INFO", "OPERATOR"});  // of it aborts alone: board_page_test
  CHECK_FALSE(actual.hears.contains("OPERATOR"));
}

TEST_CASE("board: shows what the bus says, hostile names and all, as text in JSON") {
  Bus bus;
  const Running board{bus};
  CHECK(board.json()["heard"].is_null());  // but for itself
  const std::string hostile = "</script><script>alert('x')</script>";
  const Json shown = board.until(bus, [&](const Json& all) {
    fathom_lcm::excitation_t said{};
    said.utime = test::now();
    said.phase = "excite";
    said.mode = "yaw";
    said.metric = 0.5;
    bus.publish("EXCITATION", said);
    const auto one = health(hostile, 5);
    bus.publish("HEALTH", one);
    const auto two = health("estimator", 6), three = health("estimator", 7);
    bus.publish("HEALTH", two);
    bus.publish("HEALTH", three);
    said.metric = std::numeric_limits<double>::quiet_NaN();
    bus.publish("EXCITATION", said);
    return all.contains("trial") && !all["trial"].is_null() && all["processes"].size() == 4 &&
           all["processes"].back()["second"] == true;
  });
  CHECK(shown["trial"]["armed"] == true);
  CHECK(shown["trial"]["metric"] == doctest::Approx(0.5));  // the other one is refused
  CHECK(shown["heard"].get<double>() < 3.0);
  REQUIRE(shown["processes"].size() == 4);
  CHECK(shown["processes"][0]["name"] == hostile);
  CHECK(shown["processes"][3]["second"] == true);
  const Json silent = board.until(bus, [](const Json& all) { return all.contains("heard") && all["heard"] > 3.0; });
  CHECK(silent["heard"] > 3.0);
  CHECK(silent["processes"][0]["state"] == "silent");
  httplib::Client client{kHost, board.port};
  const auto page = client.Get("/");
  REQUIRE(page);
  CHECK(page->status == 200);
  CHECK(page->body.find("alert") == std::string::npos);
  CHECK(page->get_header_value("Content-Security-Policy").starts_with("default-src 'self'"));
  for (const char* part : {"/style.css", "/script.js"}) {
    const auto answer = client.Get(part);
    REQUIRE(answer);
    CHECK(answer->status == 200);
  }
}

TEST_CASE("board: refuses what it does not have, and what is absurd, and goes on") {
  Bus bus;
  const Running board{bus};
  httplib::Client client{kHost, board.port};
  const auto unknown = client.Get("/../../etc/passwd");
  REQUIRE(unknown);
  CHECK(unknown->status == 404);
  const auto order = client.Post("/board.json", "arm", "text/plain");
  if (order) CHECK(order->status >= 400);
  for (const std::size_t length : {9'000, 5'000'000}) {
    httplib::Client other{kHost, board.port};
    const auto refused = other.Get("/" + std::string(length, 'a'));
    if (refused) CHECK(refused->status >= 400);
  }
  httplib::Headers many;
  for (int i = 0; i < 5000; ++i) many.emplace("X-" + std::to_string(i), std::string(100, 'y'));
  const auto heavy = httplib::Client{kHost, board.port}.Get("/board.json", many);
  CHECK((!heavy || heavy->status >= 400));
  std::string ranges = "bytes=0-";  // would be answered with a thousand copies
  for (int i = 0; i < 1000; ++i) ranges += ",0-";
  const auto copies = httplib::Client{kHost, board.port}.Get("/script.js", {{"Range", ranges}});
  if (copies) CHECK(copies->body.size() < 100'000);
  CHECK(board.json()["number"] > 0);
}

TEST_CASE(
    "board: fifty clients at once, others that send nothing and others that leave; no message is lost meanwhile") {
  Bus bus;
  const Running board{bus};
  // Of them some say nothing, some half a line, some leave without their answer.
  std::vector<int> bad;
  for (int i = 0; i < 100; ++i) {
    const int socket = connected(board.port);
    const std::string half = i % 3 == 0 ? "" : (i % 3 == 1 ? "GET /boa" : "GET /board.json HTTP/1.1\r\n\r\n");
    (void)::send(socket, half.data(), half.size(), MSG_NOSIGNAL);
    if (i % 3 == 2) {
      ::close(socket);
    } else {
      bad.push_back(socket);
    }
  }
  std::atomic<int> well{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back([&] {
      for (int k = 0; k < 60; ++k) {  // as the page does: it asks again
        httplib::Client client{kHost, board.port};
        client.set_read_timeout(10);
        const auto answer = client.Get("/board.json");
        if (answer && answer->status == 200 && Json::accept(answer->body)) {
          ++well;
          return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{200});
      }
    });
  }
  constexpr int kSaid = 3000;
  for (int i = 0; i < kSaid; ++i) {
    bus.publish("HEALTH", health("process " + std::to_string(i % 20), i % 20));
    if (i % 5 == 0) bus.listen(0.002);
  }
  for (std::thread& each : clients) each.join();
  CHECK(well == 50);
  const Json own = board.until(bus, [&](const Json& all) {
    for (const Json& each : all.value("processes", Json::array())) {
      if (is_board(each) && each["received"] >= kSaid) return true;
    }
    return false;
  });
  for (const Json& each : own["processes"]) {
    if (!is_board(each)) continue;
    CHECK(each["received"] >= kSaid);
    CHECK(each["dropped"] == 0);
    CHECK(each["memory"] < 100'000'000);
  }
  for (const int each : bad) ::close(each);
}

TEST_CASE("board: it has one name from its first word on, and does not call itself silent") {
  Bus bus;
  const Running board{bus};
  for (int i = 0; i < 45; ++i) bus.listen(0.1);  // longer than silence is waited for
  const Json shown = board.json();
  REQUIRE(shown["processes"].size() == 1);
  CHECK(is_board(shown["processes"][0]));
  CHECK(shown["processes"][0]["state"] == "running");
  CHECK(shown["standing"]["alarm"].get<std::string>().starts_with("nothing heard on this bus yet"));
}

TEST_CASE("board: three hundred slow clients keep nobody waiting") {
  Bus bus;
  const Running board{bus};
  std::vector<int> slow;
  for (int i = 0; i < 300; ++i) {
    slow.push_back(connected(board.port));
    const std::string half = i % 2 == 0 ? "GET /boa" : "GET /board.json HTTP/1.1\r\nHost: ";
    (void)::send(slow.back(), half.data(), half.size(), MSG_NOSIGNAL);
  }
  for (int i = 0; i < 5; ++i) {
    const double begin = link::wall_seconds();
    CHECK(board.json()["number"] > 0);
    CHECK(link::wall_seconds() - begin < 1.0);
  }
  for (const int each : slow) ::close(each);
}

TEST_CASE("board: a page of the wide world that calls this host by its own name is refused") {
  Bus bus;
  const Running board{bus};
  const auto status = [&](const std::string& host) {
    httplib::Client client{kHost, board.port};
    const auto answer = client.Get("/board.json", {{"Host", host}});
    REQUIRE(answer);
    return answer->status;
  };
  const std::string port = ":" + std::to_string(board.port);
  for (const std::string& good : {"127.0.0.1" + port, "localhost" + port, "LOCALHOST" + port, "[::1]" + port,
                                  std::string{"192.168.2.1"}, runtime::host_name() + port}) {
    CAPTURE(good);
    CHECK(status(good) == 200);
  }
  for (const std::string bad : {"evil.example:8077", "127.0.0.1.evil.example", "localhost.evil.example", "[evil", ""}) {
    CAPTURE(bad);
    CHECK(status(bad) == 421);
  }
}

TEST_CASE("board: two on one bus are both well, and a true twin of one is still told") {
  Bus bus;
  const Running one{bus}, two{bus};
  const auto boards = [](const Json& all) {
    std::vector<Json> found;
    for (const Json& each : all.value("processes", Json::array())) {
      if (is_board(each)) found.push_back(each);
    }
    return found;
  };
  for (int i = 0; i < 40; ++i) bus.listen(0.1);  // longer than twins need to hear each other
  for (const Running* board : {&one, &two}) {
    const Json shown = board->until(bus, [&](const Json& all) { return boards(all).size() == 2; });
    REQUIRE(boards(shown).size() == 2);
    for (const Json& each : boards(shown)) {
      CAPTURE(each.dump());
      CHECK(each["healthy"] == true);
      CHECK(each["second"] == false);
      CHECK(each["state"] == "running");
    }
  }
  CHECK(boards(one.json())[0]["name"] != boards(one.json())[1]["name"]);
  const std::string name = boards(one.json())[0]["name"];
  for (int i = 0; i < 20; ++i) {
    fathom_lcm::health_t twin = health(name, 7);
    twin.host = "elsewhere";
    bus.publish("HEALTH", twin);
    bus.listen(0.1);
  }
  const Json told = one.json();
  CHECK(std::any_of(told["processes"].begin(), told["processes"].end(),
                    [](const Json& each) { return is_board(each) && each["second"] == true; }));
}

TEST_CASE("board: HEALTH in the name of a dead process of this host shows nobody") {
  Bus bus;
  const Running board{bus};
  test::Sleeper alive, dead;
  dead.end();
  const Json shown = board.until(bus, [&](const Json& all) {
    for (const auto& [name, one] : {std::pair{"dead", &dead}, std::pair{"alive", &alive}}) {
      auto word = health(name, one->pid);
      word.host = runtime::host_name();
      word.start = one->start;
      bus.publish("HEALTH", word);
    }
    return all["processes"].size() > 1;
  });
  const auto named = [&](const std::string& name) {
    return std::ranges::any_of(shown["processes"], [&](const Json& each) { return each["name"] == name; });
  };
  CHECK(named("alive"));
  CHECK_FALSE(named("dead"));
}

TEST_CASE("board: a client that does not go on cannot keep it from stopping") {
  Bus bus;
  const Running board{bus};
  const int socket = connected(board.port);
  const double begin = link::wall_seconds();
  board.background.stop();
  CHECK(link::wall_seconds() - begin < 2.0);
  ::close(socket);
}

TEST_CASE("board: where it cannot listen it says why and what to do, in one line") {
  Bus bus;
  const Running board{bus};
  const auto fails = [&](const std::string& arguments, const std::string& words, const std::string& before = "") {
    const auto ran = shell("timeout 20 " + before + program("board") + " --in '" + bus.url + "' " + arguments);
    CHECK(ran.code == 1);
    CHECK(ran.lines() == 1);
    CHECK_MESSAGE(ran.says(words), ran.text);
  };
  fails("--port " + std::to_string(board.port), "another program listens at");
  fails("--host no.such.host.invalid", "is not known");
  fails("--host 192.0.2.1", "is no address of this host");
  fails("--port 70000", "--port");
  fails("--port eighty", "--port");
  const auto log = shell(program("board") + " --in file:///dev/null --out file:///dev/full");
  CHECK(log.code == 1);
  CHECK_MESSAGE(log.says("the board shows a live bus"), log.text);
  if (!test::private_network()) return;
  const auto least = test::read_bytes("/proc/sys/net/ipv4/ip_unprivileged_port_start");
  if (!least.empty() && std::stoi(least) > 80) fails("--port 80", "need permission", "unshare -r ");
}

}  // namespace fathom
