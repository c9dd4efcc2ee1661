// Configuring an instrument: set, read back, refuse on a mismatch, repeat what was not answered.
#include "common/devices/dialogue.hpp"

#include <doctest/doctest.h>

#include "common/devices/emulation/emulation.hpp"
#include "common/devices/inertial/sbg_ig500.hpp"
#include "common/devices/protocols.hpp"

using namespace fathom;
using namespace fathom::devices;

namespace {

// Both ends of a line without a line: what one says the other hears, until nobody says anything.
class Talk final : public Output {
 public:
  Talk(std::string_view protocol, const Settings& settings)
      : parser_{devices::protocol(protocol, "test").make(settings)},
        dialogue{make_dialogue(protocol, settings)},
        device{protocol} {}
  void run(double now, const std::function<std::string(std::string)>& alter = {}) {
    go_on(dialogue->begin(now), alter);
  }
  void go_on(std::string said, const std::function<std::string(std::string)>& alter = {}) {
    while (!said.empty()) {
      said_.clear();
      std::string answer = device.hear(said);
      if (alter) answer = alter(answer);
      parser_->feed(as_bytes(answer), *this);
      said = said_;
    }
  }
  // The instrument speaks, whatever it is told.
  void hears_only(const std::string& bytes) {
    (void)dialogue->begin(0.0);
    parser_->feed(as_bytes(bytes), *this);
  }
  void frame(const Parser& parser, const Frame& frame) override { said_ += dialogue->hear(parser, frame, 0.0); }

 private:
  std::unique_ptr<Parser> parser_;
  std::string said_;

 public:
  std::unique_ptr<Dialogue> dialogue;
  EmulatedAnswers device;
};

std::string refuse(const std::string&) {
  constexpr std::array<std::uint8_t, 1> kBadParameter{9};
  return std::string{as_text(ig500::frame(ig500::kAck, kBadParameter))};
}

}  // namespace

TEST_CASE("IG-500: is configured, read back, and only then believed") {
  Talk talk{"ig500", {}};
  CHECK_FALSE(talk.dialogue->done());
  CHECK_FALSE(talk.device.sends_data());
  talk.run(0.0);
  CHECK(talk.dialogue->done());
  CHECK(talk.dialogue->failure().empty());
  CHECK(talk.device.sends_data());
}

TEST_CASE("IG-500: the commands are the ones of the maker's description, byte for byte") {
  const std::vector<std::uint8_t> mask{0, 0, 0, 0x18, 0x1A};
  CHECK(as_text(ig500::frame(ig500::kSetMask, mask)) ==
        std::string_view{"\xFF\x02\x50\x00\x05\x00\x00\x00\x18\x1A\xCE\x84\x03", 13});
  const std::vector<std::uint8_t> continuous{0, 1, 1};
  CHECK(as_text(ig500::frame(ig500::kSetContinuous, continuous)) ==
        std::string_view{"\xFF\x02\x53\x00\x03\x00\x01\x01\x61\x80\x03", 11});
  const std::vector<std::uint8_t> mode{0, 0};
  CHECK(as_text(ig500::frame(ig500::kSetOutputMode, mode)) ==
        std::string_view{"\xFF\x02\x15\x00\x02\x00\x00\x27\xAC\x03", 10});
}

TEST_CASE("IG-500: one that returns another mask than it was told is refused with a remedy") {
  Talk talk{"ig500", {}};
  talk.run(0.0, [](const std::string& answer) {
    if (static_cast<std::uint8_t>(answer.at(2)) != ig500::kReturnMask) return answer;
    const std::vector<std::uint8_t> other{0, 0, 0, 2};
    return std::string{as_text(ig500::frame(ig500::kReturnMask, other))};
  });
  CHECK_FALSE(talk.dialogue->done());
  CHECK(talk.dialogue->failure().find("firmware") != std::string::npos);
}

TEST_CASE("IG-500: one that sends and does not answer is asked again, then told with what to look at") {
  Talk talk{"ig500", {}};
  talk.hears_only(devices::emulate("ig500", devices::emulated_motion(1.7e9, 1.0, {}), {}));
  double now = 0.0;
  int asked = 0;
  while (talk.dialogue->failure().empty() && now < 10.0) {
    now += 0.1;
    if (!talk.dialogue->tick(now).empty()) ++asked;
  }
  CHECK(asked == 4);
  CHECK(now < 2.0);
  CHECK(talk.dialogue->failure().find("does not answer") != std::string::npos);
  CHECK_FALSE(talk.dialogue->tick(now + 5.0).empty());  // the line may have been mended since
}

TEST_CASE("IG-500: silence and rubbish are left to those who watch the line, and asked into again and again") {
  const auto dialogue = make_dialogue("ig500", {});
  CHECK_FALSE(dialogue->begin(0.0).empty());
  CHECK(dialogue->tick(0.1).empty());
  int asked = 0;
  for (int i = 1; i <= 60; ++i) asked += dialogue->tick(0.1 * i).empty() ? 0 : 1;
  CHECK(dialogue->failure().empty());
  CHECK(asked > 12);  // whenever it is switched on, it is configured within half a second
}

TEST_CASE("IG-500: while a refusal is tried anew it stays told, until the instrument agrees or is gone") {
  Talk talk{"ig500", {}};
  talk.run(0.0, refuse);
  CHECK(talk.dialogue->failure().find("did not stop sending") != std::string::npos);
  const std::string again = talk.dialogue->tick(4.0);
  CHECK_FALSE(again.empty());
  CHECK_FALSE(talk.dialogue->failure().empty());
  talk.go_on(again);
  CHECK(talk.dialogue->done());
  CHECK(talk.dialogue->failure().empty());

  Talk gone{"ig500", {}};
  gone.run(0.0, refuse);
  for (int i = 40; i < 80; ++i) (void)gone.dialogue->tick(0.1 * i);
  CHECK(gone.dialogue->failure().empty());
}

TEST_CASE("Water Linked: the version of the protocol is asked, another one refused") {
  Talk talk{"wl_serial", {}};
  talk.run(0.0);
  CHECK(talk.dialogue->failure().empty());
  Talk other{"wl_serial", {}};
  other.run(0.0, [](const std::string&) {
    // crc8 of "wrv,1,9,0", found with the parser's own check value test elsewhere
    const std::string body = "wrv,1,9,0";
    std::string line;
    for (int crc = 0; crc < 256; ++crc) {
      char hex[4];
      std::snprintf(hex, sizeof hex, "%02x", static_cast<unsigned>(crc));
      line += body + "*" + hex + "\r\n";  // one of them is right
    }
    return line;
  });
  CHECK_FALSE(other.dialogue->done());
  CHECK(other.dialogue->failure().find("version 1") != std::string::npos);
}
