// The instrument's side of the dialogues, for emulators.
#include <algorithm>
#include <cmath>

#include "common/devices/checksum.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/inertial/sbg_ig500.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr double kNeutral = 1500.0;   // us
constexpr double kRigPatience = 0.5;  // s without a command
constexpr double kStickTime = 3.0;    // s without an override: RC_OVERRIDE_TIME of ArduSub as it comes
constexpr double kThrow = 400.0;      // us from the middle to a full stick

std::string reply(std::uint8_t command, const std::vector<std::uint8_t>& data) {
  return std::string{as_text(ig500::frame(command, data))};
}

}  // namespace

EmulatedAnswers::EmulatedAnswers(std::string_view protocol)
    : protocol_{protocol}, sends_{protocol != "ig500"}, applied_(8, kNeutral) {
  if (protocol == "mavlink") commands_ = std::make_unique<Mavlink>(Settings{});
}

void EmulatedAnswers::at(double now) {
  now_ = now;
  overridden_ = overridden_ && now_ - overridden_at_ <= kStickTime;
  if (now_ - commanded_ <= kRigPatience) return;
  std::fill(applied_.begin(), applied_.end(), kNeutral);
  std::fill(applied_force_.begin(), applied_force_.end(), 0.0);
}

void EmulatedAnswers::hear_rig(std::string_view line) {
  const std::size_t star = line.find('*');
  const bool forces = line.starts_with("$FTFRC,");
  if ((!forces && !line.starts_with("$FTPWM,")) || star == std::string_view::npos) return;
  if (hex_byte(line.substr(star + 1, 2)) != xor8(as_bytes(line.substr(1, star - 1)))) return;
  const Words words{line.substr(0, star), ','};
  std::vector<double>& applied = forces ? applied_force_ : applied_;
  const double neutral = forces ? 0.0 : kNeutral;
  applied.assign(words.size() - 1, neutral);
  for (std::size_t i = 0; i < applied.size(); ++i) applied[i] = words.number_at(i + 1).value_or(neutral);
  commanded_ = now_;
}

// An ArduSub: motor tests are run and acknowledged, the pilot's sticks are kept for who allocates.
std::string EmulatedAnswers::hear_mavlink(std::string_view bytes) {
  class Commands final : public Output {
   public:
    explicit Commands(EmulatedAnswers& vehicle) : vehicle_{vehicle} {}
    void frame(const Parser& parser, const Frame&) override {
      constexpr std::uint32_t kCommandLong = 76, kRcOverride = 70;
      constexpr std::uint16_t kDoMotorTest = 209;
      constexpr std::uint8_t kFailed = 4;
      const auto& mavlink = dynamic_cast<const Mavlink&>(parser);
      if (mavlink.id() == kCommandLong && mavlink.value(7) == kDoMotorTest) {
        answers += writer_.command_ack(kDoMotorTest, run(mavlink.value(0), mavlink.value(2)) ? 0 : kFailed);
      }
      if (mavlink.id() == kRcOverride) move_sticks(mavlink);
    }
    std::string answers;

   private:
    bool run(double motor, double pwm) {
      if (!vehicle_.vehicle_.armed) {  // in ArduSub's words
        vehicle_.vehicle_.words.push_back({.severity = 4, .text = "Arm motors before testing motors.", .age = 0.0});
        return false;
      }
      if (!(motor >= 0.0 && motor < static_cast<double>(vehicle_.applied_.size()))) return false;
      vehicle_.applied_[static_cast<std::size_t>(motor)] = std::round(pwm);  // outputs are whole microseconds
      vehicle_.commanded_ = vehicle_.now_;
      return true;
    }
    void move_sticks(const Mavlink& mavlink) {
      constexpr double kAlone = 65535.0;
      for (std::size_t i = 0; i < vehicle_.sticks_.size(); ++i) {
        const double pwm = mavlink.value(i);
        if (pwm != kAlone) vehicle_.sticks_[i] = std::clamp((pwm - kNeutral) / kThrow, -1.0, 1.0);
      }
      vehicle_.overridden_ = true;
      vehicle_.overridden_at_ = vehicle_.now_;
    }
    EmulatedAnswers& vehicle_;
    mavlink::Writer writer_{1, 1};
  } commands{*this};
  commands_->feed(as_bytes(bytes), commands);
  return commands.answers;
}

std::string EmulatedAnswers::hear(std::string_view bytes) {
  if (protocol_ == "mavlink") return hear_mavlink(bytes);
  constexpr std::size_t kMostWaiting = 4096;
  waiting_ += bytes;
  if (waiting_.size() > kMostWaiting) waiting_.clear();
  std::string answers;
  if (protocol_ == "ig500") {
    while (true) {
      const std::size_t begin = waiting_.find("\xFF\x02");
      if (begin == std::string::npos) return answers;
      waiting_.erase(0, begin);
      if (waiting_.size() < 8) return answers;
      const std::size_t size = big<std::uint16_t>(as_bytes(waiting_), 3) + std::size_t{8};
      if (waiting_.size() < size) return answers;
      answers += answer_ig500(as_bytes(waiting_).first(size));
      waiting_.erase(0, size);
    }
  }
  if (protocol_ == "wl_serial") {
    for (std::size_t end = waiting_.find('\n'); end != std::string::npos; end = waiting_.find('\n')) {
      answers += answer_water_linked(waiting_.substr(0, end));
      waiting_.erase(0, end + 1);
    }
    return answers;
  }
  for (std::size_t end = waiting_.find('\n'); protocol_ == "thruster_text" && end != std::string::npos;
       end = waiting_.find('\n')) {
    hear_rig(std::string_view{waiting_}.substr(0, end));
    waiting_.erase(0, end + 1);
  }
  if (protocol_ != "thruster_text") waiting_.clear();
  return answers;
}

std::string EmulatedAnswers::answer_ig500(Bytes frame) {
  const std::size_t size = frame.size() - 8;
  if (crc16_reflected(frame.subspan(2, size + 3), 0) != big<std::uint16_t>(frame, size + 5)) {
    return reply(ig500::kAck, {3});
  }
  const Bytes data = frame.subspan(5, size);
  switch (frame[2]) {
    case ig500::kSetOutputMode:
      if (size != 2) break;
      output_mode_ = data[1];
      return reply(ig500::kAck, {0});
    case ig500::kGetOutputMode:
      return reply(ig500::kReturnOutputMode, {output_mode_});
    case ig500::kSetMask:
      if (size != 5) break;
      mask_ = big<std::uint32_t>(data, 1);
      return reply(ig500::kAck, {0});
    case ig500::kGetMask:
      return reply(ig500::kReturnMask, {static_cast<std::uint8_t>(mask_ >> 24), static_cast<std::uint8_t>(mask_ >> 16),
                                        static_cast<std::uint8_t>(mask_ >> 8), static_cast<std::uint8_t>(mask_)});
    case ig500::kSetContinuous:
      if (size != 3) break;
      continuous_ = data[1];
      divider_ = data[2];
      sends_ = continuous_ == 1;
      return reply(ig500::kAck, {0});
    case ig500::kGetContinuous:
      return reply(ig500::kReturnContinuous, {continuous_, divider_});
    default:
      break;
  }
  return reply(ig500::kAck, {9});
}

std::string EmulatedAnswers::answer_water_linked(std::string_view line) {
  const std::string body = line.starts_with("wcv") ? "wrv,2,4,0" : "wr?";
  return body + detail::format("*%02x\r\n", static_cast<unsigned>(crc8(as_bytes(body))));
}

}  // namespace fathom::devices
