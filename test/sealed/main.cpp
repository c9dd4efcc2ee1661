// The sealed benchmark: draws sets, lets fathom diagnose see the data only, then opens the truth and keeps the score.
// Stops and goes on where it was: a set is drawn once, and diagnosed again only when the tool is newer than its answer.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/progress_line.hpp"
#include "test/sealed/dives/writing.hpp"
#include "test/sealed/judging/learning.hpp"
#include "test/sealed/judging/page.hpp"
#include "test/sealed/judging/tool.hpp"

namespace fathom::sealed {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Options {
  std::string seeds{"0..122"}, only, size, craft_class{"rov"}, out, tool, page, ablated;
  int jobs{1};
  bool draw_only{}, score_only{}, learning{};
  std::uint64_t first{}, last{};
};

Json read_json(const std::string& path) {
  std::ifstream file(path);
  return file ? Json::parse(file, nullptr, false) : Json();
}

bool valid(const Json& json) { return json.is_object() && !json.empty(); }

void parse_seeds(Options& options) {
  const auto dots = options.seeds.find("..");
  try {
    options.first = std::stoull(options.seeds);
    options.last = dots == std::string::npos ? options.first : std::stoull(options.seeds.substr(dots + 2));
  } catch (const std::exception&) {
    throw std::runtime_error("--seeds: '" + options.seeds + "' is neither A..B nor a number");
  }
}

Wish wish_of(const Options& options) {
  Wish wish{.effect = options.only, .new_recording = options.learning};
  for (std::size_t i = 0; i < kClassNames.size(); ++i) {
    if (options.craft_class == kClassNames[i]) wish.craft_class = static_cast<CraftClass>(i);
  }
  for (std::size_t i = 0; i < kSizeNames.size(); ++i) {
    if (options.size == kSizeNames[i]) wish.size = static_cast<Size>(i);
  }
  return wish;
}

/// The ways in which every set is asked; without learning the one that has no name.
std::vector<std::string> ways_of(const Options& options) {
  return options.learning ? std::vector<std::string>{kTold, kLeftOut} : std::vector<std::string>{""};
}

void draw(std::uint64_t seed, const Options& options, const Places& where) {
  const Json truth = read_json(where.truth);
  if (valid(truth) && truth.value("generator", 0) == kGenerator) return;
  for (const std::string& way : ways_of(options)) fs::remove_all(places(options.out, seed, way).found);
  fs::remove_all(where.data);
  write_set(make_set(make_plan(seed, wish_of(options))), where);
}

/// The tool's command line. Only the data's folder is named in it.
std::vector<std::string> command(const Options& options, const std::string& way, const Places& where) {
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::string> words{options.tool, "diagnose", "--vehicle", where.data + "/vehicle.yaml", "--train"};
  for (int i = 1; fs::exists(where.data + "/train-" + std::to_string(i) + ".csv"); ++i) {
    words.push_back(where.data + "/train-" + std::to_string(i) + ".csv");
  }
  if (fs::exists(where.data + "/validate.csv")) words.insert(words.end(), {"--validate", where.data + "/validate.csv"});
  if (fs::exists(where.data + "/map.yaml")) words.insert(words.end(), {"--map", where.data + "/map.yaml"});
  words.insert(words.end(), {"--out", where.found, "--threads",
                             std::to_string(std::max(1U, cores / static_cast<unsigned>(options.jobs)))});
  if (!options.ablated.empty()) words.insert(words.end(), {"--ablate", options.ablated});
  if (way == kLeftOut) {
    const Json truth = read_json(where.truth);
    for (const Json& effect : truth.at("effects"))
      words.insert(words.end(), {"--without", effect.at("name").get<std::string>()});
  }
  return words;
}

/// The set has an answer that is newer than the tool.
bool answered(const Options& options, const Places& where) {
  const std::string note = where.found + "/run.json";
  return fs::exists(note) && fs::last_write_time(note) > fs::last_write_time(options.tool);
}

void diagnose(const Options& options, const std::string& way, const Places& where) {
  if (answered(options, where)) return;
  const std::string note = where.found + "/run.json";
  fs::create_directories(where.found);
  fs::remove(where.found + "/result.json");
  const Measured measured = run_tool(command(options, way, where), where.found + "/log.txt");
  std::ofstream(note) << Json{{"code", measured.code},
                              {"seconds", measured.seconds},
                              {"processor", measured.processor},
                              {"megabytes", measured.megabytes}};
}

Score score_of(const Places& where) {
  Json result = read_json(where.found + "/result.json");
  if (!valid(result)) result = Json::object();
  return judge(read_json(where.truth), result, read_json(where.found + "/run.json"));
}

std::string line(const Score& s) {
  const auto joined = [](const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : "+") + name;
    return all.empty() ? std::string("-") : all;
  };
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%5llu  %-8s %-6s %-42s %-11s %-42s %6.1f s  x%.2f -> x%.2f of the floor",
                static_cast<unsigned long long>(s.seed), s.kind.c_str(), s.size.c_str(), joined(s.truth).c_str(),
                s.outcome.c_str(), joined(s.found).c_str(), s.seconds, s.before / s.floor, s.after / s.floor);
  return text.data();
}

void work(const Options& options) {
  std::atomic<std::uint64_t> next{options.first};
  std::mutex printing;
  std::string trouble;
  constexpr const char* kSets = "sets";
  double to_come = 0.0;  // sets that have no answer yet
  const std::vector<std::string> ways = ways_of(options);
  const auto all_answered = [&](std::uint64_t seed) {
    return std::ranges::all_of(ways,
                               [&](const auto& way) { return answered(options, places(options.out, seed, way)); });
  };
  for (std::uint64_t seed = options.first; seed <= options.last; ++seed) to_come += all_answered(seed) ? 0.0 : 1.0;
  ProgressLine progress_line;
  const Progress progress = progress_line.progress();
  progress.expect(kSets, to_come);
  progress.begin(kSets, options.draw_only ? "drawing sets" : "diagnosing sets");
  const auto worker = [&] {
    for (std::uint64_t seed = next++; seed <= options.last; seed = next++) {
      try {
        const bool there = all_answered(seed);
        std::string said;
        for (const std::string& way : ways) {
          const Places where = places(options.out, seed, way);
          draw(seed, options, where);
          if (way == kLeftOut && read_json(where.truth).value("kind", "") != kKindNames[0]) continue;
          if (!options.draw_only) diagnose(options, way, where);
          said += (said.empty() ? "" : "\n") + (options.draw_only ? where.data : line(score_of(where)));
          if (!way.empty()) said += "  " + way;
        }
        if (!there) progress.done(kSets);
        const std::lock_guard lock(printing);
        std::printf("%s\n", said.c_str());
        std::fflush(stdout);
      } catch (const RunsAway& none) {
        const std::lock_guard lock(printing);
        std::printf("%5llu  %s\n", static_cast<unsigned long long>(seed), none.what());
        progress.done(kSets);
      } catch (const std::exception& error) {
        const std::lock_guard lock(printing);
        trouble = "set " + std::to_string(seed) + ": " + error.what();
        next = options.last + 1;
      }
    }
  };
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(options.jobs));
  for (int i = 0; i < options.jobs; ++i) threads.emplace_back(worker);
  for (std::thread& thread : threads) thread.join();
  if (!trouble.empty()) throw std::runtime_error(trouble);
}

std::vector<Score> scores_of(const Options& options, const std::string& way) {
  std::vector<Score> scores;
  for (std::uint64_t seed = options.first; seed <= options.last; ++seed) {
    const Places where = places(options.out, seed, way);
    if (fs::exists(where.truth) && fs::exists(where.found + "/run.json")) scores.push_back(score_of(where));
  }
  return scores;
}

std::string how_of(const Options& options) {
  std::string how = "./check --sealed --seeds " + options.seeds;
  if (!options.only.empty()) how += " --only " + options.only;
  if (!options.size.empty()) how += " --size " + options.size;
  if (options.craft_class != kClassNames[0]) how += " --class " + options.craft_class;
  return how + (options.learning ? " --learning" : "");
}

void write_scores(const std::vector<Score>& scores, const std::string& path) {
  Json all = Json::array();
  for (const Score& score : scores) all.push_back(to_json(score));
  std::ofstream(path) << all.dump(1) << "\n";
}

void conclude(const Options& options) {
  if (options.learning) {
    const std::string page = options.page.empty() ? options.out + "/learning.md" : options.page;
    std::ofstream(page) << to_learning_page(scores_of(options, kTold), scores_of(options, kLeftOut), how_of(options));
    write_scores(scores_of(options, kTold), options.out + "/scores-told.json");
    write_scores(scores_of(options, kLeftOut), options.out + "/scores-left-out.json");
    std::printf("%s\n", page.c_str());
    return;
  }
  const std::vector<Score> scores = scores_of(options, "");
  write_scores(scores, options.out + "/scores.json");
  const std::string page = options.page.empty() ? options.out + "/benchmark.md" : options.page;
  const std::string picture = fs::path(page).replace_extension(".svg").string();
  draw_picture(scores, picture);
  std::ofstream(page) << to_page(scores, how_of(options), fs::path(picture).filename().string());
  std::printf("%s, %s, %s/scores.json\n", page.c_str(), picture.c_str(), options.out.c_str());
}

}  // namespace
}  // namespace fathom::sealed

int main(int argc, char** argv) {
  using namespace fathom::sealed;
  Options options;
  CLI::App app{"Draws sealed data sets, has them diagnosed, and keeps the score.", "sealed"};
  app.add_option("--seeds", options.seeds, "A..B or one number (default " + options.seeds + ")");
  app.add_option("--only", options.only, "an effect's name, or: single clean noise pair foreign mixed many unlisted");
  app.add_option("--size", options.size)->check(CLI::IsMember({"weak", "medium", "strong"}));
  app.add_option("--class", options.craft_class, "of craft: rov, torpedo, boat, ship or glider; each into an --out")
      ->check(CLI::IsMember(std::vector<std::string>(kClassNames.begin(), kClassNames.end())));
  app.add_option("--out", options.out, "folder of data, truth and answers")->required();
  app.add_option("--tool", options.tool, "the program fathom")->required();
  app.add_option("--page", options.page, "write the page here instead of into --out; its picture beside it");
  app.add_option("--ablate", options.ablated, "rule or term of the inference that is left out; into another --out");
  app.add_option("-j", options.jobs, "sets at a time")->check(CLI::Range(1, 64));
  app.add_flag("--learning", options.learning,
               "what is learned: single effects are asked once more with theirs taken out of the list; errors on a new "
               "recording");
  app.add_flag("--draw-only", options.draw_only, "only draw the sets");
  app.add_flag("--score-only", options.score_only, "only score the answers that are there");
  try {
    app.parse(argc, argv);
    parse_seeds(options);
    if (!options.score_only) work(options);
    if (!options.draw_only) conclude(options);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sealed: %s\n", error.what());
    return 1;
  }
}
