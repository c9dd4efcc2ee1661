// Lockstep without a bus: who is asked, who must answer, and in which order messages are handled and recorded.
#include "common/runtime/lockstep.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/runtime/recorder.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::runtime;

namespace {

using Names = std::vector<std::string>;

fathom_lcm::lockstep_t phase_of(std::int64_t tick, int phase, const Names& channels) {
  fathom_lcm::lockstep_t message{};
  message.utime = 1000 * tick;
  message.tick = tick;
  message.phase = phase;
  message.channel = channels;
  message.n_messages = static_cast<std::int32_t>(channels.size());
  return message;
}

std::vector<std::uint8_t> text(const std::string& word) { return {word.begin(), word.end()}; }

/// Messages that come by their own channels.
Said alone(const Names& channels) { return {.channel = channels}; }

fathom_lcm::lockstep_ack_t hello(const std::string& name, const Names& heard) { return Follower{name, heard}.hello(); }

fathom_lcm::lockstep_ack_t answer(const std::string& name, const fathom_lcm::lockstep_t& phase, const Names& said) {
  fathom_lcm::lockstep_ack_t ack{};
  ack.process = name;
  ack.tick = phase.tick;
  ack.phase = phase.phase;
  ack.said = said;
  return ack;
}

}  // namespace

TEST_CASE("follower: a phase begins when all its messages are here, in the conductor's order") {
  Follower follower{"estimator", {"AHRS", "DVL"}};
  follower.arrived(1, text("d1"));
  follower.announced(phase_of(0, 0, {"AHRS", "THRUSTERS", "DVL", "AHRS"}));
  CHECK_FALSE(follower.next());
  follower.arrived(0, text("a1"));
  CHECK_FALSE(follower.next());
  follower.arrived(0, text("a2"));
  follower.arrived(0, text("a3"));  // of the interval after
  const auto messages = follower.next();
  REQUIRE(messages);
  REQUIRE(messages->size() == 3);
  CHECK((*messages)[0].bytes == text("a1"));
  CHECK((*messages)[1].bytes == text("d1"));
  CHECK((*messages)[2].bytes == text("a2"));
  follower.said("STATE", text("s"));
  follower.said("HEALTH", text("h"));
  const auto ack = follower.answer();
  CHECK(ack.said == Names{"STATE"});
  CHECK(ack.tick == 0);
  CHECK_FALSE(follower.next());
}

TEST_CASE(
    "follower: a phase that does not concern it needs no answer; an operator's word goes first; the end ends it") {
  Follower follower{"supervisor", {"STATE", "OPERATOR"}};
  CHECK_FALSE(follower.started());
  follower.announced(phase_of(0, 0, {"AHRS"}));
  CHECK(follower.started());
  CHECK_FALSE(follower.next());
  follower.arrived(1, text("human"));
  follower.arrived(0, text("s"));
  follower.announced(phase_of(1, 0, {"STATE"}));
  const auto messages = follower.next();
  REQUIRE(messages);
  CHECK((*messages)[0].bytes == text("human"));
  CHECK((*messages)[1].bytes == text("s"));
  follower.announced(phase_of(2, -1, {"estimator"}));  // somebody else's turn
  CHECK_FALSE(follower.ends());
  follower.announced(phase_of(3, -1, {"supervisor"}));
  CHECK(follower.ends());
  follower.said("WRENCH_COMMAND", text("w"));
  CHECK(follower.answer().said == Names{"WRENCH_COMMAND"});
  CHECK(follower.answer().tick == 3);
}

TEST_CASE("what is said in a phase is enclosed in the next one, for followers and for the log; pictures travel alone") {
  Conductor conductor{{"vision", "estimator", "recorder"}};
  conductor.hear(hello("vision", {"CAMERA"}));
  conductor.hear(hello("estimator", {"TAG_POSE", "CAMERA"}));
  conductor.hear(hello("recorder", {kEveryChannel}));
  Said said;
  said.add("CAMERA", text("large"));
  said.add("TAG_POSE", text("t1"));
  said.add("TAG_POSE", text("tag 2"));
  const auto first = conductor.begin(7, said);
  Follower estimator{"estimator", {"TAG_POSE", "CAMERA"}}, vision{"vision", {"CAMERA"}};
  std::vector<std::string> log;
  Arrangement arrangement{[&](const std::string& channel, std::vector<std::uint8_t>& bytes, Utime) {
    log.push_back(channel + " " + std::string(bytes.begin(), bytes.end()));
  }};
  for (Follower* each : {&estimator, &vision}) each->announced(first);
  arrangement.announced(first);
  CHECK_FALSE(vision.next());
  CHECK_FALSE(estimator.next());
  CHECK(log.empty());
  estimator.arrived(1, text("large"));
  vision.arrived(0, text("large"));
  arrangement.arrived("CAMERA", text("large"));
  CHECK(log == Names{"CAMERA large", "TAG_POSE t1", "TAG_POSE tag 2"});
  const auto messages = estimator.next();
  REQUIRE(messages);
  REQUIRE(messages->size() == 3);
  CHECK((*messages)[0].bytes == text("large"));
  CHECK((*messages)[1].bytes == text("t1"));
  CHECK((*messages)[2].bytes == text("tag 2"));
  estimator.said("STATE", text("state"));
  REQUIRE(vision.next());
  vision.said("OPTICAL_FLOW", text("flow"));
  vision.said("CAMERA_DEBUG", text("drawn"));
  conductor.hear(estimator.answer());
  conductor.hear(vision.answer());
  const auto second = conductor.next();  // over the wire and back
  REQUIRE(second);
  std::vector<std::uint8_t> wire(static_cast<std::size_t>(second->getEncodedSize()));
  REQUIRE(second->encode(wire.data(), 0, static_cast<int>(wire.size())) > 0);
  fathom_lcm::lockstep_t heard{};
  REQUIRE(heard.decode(wire.data(), 0, static_cast<int>(wire.size())) == static_cast<int>(wire.size()));
  arrangement.announced(heard);
  CHECK(log.size() == 3);  // the drawn picture is waited for
  arrangement.arrived("CAMERA_DEBUG", text("drawn"));
  CHECK(log.back() == "STATE state");  // the order of the names: vision, estimator
  CHECK(log[3] == "OPTICAL_FLOW flow");
  CHECK(log[4] == "CAMERA_DEBUG drawn");
}

TEST_CASE("a phase whose sizes are not those of its messages is refused") {
  fathom_lcm::lockstep_t phase = phase_of(0, 0, {"AHRS"});
  phase.size = {3};
  phase.bytes = text("ab");
  CHECK(test::complaint_of<InputError>([&] { static_cast<void>(enclosed(phase)); }).find("same build") !=
        std::string::npos);
  phase.size = {-1};
  CHECK_THROWS_AS(static_cast<void>(enclosed(phase)), InputError);
}

TEST_CASE("conductor: at the end each process goes in its turn, and those behind it hear its last words") {
  Conductor conductor{{"recorder", "estimator", "identifier"}};
  conductor.hear(hello("recorder", {kEveryChannel}));
  conductor.hear(hello("estimator", {"AHRS"}));
  conductor.hear(hello("identifier", {"STATE"}));
  static_cast<void>(conductor.begin(0, alone({"TRUTH"})));
  REQUIRE(conductor.over());
  const auto first = conductor.finish(7);
  REQUIRE(first);
  CHECK(first->phase == -1);
  CHECK(first->channel == Names{"estimator"});
  CHECK_FALSE(conductor.over());
  conductor.hear(answer("estimator", *first, {"STATE"}));
  const auto words = conductor.next();
  REQUIRE(words);
  CHECK(words->channel == Names{"STATE"});
  CHECK(words->phase == 0);
  conductor.hear(answer("identifier", *words, {"MODEL"}));
  const auto for_the_log = conductor.next();  // nobody hears MODEL but the recorder
  REQUIRE(for_the_log);
  CHECK(for_the_log->channel == Names{"MODEL"});
  CHECK(conductor.over());
  const auto second = conductor.finish(7);
  REQUIRE(second);
  CHECK(second->channel == Names{"identifier"});
  conductor.hear(answer("identifier", *second, {}));
  CHECK_FALSE(conductor.next());
  CHECK(conductor.over());
  const auto last = conductor.finish(7);
  REQUIRE(last);
  CHECK(last->channel.empty());  // the recorder's
  CHECK_FALSE(conductor.finish(7));
}

TEST_CASE("conductor: phases follow the messages until nobody has anything left to handle") {
  Conductor conductor{{"estimator", "identifier", "supervisor"}};
  CHECK(conductor.absent().size() == 3);
  conductor.hear(hello("supervisor", {"STATE", "MODEL"}));
  conductor.hear(hello("estimator", {"AHRS"}));
  conductor.hear(hello("identifier", {"STATE", "THRUSTERS"}));
  CHECK(conductor.absent().empty());

  auto phase = conductor.begin(5, alone({"THRUSTERS", "AHRS"}));
  CHECK_FALSE(conductor.over());
  CHECK(conductor.waiting_for() == "estimator, identifier");
  conductor.hear(answer("identifier", phase, {}));
  CHECK_FALSE(conductor.next());
  conductor.hear(answer("estimator", phase, {"STATE", "STATE"}));
  const auto second = conductor.next();
  REQUIRE(second);
  CHECK(second->phase == 1);
  CHECK(second->channel == Names{"STATE", "STATE"});
  // The answers' order does not matter: what they said is handled in the order of the names.
  conductor.hear(answer("supervisor", *second, {"WRENCH_COMMAND"}));
  conductor.hear(answer("identifier", *second, {"MODEL", "RESIDUAL"}));
  const auto third = conductor.next();
  REQUIRE(third);
  CHECK(third->channel == Names{"MODEL", "RESIDUAL", "WRENCH_COMMAND"});
  CHECK(conductor.waiting_for() == "supervisor");
  conductor.hear(answer("supervisor", *third, {}));
  CHECK_FALSE(conductor.next());
  CHECK(conductor.over());
  CHECK(conductor.said("WRENCH_COMMAND") == 1);

  phase = conductor.begin(6, alone({"TRUTH"}));  // nobody hears it
  CHECK(phase.tick == 1);
  CHECK(conductor.over());
}

TEST_CASE("conductor: strangers, doubles and restarts are named") {
  Conductor conductor{{"estimator"}};
  CHECK(test::complaint_of<InputError>([&] { conductor.hear(hello("vision", {"CAMERA"})); }).find("vision follows") !=
        std::string::npos);
  conductor.hear(hello("estimator", {"AHRS"}));
  conductor.hear(hello("estimator", {"AHRS"}));  // said again until it is heard
  const auto phase = conductor.begin(0, alone({"AHRS"}));
  conductor.hear(hello("estimator", {"AHRS"}));  // one that was still under way
  conductor.hear(answer("estimator", phase, {}));
  CHECK(test::complaint_of<InputError>([&] {
          conductor.hear(answer("estimator", phase, {}));
        }).find("two processes answer as estimator") != std::string::npos);
  CHECK(test::complaint_of<InputError>([&] { conductor.hear(hello("estimator", {"AHRS"})); }).find("started anew") !=
        std::string::npos);
}

TEST_CASE("conductor: a hello under way while others answer is no restart, one after an answer is") {
  Conductor conductor{{"estimator", "identifier", "recorder"}};
  conductor.hear(hello("estimator", {"AHRS"}));
  conductor.hear(hello("identifier", {"STATE"}));
  conductor.hear(hello("recorder", {kEveryChannel}));
  const auto phase = conductor.begin(0, alone({"AHRS"}));
  conductor.hear(answer("estimator", phase, {"AHRS_HEALTH"}));
  CHECK(conductor.next());                             // what the estimator said is heard by the recorder alone
  conductor.hear(hello("identifier", {"STATE"}));      // has not been asked yet
  conductor.hear(hello("recorder", {kEveryChannel}));  // is not waited for
  fathom_lcm::lockstep_ack_t ack{};
  ack.process = "recorder";
  ack.tick = phase.tick;
  conductor.hear(ack);
  const auto restart = [&] { conductor.hear(hello("recorder", {kEveryChannel})); };
  CHECK(test::complaint_of<InputError>(restart).find("recorder was started anew") != std::string::npos);
}

TEST_CASE("conductor: a recorder may be behind, but not by more than the bus can hold") {
  Conductor conductor{{"recorder"}};
  conductor.hear(hello("recorder", {kEveryChannel}));
  fathom_lcm::lockstep_ack_t ack{};
  ack.process = "recorder";
  for (std::int64_t tick = 0; tick < Conductor::kRecorderBehind - 1; ++tick) {
    static_cast<void>(conductor.begin(tick, alone({"AHRS"})));
    CHECK(conductor.over());
  }
  static_cast<void>(conductor.begin(99, alone({"AHRS"})));
  CHECK_FALSE(conductor.over());
  CHECK(conductor.waiting_for() == "recorder");
  ack.tick = 8;
  conductor.hear(ack);
  CHECK(conductor.over());
}

TEST_CASE("recorder: whatever the order of arrival, the log has the order of handling and virtual times") {
  std::vector<std::string> log;
  Arrangement arrangement{[&](const std::string& channel, std::vector<std::uint8_t>& bytes, Utime utime) {
    log.push_back(channel + " " + std::string(bytes.begin(), bytes.end()) + " " + std::to_string(utime));
  }};
  arrangement.arrived("STATE", text("s1"));
  arrangement.announced(phase_of(1, 0, {"AHRS", "DVL", "AHRS"}));
  arrangement.arrived("DVL", text("d1"));
  arrangement.arrived("AHRS", text("a1"));
  CHECK(log.empty());
  arrangement.announced(phase_of(1, 1, {"STATE"}));
  arrangement.arrived("HEALTH", text("h"));
  arrangement.arrived("AHRS", text("a2"));
  CHECK(arrangement.tick() == 1);
  arrangement.arrived("MODEL", text("nobody announced it"));
  arrangement.announced(phase_of(2, -1, {}));
  CHECK(arrangement.ended());
  CHECK(log == Names{"HEALTH h 1000", "AHRS a1 1000", "DVL d1 1000", "AHRS a2 1000", "STATE s1 1000"});
}

TEST_CASE("recorder: a channel that it is told to leave out is neither written nor waited for") {
  Names log;
  Arrangement arrangement{
      [&](const std::string& channel, std::vector<std::uint8_t>&, Utime) { log.push_back(channel); }, {"CAMERA"}};
  arrangement.announced(phase_of(1, 0, {"AHRS", "CAMERA"}));
  arrangement.arrived("CAMERA", text("large"));
  arrangement.arrived("AHRS", text("a"));
  arrangement.announced(phase_of(1, 1, {"TAG_POSE"}));
  arrangement.arrived("TAG_POSE", text("t"));
  arrangement.announced(phase_of(2, 0, {"CAMERA"}));  // lost on the way
  CHECK(arrangement.tick() == 2);
  CHECK(log == Names{"AHRS", "TAG_POSE"});
}
