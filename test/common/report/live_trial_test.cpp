// What a live trial's log becomes: modes from EXCITATION, the last model, a table, JSON, and a page whose comparison
// with the truth stands apart and is there only when the truth is.
#include "common/report/live/live_trial.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/health_words.hpp"
#include "common/estimation/online/navigator.hpp"
#include "test/support/schema.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::report;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr double kStep = 0.1;  // s

model::Vehicle vehicle() {
  return model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/seabotix_lbv150.yaml");
}
model::Site site() { return model::Site::load(std::string{FATHOM_SOURCE_DIR} + "/config/sites/tank.yaml"); }

// Yaw is left after 20 s, surge is given up after 40, total after 60; the state is 1 cm beside the truth.
Recording trial() {
  Recording recording;
  recording.name = "run";
  for (int k = 0; k <= 600; ++k) {
    const double t = kStep * k;
    const Utime utime = utime_after(kStart, t);
    StateEstimate state{.utime = utime, .p_WB = {0.01 + 0.5 * std::sin(0.2 * t), 0.0, 0.7}, .valid = true};
    state.sigma.setConstant(0.01);
    recording.state.push_back(state);
    recording.truth.push_back({.utime = utime, .p_WB = {0.5 * std::sin(0.2 * t), 0.0, 0.7}});
    recording.depth.push_back({.utime = utime, .z = 0.71});
    Excitation e{.utime = utime, .active = true, .phase = "excite", .metric = 1.0 / (1.0 + t), .threshold = 0.25};
    e.mode = t < 20.0 ? "yaw" : t < 40.0 ? "surge" : "total";
    if (t >= 20.0 && t < 40.0) {
      e.frozen = {"I_Z"};
      e.missing = "residual on X has 5 times the noise's power";
    }
    if (k == 600) {
      e = Excitation{.utime = utime, .phase = "done"};
      e.reason = "done, but not settled: surge: residual on X has 5 times the noise's power";
    }
    recording.excitation.push_back(e);
    ModelEstimate model{.utime = utime};
    model.parameters = {
        {"m_X", 9.0 + 0.01 * t, 0.5, "kg"}, {"I_Z", 0.16, 0.01, "kg m^2"}, {"X_u", -8.0, 0.1, "N/(m/s)"}};
    model.covariance = {0.25, 0.0, 0.03, 0.0, 1e-4, 0.0, 0.03, 0.0, 0.01};  // m_X and X_u correlated by 0.6
    model.modes = {{"surge", 1.0 / (1.0 + t), 0.1}, {"total", 2.0 / (1.0 + t), 0.1}, {"yaw", 0.1 / (1.0 + t), 0.1}};
    recording.model.push_back(model);
  }
  recording.effects.push_back({.utime = kStart,
                               .verdict = "effect",
                               .candidates = {{.name = "tether_tension", .log_odds = 12.0, .error_reduction = 0.4}}});
  return recording;
}

std::string truth_file(const test::Scratch& scratch, const std::string& text) {
  std::string path = scratch.path("truth.json");
  std::ofstream{path} << text;
  return path;
}

constexpr const char* kTruth =
    R"json({"parameters": {"m_X": {"value": 9.7532, "unit": "kg"}, "I_Z": {"value": 0.1589, "unit": "kg m^2"},
        "X_u": {"value": -8.604, "unit": "N/(m/s)"}},
        "effects": [{"name": "tether_tension", "variant": "", "parameters": {"stiffness": {"value": 2.0, "unit": "N/m"}}}],
        "contacts": {"walls": 1, "floor": 0, "surface": 0}})json";

}  // namespace

TEST_CASE("live trial: modes are told apart, and the supervisor's last words say which were settled") {
  const LiveTrialResult result = summarise(trial(), vehicle(), site());
  REQUIRE(result.visits.size() == 3);
  CHECK(result.visits[0].mode == "yaw");
  CHECK(result.visits[0].ended == doctest::Approx(20.0));
  CHECK(result.visits[0].left);
  // The metric that it was left by is MODEL's, at that moment: EXCITATION never tells it.
  CHECK(result.visits[0].metric == doctest::Approx(0.1 / 21.0));
  CHECK_FALSE(result.visits[1].left);
  CHECK(result.visits[1].metric == doctest::Approx(1.0 / 40.9));  // what EXCITATION told last
  CHECK(result.visits[1].missing.find("residual on X") == 0);
  CHECK(result.visits[2].left);
  CHECK_FALSE(result.settled());
  CHECK(result.phase == "done");
  CHECK(result.ranking.verdict == "effect");
  CHECK_FALSE(result.truth.has_value());
}

TEST_CASE("live trial: a segment that was flown is no mode, and hides none that is not settled") {
  for (const bool amid : {true, false}) {
    CAPTURE(amid);
    Recording flown = trial();
    const int from = amid ? 250 : 590;  // within surge, or at the end, as total closes
    for (int k = from; k < from + 8; ++k) {
      Excitation& e = flown.excitation[static_cast<std::size_t>(k)];
      e = {.utime = e.utime, .active = true, .signal = "full steps in surge", .mode = kSegmentMode, .phase = "excite"};
    }
    flown.excitation[599].phase = "done";
    flown.excitation[599].mode = "yaw";
    const LiveTrialResult result = summarise(flown, vehicle(), site());
    REQUIRE(result.flights.size() == 1);
    CHECK(result.flights[0].segment == "full steps in surge");
    CHECK(result.flights[0].begun == doctest::Approx(kStep * from));
    CHECK(result.flights[0].ended == doctest::Approx(kStep * (from + 7)));
    REQUIRE(result.visits.size() == 3);
    CHECK(result.visits[0].left);
    CHECK_FALSE(result.visits[1].left);
    CHECK(result.visits[2].mode == "total");
    CHECK(to_table(result).find("full steps in surge") != std::string::npos);
    CHECK(nlohmann::json::parse(to_json(result)).at("flights").size() == 1);
    const test::Scratch scratch;
    test::write_bytes(scratch.path("result.json"), to_json(result));
    CHECK(test::against_schema(scratch, scratch.path("result.json"), "live_trial-1") == "");
    CHECK(to_html(result, flown, vehicle(), site()).find("flown: full steps in surge") != std::string::npos);
  }
}

TEST_CASE("live trial: a run that was cut keeps as settled what had been left before") {
  Recording cut = trial();
  cut.excitation.resize(300);
  const LiveTrialResult result = summarise(cut, vehicle(), site());
  REQUIRE(result.visits.size() == 2);
  CHECK(result.visits[0].left);
  CHECK_FALSE(result.visits[1].left);
  CHECK(result.phase == "excite");
  // Cut before the identifier said anything of surge: a page without that figure, not an error.
  for (ModelEstimate& model : cut.model)
    std::erase_if(model.modes, [](const ModeMetric& m) { return m.mode == "surge"; });
  const std::string page = to_html(result, cut, vehicle(), site());
  CHECK(page.find("Trace of the covariance of yaw") != std::string::npos);
  CHECK(page.find("Trace of the covariance of surge") == std::string::npos);
}

TEST_CASE("live trial: what was wrong is told, in lockstep too; what was not there yet at the start is not") {
  Recording recording = trial();
  const auto say = [&](const char* process, const char* state, const std::string& detail) {
    recording.health.push_back({.process = process, .state = state, .detail = detail});
  };
  say("estimator", "unhealthy", "no AHRS sample yet; ");
  say("identifier", "unhealthy", "no STATE; ");
  say("vision", "running", "");
  say("estimator", "running", "");
  say("vision", "unhealthy", "no pictures; ");
  say("vision", "running", "");
  say("diagnoser", "running", "");
  say("diagnoser", "running", std::string{kWithoutConsequence} + "MODEL is silent; ");
  say("estimator", "stopped", "AHRS too late 3");
  const auto complaints = summarise(recording, vehicle(), site()).complaints;
  CHECK(complaints.size() == 3);
  CHECK(complaints.at("identifier") == "unhealthy: no STATE; ");  // never well
  CHECK(complaints.at("vision") == "unhealthy: no pictures; ");
  CHECK(complaints.at("diagnoser") == "MODEL is silent; ");
}

TEST_CASE("live trial: what the diagnoser has learned at the end is told on page, table and in data") {
  Recording recording = trial();
  CHECK_FALSE(nlohmann::json::parse(to_json(summarise(recording, vehicle(), site())))["diagnosis"].contains("learned"));
  recording.learned.push_back({.adopted = true, .held_out = 0.4, .words = "A force.", .equation = "tau_Y = c u v"});
  const LiveTrialResult result = summarise(recording, vehicle(), site());
  const auto learned = nlohmann::json::parse(to_json(result))["diagnosis"]["learned"];
  CHECK(learned["adopted"] == true);
  CHECK(learned["equation"] == "tau_Y = c u v");
  CHECK(to_table(result).find("  learned: A force.\n") != std::string::npos);
  const std::string page = to_html(result, recording, vehicle(), site());
  CHECK(page.find("<b>Learned.</b> A force. <code>tau_Y = c u v</code>") != std::string::npos);
}

TEST_CASE("live trial: a diagnosis of the log is told, with its page; a file that is none is refused") {
  const test::Scratch scratch;
  const Recording recording = trial();
  LiveTrialResult result = summarise(recording, vehicle(), site());
  CHECK_FALSE(nlohmann::json::parse(to_json(result)).contains("closed_loop"));
  std::ofstream{scratch.path("result.json")} << R"json({"verdict": "effect",
      "effects": [{"name": "thruster_lag", "log_odds": 9.5}, {"name": "current", "log_odds": null}],
      "error": {"before": {"prediction": [{"horizon_s": 1, "rmse": {"u": 0.5}}, {"horizon_s": 5, "rmse": {"u": 0.04, "p": null}}]},
                "after": {"prediction": [{"horizon_s": 5, "rmse": {"u": 0.01, "p": null}}]},
                "improvement": {"value": 0.75, "ci95": [0.7, 0.8]}}})json";
  result.afterwards = read_afterwards(scratch.path(""), "diagnosis/report.html");
  CHECK(result.afterwards->before == std::map<std::string, double>{{"u", 0.04}});
  CHECK(result.afterwards->after.at("u") == 0.01);
  const auto json = nlohmann::json::parse(to_json(result));
  CHECK(json["closed_loop"]["verdict"] == "effect");
  CHECK(json["closed_loop"]["effects"][0]["name"] == "thruster_lag");
  CHECK(json["closed_loop"]["improvement"] == 0.75);
  CHECK(to_table(result).find("effect (thruster_lag, current); diagnosis/report.html") != std::string::npos);
  const std::string page = to_html(result, recording, vehicle(), site());
  for (const char* words : {"The loop closed on the log", "href=\"diagnosis/report.html\"", "0.0400 m/s", "0.0100 m/s"})
    CHECK_MESSAGE(page.find(words) != std::string::npos, words);
  std::ofstream{scratch.path("result.json")} << "{}";
  CHECK_THROWS_AS((void)read_afterwards(scratch.path(""), ""), InputError);
  CHECK_THROWS_AS((void)read_afterwards(scratch.path("none"), ""), InputError);
}

TEST_CASE("live trial: page, table and JSON say whose numbers the parameters are") {
  Recording recording = trial();
  const auto told = [&] {
    const LiveTrialResult result = summarise(recording, vehicle(), site());
    const std::string words = estimate_words(result);
    CHECK(to_table(result).find(words) != std::string::npos);
    CHECK(to_html(result, recording, vehicle(), site()).find(words) != std::string::npos);
    return words + "|" + nlohmann::json::parse(to_json(result)).at("estimate").get<std::string>();
  };
  CHECK(told() == "recursive estimate, from STATE|recursive");
  for (std::size_t k = 230; k < recording.model.size(); ++k) recording.model[k].joint = true;
  CHECK(told() == "joint estimate, of state and parameters in one filter; until 23.0 s the recursive one|joint");
  for (std::size_t k = 400; k < recording.model.size(); ++k) recording.model[k].joint = false;
  CHECK(told().starts_with("recursive estimate, from STATE, with what was adopted; from 23.0 s until then the joint"));
}

TEST_CASE("live trial: page, table and JSON say when the model lacks something") {
  Recording recording = trial();
  const auto told = [&](const std::string& words) {
    const LiveTrialResult result = summarise(recording, vehicle(), site());
    CHECK((to_table(result).find(words) != std::string::npos) ==
          (to_html(result, recording, vehicle(), site()).find(words) != std::string::npos));
    CHECK(nlohmann::json::parse(to_json(result)).at("residual_fails_on") == nlohmann::json(result.failing));
    return to_table(result).find(words) != std::string::npos;
  };
  CHECK_FALSE(told("lacks something"));
  recording.model.back().residual_excess[0] = 12.0;
  recording.model.back().residual_excess[5] = 3.0;
  CHECK(told("This model lacks something: its residual failed the test on X, N."));
  const std::string page = to_html(summarise(recording, vehicle(), site()), recording, vehicle(), site());
  CHECK(page.find("; the model lacks something on X, N</div>") != std::string::npos);
  CHECK(page.find("badge adequate") == std::string::npos);
}

TEST_CASE("live trial: a log without STATE is refused; without supervisor or identifier it is drawn, and says so") {
  Recording recording = trial();
  recording.state.clear();
  const std::string complaint = test::complaint_of<InputError>([&] { (void)summarise(recording, vehicle(), site()); });
  CHECK_MESSAGE(complaint.find("no STATE") != std::string::npos, complaint);
  for (const int lacking : {1, 2, 3}) {
    recording = trial();
    if ((lacking & 1) != 0) recording.excitation.clear();
    if ((lacking & 2) != 0) recording.model.clear();
    const LiveTrialResult result = summarise(recording, vehicle(), site());
    CHECK((result.reason.find("no EXCITATION") != std::string::npos) == ((lacking & 1) != 0));
    CHECK((result.reason.find("no MODEL") != std::string::npos) == ((lacking & 2) != 0));
    CHECK(result.visits.empty() == ((lacking & 1) != 0));
    CHECK(result.parameters.empty() == ((lacking & 2) != 0));
    for (const std::string& text : {to_table(result), to_html(result, recording, vehicle(), site())})
      CHECK((text.find("no EXCITATION") != std::string::npos) == ((lacking & 1) != 0));
    const std::string page = to_html(result, recording, vehicle(), site());
    const bool recorded = page.find("A recorded run") != std::string::npos;
    // What the log does not hold has no table and no number of its own.
    CHECK((page.find("What was flown") == std::string::npos) == ((lacking & 1) != 0));
    CHECK((page.find("modes settled") == std::string::npos) == ((lacking & 1) != 0));
    CHECK((page.find("The vehicle's numbers") == std::string::npos) == ((lacking & 2) != 0));
    CHECK((to_table(result).find("Identified") == std::string::npos) == ((lacking & 2) != 0));
    CHECK(recorded == ((lacking & 1) != 0));
  }
}

TEST_CASE("live trial: errors against the truth are those that were put in, and contacts and effects are told") {
  const test::Scratch scratch;
  const TruthComparison truth = compare_truth(truth_file(scratch, kTruth), trial());
  CHECK(truth.parameters.at("m_X") == 9.7532);
  CHECK(truth.state_rms[0] == doctest::Approx(0.01));
  CHECK(truth.state_rms[1] == doctest::Approx(0.0));
  CHECK(truth.state_normalised[0] == doctest::Approx(1.0));
  CHECK(truth.contacts[0] == 1);
  CHECK(truth.effect_names == std::vector<std::string>{"tether_tension"});
  CHECK(truth.effects.front().find("stiffness 2") != std::string::npos);
  for (const char* bad : {"", "{}", "[1, 2]", R"({"parameters": 3, "effects": [], "contacts": {}})"}) {
    CHECK_THROWS_AS((void)compare_truth(truth_file(scratch, bad), trial()), InputError);
  }
  CHECK_THROWS_AS((void)compare_truth(scratch.path("none.json"), trial()), InputError);
}

TEST_CASE("live trial: JSON, table and page agree, and speak of truth only when there is one") {
  const test::Scratch scratch;
  const Recording recording = trial();
  LiveTrialResult result = summarise(recording, vehicle(), site());
  const auto blind = nlohmann::json::parse(to_json(result));
  CHECK_FALSE(blind.contains("compared_with_truth"));
  CHECK(to_table(result).find("truth") == std::string::npos);
  CHECK(to_html(result, recording, vehicle(), site()).find("truth") == std::string::npos);
  result.truth = compare_truth(truth_file(scratch, kTruth), recording);
  const auto json = nlohmann::json::parse(to_json(result));
  CHECK(json["parameters"]["m_X"]["value"].get<double>() == doctest::Approx(9.6));
  CHECK(json["parameters"]["m_X"]["variance_inflation"].get<double>() == doctest::Approx(1.0 / (1.0 - 0.36)));
  CHECK(json["parameters"]["I_Z"]["variance_inflation"].get<double>() == doctest::Approx(1.0));
  CHECK(json["condition_of_correlations"].get<double>() == doctest::Approx(4.0));
  CHECK(json["compared_with_truth"]["parameters"]["X_u"]["inside_interval"] == false);
  CHECK(json["compared_with_truth"]["parameters"]["m_X"]["inside_interval"] == true);
  CHECK(to_table(result).find("MISSES THE TRUTH") != std::string::npos);
  const std::string page = to_html(result, recording, vehicle(), site());
  for (const char* words : {"Table 1.1", "Entangled", "Figure 1.11", "Figure 1.14", "Figure 1.15", "Figure 1.17",
                            "Figure 1.19", "Compared with the simulator's truth"}) {
    CHECK_MESSAGE(page.find(words) != std::string::npos, words);
  }
  CHECK(page.find("Compared with the simulator's truth") > page.find("Figure 1.19"));
}

TEST_CASE("Live trial: the first screen says what is not settled, what is suspected, and what to do next") {
  const Recording recording = trial();
  LiveTrialResult result = summarise(recording, vehicle(), site());
  std::string page = to_html(result, recording, vehicle(), site());
  const auto first = [&] { return page.substr(0, page.find("</header>")); };
  for (const char* words : {"Not settled: surge", "residual on X has 5 times", "<b>tether tension</b>",
                            "not in the identifier&#39;s model", "Next.", "Fly on until", "The path from above"})
    CHECK_MESSAGE(first().find(words) != std::string::npos, words);
  result.visits.push_back({.mode = "surge", .begun = 60.0, .ended = 70.0, .left = true});
  page = to_html(result, recording, vehicle(), site());
  CHECK(first().find("Not settled: surge") == std::string::npos);  // it was settled later
  result.visits.push_back({.mode = "surge", .begun = 70.0, .ended = 70.1});
  page = to_html(result, recording, vehicle(), site());
  CHECK(first().find("Not settled") == std::string::npos);  // and had only begun again
  result.ranking.against = "current";
  result.ranking.segment = "full steps in surge";
  page = to_html(result, recording, vehicle(), site());
  CHECK(first().find("Fly &#39;full steps in surge&#39;: it tells tether tension from current.") != std::string::npos);
}

TEST_CASE("Live trial: designed segments, of all axes at once, have no figures of modes of their own") {
  Recording recording = trial();
  for (Excitation& e : recording.excitation) {
    if (e.phase == "excite") e.mode = "total";
  }
  const std::string page = to_html(summarise(recording, vehicle(), site()), recording, vehicle(), site());
  CHECK(page.find("Figure 1.15") == std::string::npos);
  CHECK(page.find("Figure 1.16") == std::string::npos);
  CHECK(page.find("Figure 1.17") != std::string::npos);
}

TEST_CASE("Live trial: filters are drawn for who gives the estimator's settings, and for aids that were heard") {
  Recording recording = trial();
  for (int k = 0; k < 400; ++k) {
    recording.dvl.push_back({.utime = utime_after(kStart, 0.125 * k), .v_WB_B = {0.1, 0.0, 0.0}, .valid = true});
  }
  const LiveTrialResult result = summarise(recording, vehicle(), site());
  estimation::NavigatorSettings settings;
  settings.dvl = {.used = true, .cutoff = 2.0, .damping = 1.0};
  settings.tags = {.used = true, .cutoff = 4.0};
  const std::string page = to_html(result, recording, vehicle(), site(), {}, &settings);
  CHECK(page.find("velocity log every 125 ms") != std::string::npos);
  CHECK(page.find("Figure 1.5") != std::string::npos);
  CHECK(page.find("Figure 1.4") == std::string::npos);
  CHECK(to_html(result, recording, vehicle(), site()).find("Figure 1.5") == std::string::npos);
}
