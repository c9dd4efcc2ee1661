#include "common/devices/dialogue.hpp"

#include <array>
#include <utility>
#include <vector>

#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/inertial/sbg_ig500.hpp"
#include "common/devices/text.hpp"
#include "common/devices/velocity/water_linked_serial.hpp"

namespace fathom::devices {
namespace {

constexpr double kPatience = 0.3;  // s for an answer
constexpr int kTries = 5;

std::string frame_text(std::uint8_t command, const std::vector<std::uint8_t>& data) {
  return std::string{as_text(ig500::frame(command, data))};
}

// Sets output mode, mask and continuous mode, and reads each back: the data frames themselves do not say it.
class Ig500Setup final : public Dialogue {
 public:
  explicit Ig500Setup(const Settings& settings) {
    const std::uint32_t mask = settings.output_mask;
    const auto byte = [&](int shift) { return static_cast<std::uint8_t>(mask >> shift & 0xFFU); };
    const std::uint8_t mode = settings.little_endian ? 1 : 0;
    steps_ = {
        Step{ig500::kSetContinuous, {0, 0, 1}, ig500::kAck, {0}, "stop sending"},
        Step{ig500::kSetOutputMode, {0, mode}, ig500::kAck, {0}, "take the output mode"},
        Step{ig500::kGetOutputMode, {}, ig500::kReturnOutputMode, {mode}, "return the output mode"},
        Step{ig500::kSetMask, {0, byte(24), byte(16), byte(8), byte(0)}, ig500::kAck, {0}, "take the output mask"},
        Step{ig500::kGetMask, {}, ig500::kReturnMask, {byte(24), byte(16), byte(8), byte(0)}, "return the mask"},
        Step{ig500::kSetContinuous, {0, 1, 1}, ig500::kAck, {0}, "send continuously"},
        Step{ig500::kGetContinuous, {}, ig500::kReturnContinuous, {1, 1}, "return the continuous mode"}};
  }
  std::string begin(double now) override {
    failure_.clear();
    return start(now);
  }
  std::string hear(const Parser& parser, const Frame&, double now) override {
    const auto* device = dynamic_cast<const SbgIg500*>(&parser);
    heard_ = true;
    if (device == nullptr || done() || gave_up_) return {};
    const Step& step = steps_[at_];
    if (device->command() != step.answer) return {};
    const std::vector<std::uint8_t> data{device->data().begin(), device->data().end()};
    if (data != step.data_wanted) {
      if (step.answer == ig500::kAck && ++tries_ < kTries) return say(now);
      give_up("the IG-500 did not " + std::string{step.what} + " as asked; is its firmware older than 2.1?");
      return {};
    }
    ++at_;
    tries_ = 0;
    if (!done()) return say(now);
    failure_.clear();
    return {};
  }
  std::string tick(double now) override {
    if (done() || now - said_ < (gave_up_ ? 10.0 * kPatience : kPatience)) return {};
    if (gave_up_) return start(now);  // it may have been restarted or exchanged
    if (++tries_ < kTries) return say(now);
    if (!heard_) return begin(now);  // silence and rubbish are of the line, and said by who watches it
    give_up("the IG-500 does not answer (asked it to " + std::string{steps_[at_].what} +
            "); is the line to it connected, not only the one from it?");
    return {};
  }
  bool done() const override { return at_ == steps_.size(); }
  std::string failure() const override { return failure_; }

 private:
  struct Step {
    std::uint8_t command;
    std::vector<std::uint8_t> data;
    std::uint8_t answer;
    std::vector<std::uint8_t> data_wanted;
    std::string_view what;
  };
  // A failure stays told until another attempt has come to its end.
  std::string start(double now) {
    at_ = 0;
    tries_ = 0;
    gave_up_ = heard_ = false;
    return say(now);
  }
  void give_up(std::string why) {
    failure_ = std::move(why);
    gave_up_ = true;
  }
  std::string say(double now) {
    said_ = now;
    return frame_text(steps_[at_].command, steps_[at_].data);
  }
  std::vector<Step> steps_;
  std::size_t at_{};
  int tries_{};
  bool gave_up_{false}, heard_{false};  ///< anything at all in this attempt
  double said_{};
  std::string failure_;
};

// Asks for the version of the protocol; 2 is the one that the parser speaks.
class WaterLinkedVersion final : public Dialogue {
 public:
  std::string begin(double now) override {
    done_ = false;
    failure_.clear();
    said_ = now;
    const std::string_view body = "wcv";
    return std::string{body} + detail::format("*%02x\n", static_cast<unsigned>(crc8(as_bytes(body))));
  }
  std::string hear(const Parser&, const Frame& frame, double) override {
    const std::string_view text = as_text(frame.bytes);
    if (!text.starts_with("wrv,")) return {};
    const Words words{text.substr(0, text.rfind('*')), ','};
    done_ = words[1] == "2";
    if (!done_) {
      failure_ = "the instrument speaks version " + std::string{words[1].substr(0, 8)} +
                 " of its protocol, not 2; its firmware must be brought up to date";
    }
    return {};
  }
  std::string tick(double now) override { return done_ || now - said_ < 1.0 ? std::string{} : begin_again(now); }
  bool done() const override { return done_ || failure_.empty(); }  // it speaks by itself; only a wrong answer stops it
  std::string failure() const override { return failure_; }

 private:
  std::string begin_again(double now) {
    const std::string kept = failure_;
    std::string text = begin(now);
    failure_ = kept;
    return text;
  }
  bool done_{false};
  double said_{};
  std::string failure_;
};

}  // namespace

std::unique_ptr<Dialogue> make_dialogue(std::string_view protocol, const Settings& settings) {
  if (protocol == "ig500") return std::make_unique<Ig500Setup>(settings);
  if (protocol == "wl_serial") return std::make_unique<WaterLinkedVersion>();
  return nullptr;
}

}  // namespace fathom::devices
