#include "common/launch/output_limit.hpp"

#include <algorithm>

namespace fathom::launch {

void OutputLimit::add(const std::string& id, std::string_view text, double now) {
  Tap& tap = taps_[id];
  tap.allowance = std::min(kBurst, tap.allowance + kRate * std::max(0.0, now - tap.filled));
  tap.filled = now;
  // After a loss nothing passes until there is room for more than a note about it.
  const bool closed = tap.lost > 0 && tap.allowance < kReopen;
  const std::size_t passes = closed ? 0 : std::min(text.size(), static_cast<std::size_t>(tap.allowance));
  if (passes > 0 && tap.lost > 0) {
    const std::string note = "\r\n[" + std::to_string(tap.lost) + " bytes of output not told]\r\n";
    tap.text += note;
    waiting_ += note.size();
    tap.lost = 0;
  }
  tap.text += text.substr(0, passes);
  tap.allowance -= static_cast<double>(passes);
  tap.lost += text.size() - passes;
  waiting_ += passes;
}

std::vector<LaunchOutput::Text> OutputLimit::take(double now) {
  std::vector<LaunchOutput::Text> texts;
  if (waiting_ == 0 || (waiting_ < kEnough && now - last_ < kWait)) return texts;
  for (auto& [id, tap] : taps_) {
    if (tap.text.empty()) continue;
    texts.push_back({id, std::move(tap.text)});
    tap.text.clear();
  }
  waiting_ = 0;
  last_ = now;
  return texts;
}

}  // namespace fathom::launch
