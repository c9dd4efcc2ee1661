#include "common/driver/watch.hpp"

#include <algorithm>

namespace fathom::driver {
namespace {

constexpr double kLate = 1.5;           // periods between two samples that make a gap
constexpr double kLongestWait = 0.7;    // s: with kSlack silence is said within a second
constexpr double kSlack = 0.25;         // s that a line and an operating system may take
constexpr std::uint64_t kRubbish = 64;  // bytes without a frame that are more than a cut-off one

}  // namespace

double Watch::patience() const { return period_ + std::min((kLate - 1.0) * period_, kLongestWait) + kSlack; }

void Watch::link(bool up, const std::string& why, double now) {
  up_ = up;
  well_ = false;
  if (!up) why_ = why;
  if (up && why_ == kNotYet) why_.clear();  // opened at once
  up_since_ = last_bytes_ = last_frame_ = last_sample_ = now;
  bytes_since_frame_ = 0;
  last_utime_.reset();
}

void Watch::bytes(std::size_t count, double now) {
  last_bytes_ = now;
  bytes_since_frame_ += count;
}

void Watch::frame(double now) {
  last_frame_ = now;
  bytes_since_frame_ = 0;
}

void Watch::sample(Utime utime, double now) {
  if (last_utime_ && seconds_between(*last_utime_, utime) > kLate * period_) ++gaps_;
  last_utime_ = utime;
  last_sample_ = now;
  well_ = true;
}

std::string Watch::unhealthy(double now, const std::string& failure, const std::string& complaint) const {
  if (!up_) return why_;
  if (!failure.empty()) return failure;
  if (now - last_sample_ <= patience()) return well_ ? "" : why_;
  if (now - last_bytes_ > patience()) {
    return "silent: nothing comes; is the instrument on and its line connected?";
  }
  if (bytes_since_frame_ > kRubbish && now - last_frame_ > patience()) {
    return "rubbish only: " + std::to_string(bytes_since_frame_) + " bytes without a whole frame of " + protocol_ +
           "; is the baud rate right, and is this its protocol?" + (complaint.empty() ? "" : " (" + complaint + ")");
  }
  if (now - last_frame_ > patience()) return "silent: no whole frame of " + protocol_ + " any more";
  return "frames of " + protocol_ + " come, but none with a measurement" +
         (complaint.empty() ? "; is the output that the driver needs switched on?" : ": " + complaint);
}

}  // namespace fathom::driver
