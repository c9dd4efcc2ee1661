#include "common/board/board.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "common/board/page.hpp"

namespace fathom::board {
namespace {

using Json = nlohmann::json;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNot = std::numeric_limits<double>::quiet_NaN();

Board board() { return Board{{.host = "topside", .pid = 7, .bus = "a bus"}}; }

Json told(const Board& board, double now) { return Json::parse(board.json(now, 1)); }

}  // namespace

TEST_CASE("board: what was never heard is null, and its own word is no sign of life of the bus") {
  Board some = board();
  CHECK(told(some, 1.0)["heard"].is_null());
  CHECK(told(some, 1.0)["trial"].is_null());
  some.hear(Health{.process = "board", .host = "topside", .pid = 7, .state = "running"}, 1.0);
  CHECK(told(some, 1.0)["heard"].is_null());
  CHECK(told(some, 1.0)["processes"].size() == 1);
  some.hear(Health{.process = "estimator", .host = "topside", .pid = 8, .state = "running"}, 2.0);
  CHECK(told(some, 6.0)["heard"] == doctest::Approx(4.0));
}

TEST_CASE("board: HEALTH with its channels, counts and what it complains of") {
  Board some = board();
  some.hear(Health{.process = "estimator",
                   .host = "vehicle",
                   .pid = 3,
                   .state = "unhealthy",
                   .dropped = 2,
                   .rejected = 5,
                   .cpu = 0.25,
                   .memory = 9'000'000,
                   .detail = "no depth for 3 s; ",
                   .channels = {{"AHRS", 100.0, 0.01}, {"DEPTH", 0.0, 3.0}}},
            1.0);
  const Json one = told(some, 1.5)["processes"][0];
  CHECK(one["name"] == "estimator");
  CHECK(one["host"] == "vehicle");
  CHECK(one["state"] == "unhealthy");
  CHECK(one["detail"] == "no depth for 3 s; ");
  CHECK(one["healthy"] == false);
  CHECK(one["age"] == doctest::Approx(0.5));
  CHECK(one["cpu"] == doctest::Approx(0.25));
  CHECK(one["memory"] == 9'000'000);
  CHECK(one["dropped"] == 2);
  CHECK(one["rejected"] == 5);
  CHECK(one["channels"][1] == Json{{"channel", "DEPTH"}, {"rate", 0.0}, {"age", 3.0}});
}

TEST_CASE("board: a trial is armed as long as the supervisor names a mode; an unknown metric is null") {
  Board some = board();
  some.hear(Excitation{.reason = "waits for the operator to arm", .phase = "disarmed"}, 0.0);
  CHECK(told(some, 0.0)["trial"]["armed"] == false);
  CHECK(told(some, 0.0)["trial"]["metric"].is_null());
  some.hear(
      Excitation{.elapsed = 4.0, .mode = "yaw", .phase = "excite", .metric = 0.3, .threshold = 0.2, .missing = "more"},
      1.0);
  const Json trial = told(some, 3.0)["trial"];
  CHECK(trial["armed"] == true);
  CHECK(trial["metric"] == doctest::Approx(0.3));
  CHECK(trial["missing"] == "more");
  CHECK(trial["age"] == doctest::Approx(2.0));
}

TEST_CASE("board: the track is the trial's, kept when it is done, and begun anew with the next one") {
  Board some = board();
  const auto fly = [&](const std::string& mode, const std::string& phase, double from, double to) {
    for (double t = from; t < to; t += 1.0) {
      some.hear(Excitation{.mode = mode, .phase = phase}, t);
      StateEstimate state{.valid = true};
      state.p_WB = {t, 0.0, 0.0};
      some.hear(state, t);
    }
    return told(some, to)["track"].size();
  };
  fly("", "disarmed", 0.0, 20.0);
  CHECK(fly("yaw", "excite", 20.0, 60.0) == 40);
  CHECK(fly("total", "done", 60.0, 62.0) == 42);  // still armed
  CHECK(fly("", "done", 62.0, 70.0) == 50);
  CHECK(fly("surge", "approach", 70.0, 75.0) == 5);
}

TEST_CASE("board: state, model, thrusters and effects as they were said") {
  Board some = board();
  StateEstimate state{.valid = true};
  state.p_WB = {1.0, 2.0, 3.0};
  state.q_WB = Eigen::AngleAxisd{0.5, Eigen::Vector3d::UnitZ()};
  state.nu[0] = 0.7;
  state.age[5] = 0.2;
  some.hear(state, 0.0);
  some.hear(Thrusters{.force = {1.0, -2.0}, .tau = {3.0}, .has_tau = true}, 0.0);
  some.hear(WrenchCommand{.commander = "supervisor 3"}, 0.0);
  some.hear(Battery{.voltage = 15.5}, 0.0);
  some.hear(ModelEstimate{.parameters = {{.name = "m_X", .value = 10.0, .std = 1.0, .unit = "kg"},
                                         {.name = "X_u", .value = -8.0, .std = 2.0, .unit = "N/(m/s)"}},
                          .effects = {"tether_tension"},
                          .covariance = {1.0, 1.2, 1.2, 4.0},
                          .residual_excess = (Vector6d{} << 0.0, 31.0, 0.0, 0.0, 0.0, 2.0).finished(),
                          .frozen = {"m_X"},
                          .joint = true},
            0.0);
  some.hear(EffectRanking{.verdict = "ambiguous",
                          .candidates = {{.name = "current", .log_odds = 3.5, .error_reduction = 0.4}},
                          .against = "tether_tension",
                          .segment = "full steps in surge",
                          .duration = 20.0},
            0.0);
  some.hear(LearnedTold{.adopted = true, .held_out = 0.4, .words = "A force.", .equation = "tau_Y = c u v"}, 0.0);
  const Json all = told(some, 0.1);
  CHECK(all["learned"]["adopted"] == true);
  CHECK(all["learned"]["words"] == "A force.");
  CHECK(all["learned"]["equation"] == "tau_Y = c u v");
  CHECK(all["state"]["values"][2] == doctest::Approx(3.0));
  CHECK(all["state"]["values"][5] == doctest::Approx(0.5));
  CHECK(all["state"]["values"][6] == doctest::Approx(0.7));
  CHECK(all["state"]["sources"].size() == 1);
  CHECK(all["state"]["sources"][0]["channel"] == "DVL");
  CHECK(all["thrusters"]["force"] == Json{1.0, -2.0});
  CHECK(all["thrusters"]["tau"][0] == 3.0);
  CHECK(all["battery"]["voltage"] == 15.5);
  CHECK(all["model"]["parameters"][0]["low"] == doctest::Approx(10.0 - kNormal95));
  CHECK(all["model"]["parameters"][0]["frozen"] == true);
  CHECK(all["model"]["parameters"][1]["entangled"] == doctest::Approx(1.0 / (1.0 - 0.36)));  // correlated by 0.6
  CHECK(all["model"]["condition"] == doctest::Approx(4.0));
  CHECK(all["model"]["joint"] == true);
  CHECK(all["model"]["residual_fails_on"] == nlohmann::json{"Y", "N"});
  CHECK(all["model"]["effects"][0] == "tether_tension");
  CHECK(all["effects"]["against"] == "tether_tension");
  CHECK(all["effects"]["candidates"][0]["log_odds"] == doctest::Approx(3.5));
}

TEST_CASE("board: two minutes of motion at half a second, whatever the rate of STATE") {
  Board some = board();
  for (int i = 0; i < 30'000; ++i) some.hear(StateEstimate{}, 0.01 * i);  // five minutes
  const Json history = told(some, 300.0)["history"];
  CHECK(history["t"].size() > 230);
  CHECK(history["t"].size() <= 241);
  CHECK(history["values"].size() == 12);
  CHECK(history["values"][11].size() == history["t"].size());
  CHECK(told(some, 1000.0)["history"]["t"].empty());
}

TEST_CASE("board: numbers that are not finite are null, and broken text is mended: always one JSON object") {
  Board some = board();
  StateEstimate state;
  state.p_WB = {kNot, kInfinite, -kInfinite};
  state.nu[3] = std::numeric_limits<double>::max();
  state.sigma[0] = kNot;
  some.hear(state, 0.0);
  some.hear(Thrusters{.force = {kNot}, .tau = {kInfinite}, .has_tau = true}, 0.0);
  some.hear(Battery{.voltage = kNot}, 0.0);
  some.hear(ModelEstimate{.parameters = {{.name = "m_X", .value = kNot, .std = kInfinite}}, .covariance = {kNot}}, 0.0);
  some.hear(EffectRanking{.candidates = {{.name = "x", .log_odds = kInfinite}}, .duration = kNot}, 0.0);
  some.hear(
      Health{.process = "\xff\xfe <script>\"\\\n", .state = "running", .cpu = kNot, .channels = {{"A", kNot, 0.0}}},
      0.0);
  some.hear(Excitation{.reason = std::string(1'000'000, '\x80'), .metric = kNot}, 0.0);
  const std::string text = some.json(0.0, 1);
  CHECK(text.size() < 10'000);
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("inf") == std::string::npos);
  const Json all = Json::parse(text);
  CHECK(all["state"]["values"][0].is_null());
  CHECK(all["history"]["values"][1][0].is_null());
  CHECK(all["model"]["parameters"][0]["high"].is_null());
  CHECK(all["model"]["parameters"][0]["entangled"].is_null());
  CHECK(all["processes"][0]["cpu"].is_null());
}

TEST_CASE("board: whatever length a message states, the answer stays small") {
  Board some = board();
  const std::string word(10'000, 'x');
  ModelEstimate model{.effects = std::vector<std::string>(5000, word)};
  model.parameters.assign(5000, {.name = word, .unit = word});
  model.covariance.assign(5000 * 5000, 1.0);
  some.hear(model, 0.0);
  some.hear(Thrusters{.force = std::vector<double>(100'000, 1.0)}, 0.0);
  for (int i = 0; i < 100; ++i) {
    Health health{.process = word.substr(0, 1000) + std::to_string(i), .pid = i, .state = word, .detail = word};
    health.channels.assign(1000, {word, 1.0, 1.0});
    some.hear(health, 0.0);
  }
  CHECK(some.json(0.0, 1).size() < 3'000'000);
}

TEST_CASE("board: the page loads nothing from elsewhere, and puts no text into it as markup") {
  for (const std::string_view text : {kPage, kStyle, kScript}) {
    CHECK(text.size() > 500);
    CHECK(text.find("https://") == std::string_view::npos);
    CHECK(text.find("innerHTML") == std::string_view::npos);
    CHECK(text.find("insertAdjacentHTML") == std::string_view::npos);
  }
}

}  // namespace fathom::board
