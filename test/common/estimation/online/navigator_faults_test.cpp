// The trial's estimator with sensors that fail, freeze, jump, look at something else or are away.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "test/common/estimation/survey_runs.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using estimation::Navigator;
using estimation::NavigatorSettings;

}  // namespace

TEST_CASE("navigator: a sensor that is silent, frozen, jumping or sends no numbers is refused, counted and named") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Spoil = std::function<bool(test::SurveySample&, double)>;
  struct Fault {
    const char* reason;     // counted under this; empty: nothing to count
    const char* complaint;  // said at the end
    bool shallow;
    Spoil spoil;
    double limit;  // m: largest position error all the same
  };
  std::optional<LaserRange> held_laser;
  std::optional<Dvl> held_dvl;
  const auto after = [](double t) { return t > 25.0; };
  const std::vector<Fault> faults{
      {"", "OPTICAL_FLOW is silent", true,
       [&](auto& s, double t) { return !(after(t) && std::holds_alternative<OpticalFlow>(s)); }, 0.1},
      {"OPTICAL_FLOW not plausible", "OPTICAL_FLOW is silent", true,
       [&](auto& s, double t) {
         if (auto* flow = std::get_if<OpticalFlow>(&s); flow != nullptr && after(t)) flow->flow_C.x() = nan;
         return true;
       },
       0.1},
      {"LASER_RANGE frozen", "LASER_RANGE is frozen", true,
       [&](auto& s, double t) {
         if (auto* laser = std::get_if<LaserRange>(&s); laser != nullptr) {
           if (after(t) && held_laser) laser->p_CL = held_laser->p_CL;
           held_laser = *laser;
         }
         return true;
       },
       0.1},
      {"TAG_POSE gated", "", true,
       [&](auto& s, double t) {
         if (auto* tag = std::get_if<TagPose>(&s); tag != nullptr && std::fmod(t, 1.0) < 0.03) tag->p_CT.x() += 0.5;
         return true;
       },
       0.05},
      {"DVL gated", "", false,
       [&](auto& s, double t) {
         if (auto* dvl = std::get_if<Dvl>(&s); dvl != nullptr && std::fmod(t, 2.0) < 0.12) dvl->v_WB_B.y() += 1.0;
         return true;
       },
       0.4},
      {"USBL gated", "", false,
       [&](auto& s, double t) {
         if (auto* usbl = std::get_if<Usbl>(&s); usbl != nullptr && std::fmod(t + 0.5, 7.0) < 1.0)
           usbl->p_WB.x() += 20.0;
         return true;
       },
       0.4},
      {"DVL frozen", "DVL is frozen", false,
       [&](auto& s, double t) {
         if (auto* dvl = std::get_if<Dvl>(&s); dvl != nullptr) {
           if (after(t) && held_dvl) dvl->v_WB_B = held_dvl->v_WB_B;
           held_dvl = *dvl;
         }
         return true;
       },
       5.0},
      {"DEPTH not plausible", "DEPTH is silent", false,
       [&](auto& s, double t) {
         if (auto* depth = std::get_if<Depth>(&s); depth != nullptr && after(t)) depth->z = nan;
         return true;
       },
       0.5},
      {"AHRS not plausible", "", true,
       [&](auto& s, double t) {
         if (auto* ahrs = std::get_if<Ahrs>(&s); ahrs != nullptr && std::fmod(t, 0.5) < 0.005) ahrs->f_B.y() = nan;
         return true;
       },
       0.05},
      {"AHRS jumped", "", true,
       [&](auto& s, double t) {
         if (auto* ahrs = std::get_if<Ahrs>(&s); ahrs != nullptr && std::fmod(t, 0.5) < 0.005) {
           ahrs->q_WB = ahrs->q_WB * quaternion_from_rotation_vector({0.0, 0.0, 1.0});
         }
         return true;
       },
       0.05},
  };
  for (const Fault& fault : faults) {
    CAPTURE(fault.reason);
    CAPTURE(fault.complaint);
    Navigator navigator{test::survey_settings(fault.shallow), test::survey_places()};
    const auto states = test::feed(
        navigator, test::synthetic_survey({.duration = 30.0, .shallow = fault.shallow, .spoil = fault.spoil}));
    const Judged j = judge(states, 1, 10.0);
    CHECK(j.worst_position < fault.limit);
    for (const StateEstimate& state : states) REQUIRE(state.p_WB.allFinite());
    if (*fault.reason != '\0') CHECK(navigator.rejected()[fault.reason] > 0);
    CHECK(navigator.complaint() == fault.complaint);
  }
}

TEST_CASE("navigator: a flow that freezes at rest is refused once the vehicle moves, and not before") {
  constexpr double kRest = 15.0, kFrozen = 10.0;  // s
  std::optional<OpticalFlow> held;
  const auto spoil = [&](test::SurveySample& s, double t) {
    if (auto* flow = std::get_if<OpticalFlow>(&s); flow != nullptr) {
      if (t > kFrozen) flow->flow_C = held->flow_C;
      held = *flow;
    }
    return true;
  };
  Navigator navigator{test::survey_settings(true), test::survey_places()};
  const auto arrivals =
      test::synthetic_survey({.duration = 30.0, .rest = kRest, .noisy = false, .force_bias = 0.0, .spoil = spoil});
  const auto begins =
      std::ranges::find_if(arrivals, [](const auto& one) { return one.at > utime_after(1'000'000'000, kRest + 0.1); });
  test::feed(navigator, {arrivals.begin(), begins});
  CHECK(navigator.rejected()["OPTICAL_FLOW frozen"] == 0);
  test::feed(navigator, {begins, arrivals.end()});
  CHECK(navigator.rejected()["OPTICAL_FLOW frozen"] > 300);
  CHECK(navigator.complaint() == "OPTICAL_FLOW is frozen");
}

TEST_CASE("navigator: what looks at a wall tells nothing of the floor") {
  // A laser that points ahead, and a wall not far beyond the tour's farthest point: the dot climbs it and comes back.
  const test::SyntheticMotion motion{1};
  const auto mount = test::survey_camera();
  const Eigen::Vector3d beam_C = Eigen::Vector3d{0.0, -0.7, 1.0}.normalized();
  double wall = -HUGE_VAL;
  for (double t = 0.0; t < 60.0; t += 0.1) wall = std::max(wall, motion.p_WB(t).x());
  wall += 0.3;
  const auto spoil = [&](test::SurveySample& s, double t) {
    auto* laser = std::get_if<LaserRange>(&s);
    if (laser == nullptr) return true;
    const Eigen::Vector3d beam_W = motion.R_WB(t) * mount.R_BC * beam_C;
    const Eigen::Vector3d p_WC = motion.p_WB(t) + motion.R_WB(t) * mount.p_BC;
    const double floor = (test::kFloor - p_WC.z()) / beam_W.z(), across = (wall - p_WC.x()) / beam_W.x();
    laser->p_CL = (across > 0.0 ? std::min(floor, across) : floor) * beam_C;
    return true;
  };
  const auto arrivals = test::synthetic_survey({.duration = 60.0, .spoil = spoil});
  auto places = test::survey_places();
  Navigator blind{test::survey_settings(true), places};
  const Judged misled = judge(test::feed(blind, arrivals), 1, 10.0);
  places.walls.max().x() = wall;
  Navigator knowing{test::survey_settings(true), places};
  const Judged judged = judge(test::feed(knowing, arrivals), 1, 10.0);
  MESSAGE("worst " << misled.worst_position << " m without the wall, " << judged.worst_position << " m with it");
  CHECK(knowing.rejected()["LASER_RANGE of a wall"] > 0);
  CHECK(blind.rejected().count("LASER_RANGE of a wall") == 0);
  CHECK(judged.worst_position < 0.02);
  CHECK(misled.worst_position > 2.0 * judged.worst_position);
}

TEST_CASE("navigator: a laser that states a large error counts for less than tags do, and alone when they are gone") {
  constexpr double kOff = 0.03;  // m
  const auto depth_error = [&](double stated, bool tags) {
    const auto spoil = [&](test::SurveySample& s, double t) {
      if (auto* laser = std::get_if<LaserRange>(&s)) {
        laser->p_CL.z() += kOff;
        laser->sigma_range = stated;
      }
      return tags || t < 20.0 || !std::holds_alternative<TagPose>(s);
    };
    NavigatorSettings settings = test::survey_settings(true);
    settings.laser.vertical_cutoff = settings.tags.vertical_cutoff;
    const auto states = run({.duration = 30.0, .noisy = false, .spoil = spoil}, settings);
    const test::SyntheticMotion motion{1};
    double sum = 0.0, n = 0.0;
    for (const StateEstimate& state : states) {
      const double t = seconds_between(1'000'000'000, state.utime);
      if (t < 27.0) continue;
      sum += motion.p_WB(t).z() - state.p_WB.z();
      n += 1.0;
    }
    return sum / n;
  };
  CHECK(depth_error(0.008, true) > 0.2 * kOff);
  CHECK(std::abs(depth_error(0.05, true)) < 0.1 * kOff);
  CHECK(depth_error(0.05, false) > 0.8 * kOff);
}

TEST_CASE("navigator: an attitude sensor that froze gives no state, and what comes after a gap is doubted") {
  std::optional<Ahrs> held;
  const auto spoil = [&](test::SurveySample& s, double t) {
    if (auto* ahrs = std::get_if<Ahrs>(&s); ahrs != nullptr) {
      if (t > 10.0 && t < 12.0 && held) {
        ahrs->f_B = held->f_B;
        ahrs->w_WB_B = held->w_WB_B;
        ahrs->q_WB = held->q_WB;
      }
      held = *ahrs;
    }
    return true;
  };
  const auto states = run({.duration = 20.0, .spoil = spoil}, test::survey_settings(true));
  for (std::size_t k = 1; k < states.size(); ++k) {
    const double t = seconds_between(1'000'000'000, states[k].utime);
    CHECK_FALSE((t > 10.1 && t < 11.99));
    if (seconds_between(states[k - 1].utime, states[k].utime) > 1.0) {
      CHECK_FALSE(states[k].valid);
      CHECK(states[k + 300].valid);  // heave is learnt anew from depths at 2 rad/s
    }
  }
  CHECK(judge(states, 1, 14.0).worst_position < 0.05);
}

TEST_CASE("navigator: an attitude sensor that is away is named by what the others go on with, until it is back") {
  using Kind = std::function<bool(Ahrs&)>;  // false: not said at all
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::optional<Ahrs> held;
  const std::vector<std::pair<std::string, Kind>> kinds{
      {"AHRS is silent or sends no numbers", [](Ahrs&) { return false; }},
      {"AHRS is refused: not plausible",
       [&](Ahrs& ahrs) {
         ahrs.f_B.z() = nan;
         return true;
       }},
      {"AHRS is refused: late",
       [](Ahrs& ahrs) {
         ahrs.utime -= 5'000'000;
         return true;
       }},
      {"AHRS is frozen",
       [&](Ahrs& ahrs) {
         if (!held) held = ahrs;
         const Utime utime = ahrs.utime;
         ahrs = *held;
         ahrs.utime = utime;
         return true;
       }},
  };
  for (const bool shallow : {true, false}) {
    for (const auto& [words, kind] : kinds) {
      CAPTURE(shallow);
      CAPTURE(words);
      held.reset();
      for (const double end : {13.0, 40.0}) {
        auto arrivals = test::synthetic_survey({.duration = end, .shallow = shallow});
        std::erase_if(arrivals, [&](auto& arrival) {
          auto* ahrs = std::get_if<Ahrs>(&arrival.sample);
          if (ahrs == nullptr) return false;
          const double t = seconds_between(1'000'000'000, ahrs->utime);
          return t > 10.0 && t < 13.0 && !kind(*ahrs);
        });
        Navigator navigator{test::survey_settings(shallow), test::survey_places()};
        const auto states = test::feed(navigator, arrivals);
        const std::string said = navigator.complaint();
        if (end < 14.0) {
          CHECK_MESSAGE(said.find(words) == 0, said);
          CHECK(seconds_between(1'000'000'000, states.back().utime) < 10.1);
        } else {
          CHECK(said.empty());
          CHECK(states.back().valid);
        }
      }
    }
  }
}

TEST_CASE("navigator: a first fix that is wild is outvoted by the next two") {
  bool first = true;
  const auto spoil = [&](test::SurveySample& s, double) {
    if (auto* usbl = std::get_if<Usbl>(&s); usbl != nullptr && first) {
      usbl->p_WB.x() += 12.0;
      first = false;
    }
    return true;
  };
  const auto states = run({.duration = 20.0, .shallow = false, .spoil = spoil}, test::survey_settings(false));
  CHECK(judge(states, 1, 5.0).worst_position < 0.4);
  const test::SyntheticMotion motion{1};
  for (const StateEstimate& state : states) {  // and nobody is told to trust it meanwhile
    const Eigen::Vector3d truth = motion.p_WB(seconds_between(1'000'000'000, state.utime));
    if (state.valid) CHECK((state.p_WB - truth).norm() < 1.0);
  }
}

TEST_CASE("navigator: clocks that jump forward or back make no state wrong") {
  auto arrivals = test::synthetic_survey({.duration = 20.0});
  for (auto& arrival : arrivals) {  // a camera whose clock is an hour ahead for a while
    if (auto* flow = std::get_if<OpticalFlow>(&arrival.sample); flow != nullptr && flow->utime > 1'010'000'000) {
      flow->utime += 3'600'000'000;
    }
  }
  Navigator navigator{test::survey_settings(true), test::survey_places()};
  const auto states = test::feed(navigator, arrivals);
  CHECK(navigator.rejected()["OPTICAL_FLOW not plausible"] > 100);
  CHECK(navigator.complaint() == "OPTICAL_FLOW is 3600 s ahead of AHRS; is its clock right?");
  CHECK(judge(states, 1, 5.0).worst_position < 0.1);
  // One that went back by four seconds: what it says is of another time, although that time is still remembered.
  auto late = test::synthetic_survey({.duration = 20.0, .shallow = false});
  for (auto& arrival : late) {
    if (auto* dvl = std::get_if<Dvl>(&arrival.sample); dvl != nullptr && dvl->utime > 1'010'000'000)
      dvl->utime -= 4'000'000;
  }
  Navigator deep{test::survey_settings(false), test::survey_places()};
  const auto deep_states = test::feed(deep, late);
  CHECK(deep.rejected()["DVL too late"] > 50);
  CHECK(deep.complaint().starts_with("DVL comes 3.9 s later than stated; is its clock right"));
  CHECK(judge(deep_states, 1, 5.0).worst_position < 1.0);
}

TEST_CASE("navigator: what an aid needs and is not there is said in one line") {
  const NavigatorSettings settings = test::survey_settings(true);
  auto places = test::survey_places();
  places.tags.clear();
  CHECK(test::complaint_of<InputError>([&] { Navigator none(settings, places); }).find("tags") != std::string::npos);
  places = test::survey_places();
  places.floor.reset();
  CHECK(test::complaint_of<InputError>([&] { Navigator none(settings, places); }).find("floor") != std::string::npos);
}

}  // namespace fathom
