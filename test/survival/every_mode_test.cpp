// Whatever is killed in whichever mode of a trial: it comes back, the identifier with what it had learnt, the trial
// goes on to its end, and its parameters agree with those of an undisturbed one. The short form runs always;
// FATHOM_LONG=yes adds every process in every mode of the full schedule, and the supervisor in each (some ten minutes).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <filesystem>
#include <utility>

#include "common/base/event_log.hpp"
#include "common/runtime/bus.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/minds.hpp"
#include "test/support/private_network.hpp"
#include "test/survival/agree.hpp"

namespace fathom {
namespace {

using test::check_agree;
using test::on_a_network;
using test::private_network;
using test::Scratch;

bool long_form() { return std::getenv("FATHOM_LONG") != nullptr; }

/// Of modes that end after a few seconds, whatever is known by then.
constexpr char kShort[] =
    "s/least_dwell: .*/least_dwell: 6 s/; s/most_dwell: .*/most_dwell: 10 s/; s/retries: .*/retries: 0/";

/// Lines that write pipeline.yaml (changed by `change`), live.cfg and still.cfg, which use it.
std::string configurations(const std::string& change) {
  return "sed -e '" + change +
         "' ${configs%procman}config/pipelines/tank.yaml >pipeline.yaml\n"
         "for i in tank lockstep; do sed 's|[$]FATHOM_SHARE/config/pipelines/tank.yaml|$FATHOM_RUN/pipeline.yaml|' "
         "$configs/$i.cfg >$i.cfg; done\n"
         // The operator asks again and again: should the supervisor have lost its state or its life, it goes on.
         "orders=$(for i in $(seq 5 8 1500); do printf ' --order %d=identify' $i; done)\n"
         "simulation=\"--log-level warning --seed 4 --until-done $orders\"\n";
}

/// A trial in real time, `speed` times as fast; `deeds` may use in_mode MODE and slay PROCESS...
std::string disturbed(int speed, int limit, const std::string& deeds) {
  return "export FATHOM_SIMULATION=\"$simulation --duration " + std::to_string(limit) + " --speed " +
         std::to_string(speed) +
         "\"\n"
         "$fathom watch 2>watch.txt & w=$!\n"
         "$sheriff tank.cfg --script simulated-trial --local -v >sheriff.txt & s=$!\n"
         "in_mode() { mode=$1; while kill -0 $s 2>/dev/null; do tail -n 1 watch.txt | grep -q \"excite *$1\" && "
         "return; "
         "sleep 0.05; done; echo \"no mode $1\"; }\n"
         "slay() { local p old=(); for p in $*; do old+=(\"$(pid $p)\"); done; kill -9 ${old[*]} || echo \"no $*\"; "
         "for p in $*; do until_new $p ${old[0]}; old=(\"${old[@]:1}\"); echo \"$p slain in $mode\"; done; sleep 1; "
         "}\n" +
         deeds + "wait $s; echo \"code $?\"; kill $w; cat sheriff.txt watch.txt\n";
}

/// All parts of a log that a killed recorder has left.
std::vector<std::string> parts(const Scratch& scratch) {
  std::vector<std::string> all;
  for (int i = 0; i < 100; ++i) {
    const std::string path = scratch.path("trial.lcmlog." + std::string{i < 10 ? "0" : ""} + std::to_string(i));
    if (!std::filesystem::exists(path)) break;
    all.push_back(path);
  }
  return all;
}

/// MODELs in their order, and which of them are the first of a new identifier.
struct Learnt {
  std::vector<ModelEstimate> models;
  std::vector<std::size_t> anew;
};

Learnt learnt_in(const Scratch& scratch) {
  Learnt learnt;
  bool anew = false;
  int64_t pid = 0;  // PROCESS_INFO is said again and again
  for (const std::string& path : parts(scratch)) {
    EventLog log{path};
    while (const auto event = log.next()) {
      if (event->channel == "HEALTH") {
        const auto health = runtime::message_of<fathom_lcm::health_t>(event->data);
        if (health && health->process == "identifier" && std::exchange(pid, health->pid) != health->pid) anew = true;
      } else if (event->channel == "MODEL") {
        const auto message = runtime::message_of<fathom_lcm::model_t>(event->data);
        const auto model = message ? wire::decode(*message) : std::nullopt;
        if (!model) continue;
        if (std::exchange(anew, false) && !learnt.models.empty()) learnt.anew.push_back(learnt.models.size());
        learnt.models.push_back(*model);
      }
    }
  }
  return learnt;
}

/// Where the identifier began anew, it went on with its covariance: it knows at least what it had saved, which is never
/// older than two seconds.
void check_resumed(const Learnt& learnt, std::size_t kills) {
  constexpr double kSaved = 2.5;  // s, with the interval between two MODELs
  constexpr double kKnown = 5.0;  // standard deviations from zero; before, what is said of the doubt is itself in doubt
  // Of a standard deviation: the noise's scale and memory are estimated as well, and one that began from nothing would
  // have the prior's, many times as large.
  constexpr double kLess = 2.5;
  const auto& models = learnt.models;
  CHECK(learnt.anew.size() == kills);
  long known = 0;
  for (const std::size_t i : learnt.anew) {
    std::size_t saved = i - 1;
    while (saved > 0 && seconds_between(models[saved].utime, models[i - 1].utime) < kSaved) --saved;
    CHECK(models[i].updates >= models[saved].updates);
    for (std::size_t k = 0; k < models[i].parameters.size(); ++k) {
      const NamedValue &before = models[saved].parameters[k], &after = models[i].parameters[k];
      if (std::abs(before.value) < kKnown * before.std) continue;
      ++known;
      CHECK_MESSAGE(after.std < kLess * before.std, after.name << " after " << models[i].updates << " updates: "
                                                               << before.std << " became " << after.std);
    }
  }
  CHECK(known > 3);
}

bool done(const Recording& run) {
  return std::any_of(run.excitation.begin(), run.excitation.end(), [](const auto& e) { return e.phase == "done"; });
}

long slain(const test::Ran& ran) {
  long count = 0;
  for (auto at = ran.text.find(" slain in "); at != std::string::npos; at = ran.text.find(" slain in ", at + 1))
    ++count;
  return count;
}

void check_went_on(const Scratch& scratch, const test::Ran& ran, long kills, std::size_t of_identifier) {
  CHECK_MESSAGE(ran.says("code 0"), ran.text);
  CHECK_FALSE(ran.says("no new"));
  CHECK_FALSE(ran.says("no mode"));
  CHECK_MESSAGE(slain(ran) == kills, ran.text);
  std::vector<Recording> log;
  for (const std::string& path : parts(scratch)) log.push_back(wire::read_log(path).recording);
  REQUIRE(!log.empty());
  CHECK_MESSAGE(done(log.back()), ran.text);
  const Learnt learnt = learnt_in(scratch);
  REQUIRE(!learnt.models.empty());
  check_resumed(learnt, of_identifier);
  const Recording still = wire::read_log(scratch.path("trial.lcmlog")).recording;
  REQUIRE(!still.model.empty());
  CHECK(done(still));
  check_agree(learnt.models.back(), still.model.back());
  double lost = 0.0;  // instrument samples while there was no logger
  for (std::size_t i = 1; i < log.size(); ++i) {
    lost += seconds_between(log[i - 1].ahrs.back().utime, log[i].ahrs.front().utime) - 0.01;
  }
  MESSAGE(slain(ran) << " kills; " << log.size() - 1 << " of the logger, between whose lives " << lost
                     << " s of the trial are not recorded");
}

std::string still() {
  return "FATHOM_SIMULATION=\"$simulation --duration 1500\" $sheriff lockstep.cfg --script simulated-trial --local "
         ">still.txt || cat still.txt\n";
}

}  // namespace

TEST_CASE("every mode: what is killed in real time comes back, and the parameters are those of an undisturbed trial") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(scratch,
                                configurations(kShort) + still() +
                                    disturbed(2, 400,
                                              "in_mode yaw; slay fathom-estimator fathom-identifier\n"
                                              "in_mode surge; slay fathom-identifier fathom-diagnoser\n"
                                              "in_mode sway; slay fathom-vision fathom-recorder\n"
                                              "in_mode heave; slay fathom-estimator fathom-identifier\n"
                                              "in_mode total; slay fathom-identifier fathom-estimator\n"),
                                280);
  constexpr long kKills = 10, kOfIdentifier = 4;
  check_went_on(scratch, ran, kKills, kOfIdentifier);
}

TEST_CASE("every mode, real time, long: every process but the supervisor in every mode of the whole schedule" *
          doctest::skip(!long_form())) {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(
      scratch,
      configurations("") + still() +
          disturbed(1, 1500,
                    "for m in yaw surge sway heave total; do for p in fathom-estimator fathom-identifier "
                    "fathom-diagnoser fathom-vision fathom-recorder; do in_mode $m; slay $p; done; done\n"),
      2000);
  constexpr long kKills = 25, kOfIdentifier = 5;
  check_went_on(scratch, ran, kKills, kOfIdentifier);
}

TEST_CASE(
    "every mode, real time, long: the supervisor in each; thrust ends in time, the trial is armed again and ends" *
    doctest::skip(!long_form())) {
  if (!private_network()) return;
  for (const std::string mode : {"yaw", "surge", "sway", "heave", "total"}) {
    CAPTURE(mode);
    const Scratch scratch;
    const auto ran = on_a_network(scratch,
                                  configurations("s/  schedule: .*/  schedule: [" + mode + "]/") +
                                      disturbed(1, 600, "in_mode " + mode + "; sleep 2; slay fathom-supervisor\n"),
                                  700);
    CHECK_MESSAGE(ran.says("code 0"), ran.text);
    CHECK(slain(ran) == 1);
    const Recording run = wire::read_log(scratch.path("trial.lcmlog.00")).recording;
    CHECK(done(run));
    // The last command before the silence; there is only one.
    const auto& commands = run.wrench_command;
    const auto gap = std::adjacent_find(commands.begin(), commands.end(),
                                        [](const auto& a, const auto& b) { return a.commander != b.commander; });
    REQUIRE(gap != commands.end());
    Utime last_push = 0;
    for (const Thrusters& each : run.thrusters) {
      const bool pushes = std::any_of(each.tau.begin(), each.tau.end(), [](double x) { return x != 0.0; });
      if (pushes && each.utime < std::next(gap)->utime) last_push = each.utime;
    }
    constexpr double kLife = 0.5;  // s
    CHECK(seconds_between(gap->utime, last_push) < kLife);
    MESSAGE("in " << mode << " thrust ended " << seconds_between(gap->utime, last_push)
                  << " s after the supervisor's last command; " << seconds_between(gap->utime, std::next(gap)->utime)
                  << " s until the next one's first");
  }
}

}  // namespace fathom
