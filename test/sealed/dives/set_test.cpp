// Sealed sets: sizes that are what they say, the same bytes for the same number, and nothing of the truth beside the
// data.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "test/sealed/dives/sealed_set.hpp"
#include "test/sealed/dives/writing.hpp"
#include "test/sealed/judging/reference.hpp"
#include "test/support/scratch.hpp"

namespace fathom::sealed {
namespace {

constexpr double kClass = 0.10;  // a set may miss its class by so much

SealedSet set_of(std::uint64_t seed, const std::string& effect, Size size) {
  return make_set(make_plan(seed, {.effect = effect, .size = size}));
}

}  // namespace

TEST_CASE("sealed set: the effect adds the share of the applied wrench that its class says") {
  const std::vector<std::pair<const char*, Size>> orders{
      {"current", Size::kWeak}, {"thruster_lag", Size::kStrong}, {"coloured_noise", Size::kWeak}};
  std::uint64_t seed = 70;
  for (const auto& [name, size] : orders) {
    const std::string effect = name;
    const SealedSet set = set_of(++seed, effect, size);
    CAPTURE(effect);
    CHECK(set.reached);
    const double target = kShares[static_cast<std::size_t>(size)];
    CHECK(set.shares.front() == doctest::Approx(target).epsilon(kClass));
    // Measured anew on what is written.
    CHECK(added_share(set.craft, set.fit, set.clean_fit) == doctest::Approx(target).epsilon(kClass));
  }
}

TEST_CASE("sealed set: the vehicle stays about its box at speeds of a vehicle") {
  const SealedSet set = set_of(4, "clean", Size::kMedium);
  for (const Dive& run : set.train) {
    for (const State& state : run.state) {
      const Eigen::Vector3d offset = (state.head<3>() - set.site.centre).cwiseAbs().cwiseQuotient(set.site.half);
      REQUIRE(offset.maxCoeff() < 1.8);  // the hand is soft
      REQUIRE(state.segment<3>(kSpeed).norm() < 2.0);
    }
  }
}

TEST_CASE("sealed set: every mechanism of size zero is absent, and none at its usual size") {
  Random random(2, "test");
  const Site site{.half = {3.0, 3.0, 1.5}, .centre = {0.0, 0.0, 2.5}};
  Craft craft = draw_craft(Family::kHeavy, random);
  const DiveOrder order{.begin = 200.0, .length = 60.0, .seed = 9, .purpose = "test"};
  const Dive plain = dive(craft, site, {}, {}, order);
  std::vector<const Entry*> all{&coloured_noise()};
  for (const auto* list : {&catalogue(), &foreign(), &further(), &unlisted()}) {
    for (const Entry& entry : *list) all.push_back(&entry);
  }
  for (const Entry* entry : all) {
    CAPTURE(entry->name);
    Mechanisms one;
    one.push_back(entry->make(entry->name, craft, site, random));
    const auto difference = [&](double size) {
      one.front()->set_size(size);
      const Dive run = dive(craft, site, one, {}, order);
      REQUIRE(run.sound);
      double most = 0.0;
      for (std::size_t k = 0; k < run.size(); k += 10) {
        most = std::max({most, (run.sensed.nu[k] - plain.sensed.nu[k]).cwiseAbs().maxCoeff(),
                         (run.sensed.position[k] - plain.sensed.position[k]).cwiseAbs().maxCoeff()});
      }
      return most;
    };
    // Lag and play are integrated with the steps of the vehicle and never quite vanish.
    const bool stiff =
        entry->name.starts_with("thruster_lag") || entry->name == "thrust_hysteresis" || entry->name == "slow_run_up";
    CHECK(difference(0.0) <= (stiff ? 0.05 : 1e-9));
    const double usual = 3.0 * one.front()->first_guess();
    CHECK(difference(std::min(usual, one.front()->largest())) > 1e-3);
    CHECK_FALSE(one.front()->parameters().empty());
  }
}

TEST_CASE("sealed set: the same number gives the same bytes, another number others") {
  const SealedSet a = set_of(31, "air_bursts", Size::kMedium), b = set_of(31, "air_bursts", Size::kMedium);
  CHECK(to_vehicle_file(a) == to_vehicle_file(b));
  CHECK(to_truth(a) == to_truth(b));
  REQUIRE(a.train.size() == b.train.size());
  CHECK(to_csv(a, a.train.front()) == to_csv(b, b.train.front()));
  CHECK(to_vehicle_file(a) != to_vehicle_file(set_of(32, "clean", Size::kMedium)));
}

TEST_CASE("sealed set: the folder of data holds data, and no word of the truth") {
  const test::Scratch scratch;
  const SealedSet set = set_of(6, "wave", Size::kMedium);
  const Places where = places(scratch.path("out"), 6);
  write_set(set, where);
  CHECK(std::filesystem::exists(where.truth));
  CHECK(where.truth.find(where.data) == std::string::npos);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(where.data)) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    CHECK((name == "vehicle.yaml" || name == "validate.csv" || name.starts_with("train-")));
    const std::string text = test::read_bytes(entry.path().string());
    const std::string head = text.substr(0, name == "vehicle.yaml" ? text.size() : text.find('\n'));
    for (const auto* list : {&catalogue(), &foreign()}) {
      for (const Entry& effect : *list) CHECK(head.find(effect.name) == std::string::npos);
    }
  }
}

TEST_CASE("sealed set: the generator shares no code with what it judges") {
  int files = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::string{FATHOM_SOURCE_DIR} + "/test/sealed")) {
    if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
    ++files;
    CAPTURE(entry.path().string());
    std::string text = test::read_bytes(entry.path().string());
    // The line that tells how much time is left knows nothing of vehicles.
    const std::string time_left = std::string{"#include \"comm"} + "on/base/progress_line.hpp\"";
    if (const auto at = text.find(time_left); at != std::string::npos) text.erase(at, time_left.size());
    CHECK(text.find(std::string{"#include \"comm"} + "on/") == std::string::npos);
  }
  CHECK(files > 20);  // it did look
}

TEST_CASE("sealed set: 123 numbers in a row draw every effect in every size, and what must stay unnamed") {
  std::map<std::string, std::set<Size>> seen;
  std::map<Kind, int> kinds;
  for (std::uint64_t seed = 0; seed < 123; ++seed) {
    const Plan plan = make_plan(seed, {});
    ++kinds[plan.kind];
    if (plan.kind == Kind::kSingle) seen[plan.names.front()].insert(plan.size);
    CHECK(plan.names.size() == (plan.kind == Kind::kPair ? 2 : plan.kind == Kind::kClean ? 0 : 1));
  }
  CHECK(seen.size() == catalogue().size());
  for (const auto& [name, sizes] : seen) {
    CAPTURE(name);
    CHECK(sizes.size() == kShares.size());
  }
  for (const Kind kind : {Kind::kClean, Kind::kNoise, Kind::kPair, Kind::kForeign}) CHECK(kinds[kind] >= 6);
}

TEST_CASE("sealed set: two effects of the list beside one of no list, each of its own size") {
  std::set<Size> sizes;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Plan plan = make_plan(seed, {.effect = "mixed"});
    REQUIRE(plan.names.size() == 3);
    REQUIRE(plan.sizes.size() == 3);
    const auto among = [](const std::vector<Entry>& list, const std::string& name) {
      return std::ranges::find(list, name, &Entry::name) != list.end();
    };
    CHECK(among(catalogue(), plan.names[0]));
    CHECK(among(catalogue(), plan.names[1]));
    CHECK(among(foreign(), plan.names[2]));
    sizes.insert(plan.sizes.begin(), plan.sizes.end());
  }
  CHECK(sizes.size() == kShares.size());
  const Plan weak = make_plan(0, {.effect = "mixed", .size = Size::kWeak});
  CHECK(weak.sizes.empty());
  CHECK(weak.size == Size::kWeak);
}

TEST_CASE("sealed set: five or six effects of the list, of which each pair goes together") {
  std::set<std::size_t> counts;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Plan plan = make_plan(seed, {.effect = "many"});
    counts.insert(plan.names.size());
    CHECK(plan.sizes.size() == plan.names.size());
    CHECK(std::set(plan.names.begin(), plan.names.end()).size() == plan.names.size());
    CHECK(std::ranges::count_if(plan.names, [](const std::string& name) { return name.starts_with("sensor_"); }) <= 1);
  }
  CHECK(counts == std::set<std::size_t>{5, 6});
}

TEST_CASE("sealed set: nobody beats the true simulator, and more signals never widen the bound") {
  const SealedSet clean = set_of(8, "clean", Size::kMedium);
  const Bound bound = cramer_rao(clean);
  for (Eigen::Index j = 0; j < bound.speeds.size(); ++j) {
    CHECK(bound.all[j] > 0.0);
    CHECK(bound.all[j] < bound.speeds[j]);
  }
  const SealedSet strong = set_of(9, "current", Size::kStrong), medium = set_of(9, "thrust_asymmetry", Size::kMedium);
  for (const SealedSet* set : {&strong, &medium}) {
    const Floor floor = prediction_floor(*set);
    CHECK(floor.truth > 0.0);
    CHECK(floor.base > 3.0 * floor.truth);
  }
  CHECK(std::isfinite(prediction_floor(medium).base));  // a strong one may make the base model diverge
}

}  // namespace fathom::sealed
