// The page's one order, a log that is played on it, and the page itself in a browser where there is one.
#include <doctest/doctest.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/runtime/self.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/minds.hpp"
#include "test/support/board.hpp"
#include "test/support/orders.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::Board;
using test::Bus;
using test::now;
using test::program;
using test::Scratch;
using test::shell;
using Json = nlohmann::json;

int press(int port, const httplib::Headers& headers = {{"X-Fathom", "abort"}}, const std::string& host = "127.0.0.1") {
  httplib::Client client{host, port};
  const auto answer = client.Post("/abort", headers, "", "text/plain");
  REQUIRE(answer);
  return answer->status;
}

/// An address of this host that is not the loopback's; empty where there is none.
std::string outer_address() {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return {};
  std::string found;
  for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(each->ifa_addr);
    char text[INET_ADDRSTRLEN];
    inet_ntop(AF_INET, &address->sin_addr, text, sizeof text);
    if (!std::string{text}.starts_with("127.")) found = text;
  }
  ::freeifaddrs(all);
  return found;
}

/// Ten minutes of a trial in the tank, as a log has them.
Recording trial() {
  Recording run{.name = "run"};
  std::string config;
  for (const char* name :
       {"config/vehicles/seabotix_lbv150.yaml", "config/sites/tank.yaml", "config/pipelines/tank.yaml"})
    config +=
        std::string{"# file "} + name + "\n" + test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/" + name) + "\n";
  run.process_info.push_back({.utime = 1'000'000, .process = "supervisor", .version = "1", .config = config});
  for (int i = 0; i < 6000; ++i) {
    const Utime utime = 1'000'000 + 100'000 * static_cast<Utime>(i);
    const double t = 0.1 * i;
    StateEstimate state{.utime = utime, .valid = true};
    state.p_WB = {1.5 * std::cos(0.05 * t), 0.8 * std::sin(0.05 * t), 0.7};
    state.sigma.setConstant(0.01);
    run.state.push_back(state);
    Thrusters thrusters{.utime = utime, .force = {1.0, -1.0, 0.5, 0.0}, .has_tau = true};
    run.thrusters.push_back(thrusters);
    run.excitation.push_back({.utime = utime,
                              .elapsed = t,
                              .duration = 700.0,
                              .mode = i < 5900 ? "yaw" : "",
                              .phase = i < 5900 ? "excite" : "done",
                              .metric = 0.3,
                              .threshold = 0.08});
    if (i % 5 == 0) run.residual.push_back({.utime = utime, .wrench = Vector6d::Constant(0.1 * std::sin(t))});
    if (i % 10 != 0) continue;
    run.model.push_back(
        {.utime = utime, .parameters = {{.name = "m_X", .value = 12.0, .std = 5.0 / (1.0 + t), .unit = "kg"}}});
    run.effects.push_back({.utime = utime,
                           .verdict = "effect",
                           .candidates = {{.name = "current", .log_odds = 5.0, .error_reduction = 0.4},
                                          {.name = "wave_surge", .log_odds = -2.0}}});
  }
  return run;
}

Board played(const Scratch& scratch) {
  wire::write_log(trial(), scratch.path("run.lcmlog"));
  return Board{" --replay '" + scratch.path("run.lcmlog") + "' --speed 1000"};
}

bool is_over(const Json& all) {
  return all.contains("replay") && !all["replay"].is_null() && all["replay"]["over"] == true;
}

}  // namespace

TEST_CASE("board: ABORT on the page is an abort on the bus and nothing else, and the page says when it is confirmed") {
  Bus bus;
  const Board board{" --in '" + bus.url + "'"};
  REQUIRE(press(board.port) == 202);
  const OperatorKeys keys = test::simulated_keys();
  std::size_t answered = 0;
  const auto confirmed = [&] {
    for (; answered < bus.orders.size(); ++answered) {
      const Answer answer{.utime = now(),
                          .process = "simulator",
                          .gate = true,
                          .challenge = 5,
                          .sequence = bus.orders[answered].sequence,
                          .done = true,
                          .text = "aborted"};
      bus.publish("ANSWER", wire::encode_signed(answer, keys.answer));
    }
    fathom_lcm::thrusters_t zero{};
    zero.utime = now();
    zero.has_tau = 1;
    bus.publish("THRUSTERS", zero);
    const Json shown = board.json();
    if (shown["abort"].is_null()) return false;
    if (shown["abort"]["state"] == "not confirmed") press(board.port);  // a machine that was too slow for 2 s
    return shown["abort"]["state"] == "confirmed";
  };
  REQUIRE_MESSAGE(bus.until(confirmed), board.json().dump());
  REQUIRE_FALSE(bus.orders.empty());
  for (const auto& order : bus.orders) {
    CHECK(order.abort == 1);
    CHECK(order.enable == 0);
    CHECK(order.order.empty());
    CHECK(order.sequence != 0);
  }
  CHECK(board.json()["events"].dump().find("ABORT was pressed") != std::string::npos);
}

TEST_CASE("board: where nothing answers the page says NOT CONFIRMED and what the hands can do") {
  Bus bus;
  const Board board{" --in '" + bus.url + "'"};
  REQUIRE(press(board.port) == 202);
  const Json shown = board.until(bus, [](const Json& all) {
    return all.contains("abort") && !all["abort"].is_null() && all["abort"]["state"] == "not confirmed";
  });
  CHECK_MESSAGE(shown["abort"]["text"].get<std::string>().find("kill switch") != std::string::npos, shown.dump());
}

TEST_CASE("board: another page, another host and whatever is no abort give no order") {
  Bus bus;
  const Board board{" --host 0.0.0.0 --in '" + bus.url + "'"};
  const std::string own = "127.0.0.1:" + std::to_string(board.port);
  CHECK(press(board.port, {}) == 403);  // as a form of any page would send it
  CHECK(press(board.port, {{"X-Fathom", "arm"}}) == 403);
  CHECK(press(board.port, {{"X-Fathom", "abort"}, {"Origin", "http://evil.example"}}) == 403);
  CHECK(press(board.port, {{"X-Fathom", "abort"}, {"Host", "evil.example"}}) == 421);
  httplib::Client client{"127.0.0.1", board.port};
  const auto asked = client.Options("/abort");  // before a foreign page may set a header, the browser asks
  if (asked) CHECK(asked->get_header_value("Access-Control-Allow-Origin").empty());
  const auto got = client.Get("/abort");
  if (got) CHECK(got->status == 404);
  if (const std::string outer = outer_address(); !outer.empty()) {
    CAPTURE(outer);
    CHECK(press(board.port, {{"X-Fathom", "abort"}}, outer) == 403);
  }
  bus.listen(1.0);
  CHECK(bus.orders.empty());
  CHECK(board.json()["abort"].is_null());
  CHECK(press(board.port, {{"X-Fathom", "abort"}, {"Origin", "http://" + own}}) == 202);
  CHECK(bus.until([&] { return !bus.orders.empty(); }));
}

TEST_CASE("board: a log is played as its trial went, and at its end the page stays and is not red") {
  const Scratch scratch;
  const Board board = played(scratch);
  Bus bus;
  const Json shown = board.until(bus, is_over);
  REQUIRE(is_over(shown));
  CHECK(shown["replay"]["length"] == doctest::Approx(599.9));
  CHECK(shown["trial"]["phase"] == "done");
  CHECK(shown["place"]["site"] == "tank");
  CHECK(shown["place"]["thrusters"].size() == 4);
  CHECK_FALSE(shown["place"]["fence"].is_null());
  CHECK(shown["track"].size() > 100);
  CHECK(shown["track"].size() <= 800);
  CHECK(shown["converging"]["t"].size() > 40);
  CHECK(shown["residual"]["wrench"].size() == 6);
  CHECK(shown["effects"]["candidates"][0]["log_odds"] == 5.0);
  const double first = shown["converging"]["parameters"][0]["high"].front(),
               last = shown["converging"]["parameters"][0]["high"].back();
  CHECK(first > last);
  CHECK(shown["events"].dump().find("excite, mode yaw") != std::string::npos);
  CHECK(shown["state"]["age"] < 1.0);
  CHECK(press(board.port) == 403);  // there is nothing to abort
  const auto none = shell(program("board") + " --port 0 --replay '" + scratch.path("none.lcmlog") + "'");
  CHECK(none.code == 1);
  CHECK_MESSAGE(none.lines() == 1, none.text);
}

TEST_CASE("board: a browser draws all of it, wide and on a phone, and its console says nothing") {
  const std::string browser = shell("command -v chromium chromium-browser google-chrome | head -n 1").text;
  if (browser.empty()) {
    MESSAGE("skipped: no Chromium here");
    return;
  }
  const Scratch scratch;
  const Board board = played(scratch);
  Bus bus;
  REQUIRE(is_over(board.until(bus, is_over)));
  for (const char* size : {"1400,1200", "400,900"}) {
    CAPTURE(size);
    const auto look = [&] {
      return shell(test::limit(100) + "'" + browser.substr(0, browser.find('\n')) +
                   "' --headless --no-sandbox --disable-gpu --user-data-dir='" + scratch.path("browser") +
                   "' --enable-logging=stderr --window-size=" + size +
                   " --virtual-time-budget=4000 --dump-dom http://127.0.0.1:" + std::to_string(board.port) + "/ 2>&1");
    };
    auto ran = look();
    for (int i = 0; i < 3 && ran.says("</html>") && !ran.says("class=\"band\""); ++i) ran = look();  // too slow
    if (!ran.says("</html>")) {  // a container may let no browser run
      MESSAGE("skipped: the browser does not run here: " << ran.text.substr(0, 300));
      return;
    }
    CHECK_MESSAGE(!ran.says("CONSOLE"), ran.text);
    for (const char* part : {"class=\"walls\"", "class=\"fence\"", "class=\"tag\"", "class=\"tether\"",
                             "class=\"track\"", "class=\"band\"", "aria-label=\"heading\"", "aria-label=\"depth\"",
                             ">starboard<", ">m_X<", ">current<", "150 : 1", "replay of", ">ABORT</button>"})
      CHECK_MESSAGE(ran.says(part), part);
    CHECK_FALSE(ran.says("last heard"));
  }
}

}  // namespace fathom
