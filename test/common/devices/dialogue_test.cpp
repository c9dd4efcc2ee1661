// Configuring an instrument: set, read back, refuse on a mismatch, repeat what was not answered.
#include "common/devices/dialogue.hpp"

#include <doctest/doctest.h>

#include "common/devices/protocols.hpp"
#include "common/devices/sbg_ig500.hpp"

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
    for (std::string said = dialogue->begin(now); !said.empty();) {
      said_.clear();
      std::string answer = device.hear(said);
      if (alter) answer = alter(answer);
      parser_->feed(as_bytes(answer), *this);
      said = said_;
    }
  }
  void frame(const Parser& parser, const Frame& frame) override { said_ += dialogue->hear(parser, frame, 0.0); }

 private:
  std::unique_ptr<Parser> parser_;
  std::string said_;

 public:
  std::unique_ptr<Dialogue> dialogue;
  EmulatedAnswers device;
};

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

TEST_CASE("IG-500: silence is asked again, then said") {
  const auto dialogue = make_dialogue("ig500", {});
  CHECK_FALSE(dialogue->begin(0.0).empty());
  CHECK(dialogue->tick(0.1).empty());
  double now = 0.0;
  int asked = 0;
  while (dialogue->failure().empty() && now < 10.0) {
    now += 0.1;
    if (!dialogue->tick(now).empty()) ++asked;
  }
  CHECK(asked == 4);
  CHECK(now < 2.0);
  CHECK(dialogue->failure().find("does not answer") != std::string::npos);
  CHECK_FALSE(dialogue->tick(now + 5.0).empty());  // it may have been switched on since
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
