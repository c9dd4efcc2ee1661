// Golden replays: a recorded run through every mind as a process, and a diagnosis of two runs; whatever changes their
// numbers shows here, with what has moved and by how much. They say nothing about what is right.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/wire/log_reader.hpp"
#include "test/golden/table.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::cell;
using test::file;
using test::Of;
using test::program;
using test::Scratch;
using test::shell;
using test::Table;

// Beyond rounding: other processors contract products and sums, and what iterates or decides makes more of it.
constexpr double kFiltered = 1e-6, kRegressed = 1e-5, kSearched = 1e-3;

const std::string kConfig = " --log-level warning --config " + file("config/pipelines/beluga.yaml") + " --config " +
                            file("config/vehicles/beluga.yaml") + " --config " + file("config/corrections/none.yaml");

/// `seconds` of a measured run at 10 Hz.
std::string cut(const Scratch& scratch, const std::string& run, int seconds) {
  std::ifstream from{std::string{FATHOM_SOURCE_DIR} + "/test/data/beluga/" + run + ".csv"};
  const std::string path = scratch.path(run + ".csv");
  std::ofstream to{path};
  std::string line;
  for (int i = 0; i <= 10 * seconds && std::getline(from, line); ++i) to << line << "\n";
  return path;
}

/// The run as a log, and the estimator's answer to it; the others hear both.
struct Replay {
  explicit Replay(int seconds) {
    const std::string csv = cut(scratch, "random-1", seconds);
    run("fathom",
        " import " + csv + " --map " + file("config/maps/beluga.yaml") + " --out " + scratch.path("run.lcmlog"));
    run("estimator",
        kConfig + " --in file://" + scratch.path("run.lcmlog") + " --out file://" + scratch.path("state.lcmlog"));
  }
  Recording states() const { return wire::read_log(scratch.path("state.lcmlog")).recording; }
  Recording heard_by(const std::string& mind) const {
    run(mind, kConfig + " --in file://" + scratch.path("run.lcmlog") + " --in file://" + scratch.path("state.lcmlog") +
                  " --out file://" + scratch.path("said.lcmlog"));
    return wire::read_log(scratch.path("said.lcmlog")).recording;
  }
  static void run(const std::string& name, const std::string& words) {
    const auto ran = shell(program(name) + words);
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
  }
  Scratch scratch;
};

std::string seconds(Utime origin, Utime utime) { return cell(seconds_between(origin, utime)); }

/// What an entry of a list is called: what goes before it must not rename it.
std::string name_of(const nlohmann::json& entry, std::size_t place) {
  if (entry.is_object() && entry.contains("name")) return entry["name"].get<std::string>();
  if (entry.is_object() && entry.contains("horizon_s")) return entry["horizon_s"].dump() + " s";
  return std::to_string(place);
}

/// Numbers and words of a JSON value, each with its path; units, intervals and sentences follow from what is there.
void flatten(const nlohmann::json& value, const std::string& path, Table& table) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) {
      if (key == "name" || key == "unit" || key == "interval_95" || key == "sentence") continue;
      flatten(inner, path + "/" + key, table);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) flatten(value[i], path + "/" + name_of(value[i], i), table);
  } else if (value.is_number()) {
    table.rows.push_back({path, cell(value.get<double>())});
  } else {
    table.rows.push_back({path, value.is_string() ? value.get<std::string>() : value.dump()});
  }
}

}  // namespace

TEST_SUITE_BEGIN("processes golden");

TEST_CASE("golden replay: the estimator's STATE") {
  const Recording said = Replay{60}.states();
  Table table{.columns = {"t", "x", "y", "z", "qw", "qx", "qy", "qz", "u", "v", "w", "p", "q", "r", "sigma_x",
                          "sigma_u", "sigma_r", "valid"},
              .rows = {}};
  REQUIRE(said.state.size() > 500);
  for (std::size_t k = 0; k < said.state.size(); k += 10) {
    const StateEstimate& s = said.state[k];
    table.rows.push_back({seconds(said.state[0].utime, s.utime)});
    auto& row = table.rows.back();
    for (const double p : s.p_WB) row.push_back(cell(p));
    for (const double q : {s.q_WB.w(), s.q_WB.x(), s.q_WB.y(), s.q_WB.z()}) row.push_back(cell(q));
    for (const double nu : s.nu) row.push_back(cell(nu));
    for (const int i : {0, 6, 11}) row.push_back(cell(s.sigma[i]));
    row.emplace_back(s.valid ? "yes" : "no");
  }
  test::check_golden("estimator_state", table, kFiltered, Of::kColumn);
}

TEST_CASE("golden replay: the identifier's MODEL") {
  const Recording said = Replay{120}.heard_by("identifier");
  REQUIRE(said.model.size() > 100);
  Table table{.columns = {"t", "updates"}, .rows = {}};
  for (const NamedValue& p : said.model[0].parameters) {
    table.columns.push_back(p.name);
    table.columns.push_back("std of " + p.name);
  }
  for (std::size_t k = 0; k < said.model.size(); k += said.model.size() / 12) {
    const ModelEstimate& m = said.model[k];
    table.rows.push_back({seconds(said.model[0].utime, m.utime), std::to_string(m.updates)});
    for (const NamedValue& p : m.parameters) {
      table.rows.back().push_back(cell(p.value));
      table.rows.back().push_back(cell(p.std));
    }
  }
  test::check_golden("identifier_model", table, kRegressed, Of::kColumn);
}

TEST_CASE("golden replay: the diagnoser's EFFECTS") {
  const Recording said = Replay{180}.heard_by("diagnoser");
  REQUIRE(said.effects.size() > 3);
  Table table{.columns = {"t and rank", "verdict", "candidate", "log_odds", "error_reduction"}, .rows = {}};
  constexpr std::size_t kFirst = 5;
  for (std::size_t k = 0; k < said.effects.size(); k += std::max<std::size_t>(said.effects.size() / 8, 1)) {
    const EffectRanking& e = said.effects[k];
    const std::string t = seconds(said.effects[0].utime, e.utime);
    for (std::size_t i = 0; i < std::min(std::max<std::size_t>(e.candidates.size(), 1), kFirst); ++i) {
      const EffectEvidence none, &c = i < e.candidates.size() ? e.candidates[i] : none;
      table.rows.push_back({t + " s " + std::to_string(i + 1), e.verdict, c.name + " " + c.variant, cell(c.log_odds),
                            cell(c.error_reduction)});
    }
  }
  test::check_golden("diagnoser_effects", table, kSearched, Of::kColumn);
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("search golden");

TEST_CASE("golden replay: the diagnosis of a short Beluga pair") {
  const Scratch scratch;
  const std::string fitted = cut(scratch, "random-1", 150), judge = cut(scratch, "random-2", 60);
  // Without what is learned of so short a run, which has rivals within a tenth of a nat: rounding would choose.
  Replay::run("fathom", " diagnose --vehicle " + file("config/vehicles/beluga.yaml") + " --map " +
                            file("config/maps/beluga.yaml") + " --train " + fitted + " --validate " + judge +
                            " --no-learning --threads 2 --out " + scratch.path("out"));
  std::ifstream text{scratch.path("out/result.json")};
  const auto result = nlohmann::json::parse(text);
  Table table{.columns = {"quantity", "value"}, .rows = {}};
  for (const char* part : {"verdict", "effects", "parameters", "error"}) flatten(result.at(part), part, table);
  test::check_golden("diagnosis_beluga", table, kSearched, Of::kNumber);
}

TEST_SUITE_END();

}  // namespace fathom
