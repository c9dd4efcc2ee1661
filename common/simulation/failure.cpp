#include "common/simulation/failure.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace fathom::simulation {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kOrdinaryDelay = 0.5, kOrdinaryJump = -5.0;  // s, when `by` is not said

void spoil(Thrusters& s) { s.tau.fill(kNan); }
void spoil(Battery& s) { s.voltage = kNan; }
void spoil(Loads& s) { s.load.assign(s.load.size(), kNan); }
void spoil(Ahrs& s) {
  s.w_WB_B.setConstant(kNan);
  s.f_B.setConstant(kNan);
}
void spoil(Dvl& s) { s.v_WB_B.setConstant(kNan); }
void spoil(Depth& s) { s.z = kNan; }
void spoil(Usbl& s) { s.p_WB.setConstant(kNan); }
void spoil(Ranges& s) { s.range.assign(s.range.size(), kNan); }
void spoil(PoseCapture& s) { s.p_WB.setConstant(kNan); }
void spoil(TagPose& s) { s.p_CT.setConstant(kNan); }
void spoil(OpticalFlow& s) { s.flow_C.setConstant(kNan); }
void spoil(LaserRange& s) { s.p_CL.setConstant(kNan); }
void spoil(Signal& s) { s.value = kNan; }
void spoil(Exposure& s) { s.p_WC.setConstant(kNan); }
void spoil(Truth&) {}

double number(const std::string& text, const std::string& word) {
  double value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    throw InputError("--fail " + text + ": '" + word + "' is no number of seconds");
  }
  return value;
}

}  // namespace

Failure Failure::parse(const std::string& text) {
  const auto wrong = [&](const std::string& what) -> InputError {
    return InputError("--fail " + text + ": " + what +
                      "; write INSTRUMENT=silent, frozen, nan, delay or jump, and then ,from:S ,to:S ,by:S");
  };
  const auto equals = text.find('=');
  if (equals == std::string::npos) throw wrong("no '='");
  Failure failure{.sensor = text.substr(0, equals)};
  const auto& kinds = sensor_kinds();
  if (std::none_of(kinds.begin(), kinds.end(), [&](const auto& each) { return failure.sensor == each.name; })) {
    throw wrong("no instrument '" + failure.sensor + "'");
  }
  std::size_t at = std::min(text.find(',', equals), text.size());
  const std::string word = text.substr(equals + 1, at - equals - 1);
  constexpr std::array kWords{"silent", "frozen", "nan", "delay", "jump"};
  const auto found = std::find(kWords.begin(), kWords.end(), word);
  if (found == kWords.end()) throw wrong("'" + word + "' is no failure");
  failure.kind = static_cast<Kind>(found - kWords.begin());
  failure.by = failure.kind == Kind::kDelay ? kOrdinaryDelay : kOrdinaryJump;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(',', at + 1), text.size());
    const std::string item = text.substr(at + 1, end - at - 1);
    const auto colon = item.find(':');
    const std::string key = item.substr(0, colon);
    const std::string value = colon == std::string::npos ? "" : item.substr(colon + 1);
    if (key == "from") {
      failure.from = number(text, value);
    } else if (key == "to") {
      failure.to = number(text, value);
    } else if (key == "by") {
      failure.by = number(text, value);
    } else {
      throw wrong("'" + item + "' is not known");
    }
    at = end;
  }
  if (failure.to <= failure.from) throw wrong("it ends before it begins");
  if (failure.kind == Kind::kDelay && failure.by < 0.0) throw wrong("no sample comes before it is taken");
  return failure;
}

void fail(const Failure& failure, Utime utime, std::vector<Sample>& samples, const std::vector<Sample>& held) {
  switch (failure.kind) {
    case Failure::Kind::kSilent:
      samples.clear();
      break;
    case Failure::Kind::kFrozen:
      samples = held;
      for (Sample& sample : samples) std::visit([&](auto& one) { one.utime = utime; }, sample);
      break;
    case Failure::Kind::kNan:
      for (Sample& sample : samples) std::visit([](auto& one) { spoil(one); }, sample);
      break;
    case Failure::Kind::kJump:
      for (Sample& sample : samples) {
        std::visit([&](auto& one) { one.utime = utime_after(one.utime, failure.by); }, sample);
      }
      break;
    case Failure::Kind::kDelay:
      break;  // the same values, delivered later
  }
}

}  // namespace fathom::simulation
