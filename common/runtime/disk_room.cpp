#include "common/runtime/disk_room.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fathom::runtime {
namespace {

std::string amount(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 1e9 ? "%.1f MB" : "%.1f GB", bytes < 1e9 ? 1e-6 * bytes : 1e-9 * bytes);
  return text;
}

std::string duration(double seconds) {
  char text[32];
  constexpr double kMinutes = 120.0, kHours = 7200.0;
  if (seconds < kMinutes) {
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  } else if (seconds < kHours) {
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60.0);
  } else {
    std::snprintf(text, sizeof text, "%.0f h", seconds / 3600.0);
  }
  return text;
}

}  // namespace

void DiskRoom::measure(std::uint64_t written, std::uint64_t available, double now) {
  if (last_ && now > *last_) {
    const double dt = now - *last_;
    const double latest = static_cast<double>(written - written_) / dt;
    // As a mean of all so far in the beginning, then a low pass.
    const double share = std::max(-std::expm1(-dt / limits_.time_constant), dt / (now - *first_));
    rate_ += share * (latest - rate_);
  }
  if (!first_) first_ = now;
  last_ = now;
  written_ = written;
  available_ = available;
}

std::optional<double> DiskRoom::time_left() const {
  constexpr double kNothing = 1.0;  // B/s
  if (rate_ < kNothing) return {};
  return static_cast<double>(available_) / rate_;
}

std::string DiskRoom::text() const {
  const auto left = time_left();
  return amount(static_cast<double>(available_)) + " free" +
         (left ? ", full in " + duration(*left) + " at " + amount(rate_) + "/s" : "");
}

std::string DiskRoom::trouble() const {
  if (!last_) return {};
  const auto left = time_left();
  const bool short_of_time = left && *left < limits_.least_time;
  if (available_ >= limits_.least_free && !short_of_time) return {};
  return "the disk is nearly full: " + text() + ", where " + amount(static_cast<double>(limits_.least_free)) + " and " +
         duration(limits_.least_time) + " are wanted; make room";
}

}  // namespace fathom::runtime
