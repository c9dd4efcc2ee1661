// Checks of parts, put together: one finding where many parts show it, the mean of what all measure.
#include "common/consistency/merged.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "test/support/synthetic_recording.hpp"

namespace fathom::consistency {
namespace {

ConsistencyResult scaled(const std::string& run, double size, double std) {
  ConsistencyResult result;
  result.corrections.resize(1);
  result.findings.push_back({.run = run,
                             .signal = "dvl.u",
                             .reference = "pose_capture",
                             .finding = "scale",
                             .size = size,
                             .unit = "",
                             .evidence = "seen",
                             .action = "corrected",
                             .std = std});
  result.pairs["dvl"].checked = true;
  result.pairs["dvl"].statements.push_back({.signal = "dvl.u",
                                            .reference = "pose_capture",
                                            .quantity = "scale",
                                            .unit = "",
                                            .answer = Answer::kDisagree,
                                            .value = size,
                                            .sigma = std,
                                            .neutral = 1.0,
                                            .seen = 5.0 * std,
                                            .practical = 0.05});
  return result;
}

}  // namespace

TEST_CASE("merged: one check is returned as it is") {
  Merged merged{{"dive"}};
  const std::vector<CheckedPart> part{{"dive", 0}};
  merged.add(scaled("all", 1.1, 0.01), part);
  const ConsistencyResult result = std::move(merged).result();
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings[0].evidence == "seen");
  CHECK(result.findings[0].run == "all");
}

TEST_CASE("merged: what several parts show is said once, with their mean, their number and the first ones' names") {
  Merged merged{{"dive"}};
  const std::vector<std::string> names{"dive", "dive from 60 s", "dive from 120 s", "dive from 180 s"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<CheckedPart> part{{names[i], 0}};
    ConsistencyResult one = scaled(names[i], i % 2 == 0 ? 1.1 : 1.2, 0.02);
    one.corrections[0].position_scale = i == 1 ? 2.0 : 1.0;
    one.findings.push_back({.run = names[i],
                            .signal = "gyro",
                            .reference = "itself",
                            .finding = "gap",
                            .size = static_cast<double>(i),
                            .unit = "s",
                            .evidence = "",
                            .action = ""});
    one.findings.push_back({.run = names[i],
                            .signal = "gyro",
                            .reference = "itself",
                            .finding = "glitch",
                            .size = 3.0,
                            .unit = "samples",
                            .evidence = "",
                            .action = ""});
    merged.add(std::move(one), part);
  }
  const ConsistencyResult result = std::move(merged).result();
  REQUIRE(result.findings.size() == 3);
  const ConsistencyFinding& scale = result.findings[0];
  CHECK(scale.run == "dive");
  CHECK(scale.size == doctest::Approx(1.15));
  // Means of four that say 0.02 and scatter by 0.058 about theirs: that over the root of four.
  CHECK(scale.std == doctest::Approx(0.0577 / 2.0).epsilon(0.01));
  for (const char* words : {"in 4 of 4 parts", "dive, dive from 60 s, dive from 120 s, ...", "1.1 to 1.2", "seen"})
    CHECK(scale.evidence.find(words) != std::string::npos);
  CHECK(result.findings[1].size == 3.0);   // the longest gap
  CHECK(result.findings[2].size == 12.0);  // samples of all parts
  REQUIRE(result.corrections.size() == 1);
  CHECK(result.corrections[0].position_scale == 1.0);
}

TEST_CASE("merged: a part that cannot tell takes nothing from one that can, and one that disagrees is not outvoted") {
  Merged merged{{"a", "b"}};
  ConsistencyResult silent = scaled("all", 1.0, 0.01), agrees = silent;
  silent.findings.clear(), agrees.findings.clear();
  silent.pairs["dvl"].statements[0].answer = Answer::kCannotTell;
  silent.pairs["dvl"].statements[0].sigma = std::numeric_limits<double>::infinity();
  silent.pairs["dvl"].statements[0].seen = std::numeric_limits<double>::infinity();
  agrees.pairs["dvl"].statements[0].answer = Answer::kAgree;
  const std::vector<CheckedPart> a{{"a", 0}}, b{{"b", 1}};
  merged.add(silent, a);
  merged.add(agrees, b);
  Merged further = merged;
  const ConsistencyResult result = std::move(merged).result();
  const Statement& both = result.pairs.at("dvl").statements.at(0);
  CHECK(both.answer == Answer::kAgree);
  CHECK(both.value == 1.0);
  CHECK(both.sigma == doctest::Approx(0.01));
  CHECK(both.seen == doctest::Approx(0.05));
  further.add(scaled("all", 1.2, 0.01), b);
  CHECK(std::move(further).result().pairs.at("dvl").statements.at(0).answer == Answer::kDisagree);
}

TEST_CASE("merged: parts of a recording with a velocity log that reads too much come to what the whole comes to") {
  test::SyntheticOptions options;
  options.duration = 600.0;
  options.dvl_matrix = Eigen::Vector3d(1.08, 1.0, 1.0).asDiagonal();
  const Recording whole = test::synthetic_recording(options);
  const ConsistencyResult at_once = check_consistency({&whole, 1});
  Merged merged{{"run"}};
  for (int k = 0; k < 3; ++k) {
    Recording part{.name = "run from " + std::to_string(200 * k) + " s"};
    const Utime from = whole.pose_capture.front().utime + 200'000'000 * k, to = from + 200'000'000;
    const auto cut = [&](const auto& all, auto& some) {
      for (const auto& one : all) {
        if (one.utime >= from && one.utime < to) some.push_back(one);
      }
    };
    cut(whole.pose_capture, part.pose_capture);
    cut(whole.ahrs, part.ahrs);
    cut(whole.dvl, part.dvl);
    cut(whole.depth, part.depth);
    const std::vector<CheckedPart> parts{{part.name, 0}};
    merged.add(check_consistency({&part, 1}), parts);
  }
  const ConsistencyResult result = std::move(merged).result();
  const auto scale_of = [](const ConsistencyResult& one) {
    for (const ConsistencyFinding& finding : one.findings) {
      if (finding.signal == "dvl.u" && finding.finding == "scale") return finding.size;
    }
    return 0.0;
  };
  CHECK(scale_of(at_once) == doctest::Approx(1.0 / 1.08).epsilon(0.01));
  CHECK(scale_of(result) == doctest::Approx(scale_of(at_once)).epsilon(0.005));
  for (const ConsistencyFinding& finding : result.findings) CHECK(finding.evidence.find("in 3 of 3 parts") == 0);
}

}  // namespace fathom::consistency
