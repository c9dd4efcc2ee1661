#include "processes/supervisor/strangers.hpp"

#include <algorithm>
#include <iterator>

#include "common/base/printable.hpp"

namespace fathom::supervisor {
namespace {

Signature signature_in(const fathom_lcm::wrench_command_t& message) {
  Signature signature{};
  std::copy(std::begin(message.signature), std::end(message.signature), signature.begin());
  return signature;
}

}  // namespace

void Strangers::sent(const fathom_lcm::wrench_command_t& message) {
  sent_[next_] = signature_in(message);
  waiting_[next_] = true;
  next_ = (next_ + 1) % kRemembered;
}

bool Strangers::heard(const fathom_lcm::wrench_command_t& message) {
  constexpr std::int64_t kTellAgain = 1000;  // commands of a stranger
  constexpr std::size_t kLongest = 40;       // characters of a name
  const auto found = std::find(sent_.begin(), sent_.end(), signature_in(message));
  const auto index = static_cast<std::size_t>(found - sent_.begin());
  if (found != sent_.end() && waiting_[index]) {
    waiting_[index] = false;
    return false;
  }
  ++count_;
  last_ = printable(message.commander, kLongest);
  if (count_ > 1 && count_ - told_at_ < kTellAgain) return false;
  told_at_ = count_;
  return true;
}

std::string Strangers::told() const {
  if (count_ == 0) return {};
  const bool copied = last_ == commander_;
  return std::to_string(count_) + " commands that I did not send, the last in " +
         (copied ? "my own name: somebody copies them" : "the name of '" + last_ + "'") +
         "; see who else is on this bus";
}

}  // namespace fathom::supervisor
