#include "common/vision/jpeg_stream.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace fathom::vision {
namespace {

constexpr std::uint8_t kMark = 0xff, kBegin = 0xd8, kEnd = 0xd9, kScan = 0xda;
constexpr std::array<std::uint8_t, 3> kHead{kMark, kBegin, kMark};

bool restarts(std::uint8_t marker) { return marker >= 0xd0 && marker <= 0xd7; }

}  // namespace

void JpegStream::restart() {
  if (std::exchange(begun_, false)) ++torn_;
  waiting_.clear();
}

// Drops what is before the next picture; a head may be cut in two.
bool JpegStream::find_begin() {
  const auto head = std::search(waiting_.begin(), waiting_.end(), kHead.begin(), kHead.end());
  begun_ = head != waiting_.end();
  const auto keep = begun_ ? head : waiting_.end() - std::min<std::ptrdiff_t>(2, std::ssize(waiting_));
  waiting_.erase(waiting_.begin(), keep);
  at_ = 2;
  in_scan_ = false;
  return begun_;
}

// From marker to marker: a thumbnail inside of a segment has an end of its own, which is not the picture's.
JpegStream::Step JpegStream::step() {
  while (waiting_.size() >= at_ + 2) {
    const std::uint8_t marker = waiting_[at_ + 1];
    if (in_scan_) {
      if (waiting_[at_] != kMark) {
        const auto from = waiting_.begin() + static_cast<std::ptrdiff_t>(at_);
        at_ = static_cast<std::size_t>(std::find(from, waiting_.end(), kMark) - waiting_.begin());
      } else if (marker == 0 || restarts(marker)) {
        at_ += 2;
      } else if (marker == kMark) {
        ++at_;
      } else {
        in_scan_ = false;
      }
      continue;
    }
    if (waiting_[at_] != kMark) return Step::kTorn;
    if (marker == kMark) {
      ++at_;
      continue;
    }
    if (marker == kEnd) {
      at_ += 2;
      return Step::kDone;
    }
    if (marker == kBegin || marker == 0 || restarts(marker)) return Step::kTorn;
    if (waiting_.size() < at_ + 4) return Step::kMore;
    const std::size_t length = 256U * waiting_[at_ + 2] + waiting_[at_ + 3];
    if (length < 2) return Step::kTorn;
    if (waiting_.size() < at_ + 2 + length) return Step::kMore;
    at_ += 2 + length;
    in_scan_ = marker == kScan;
  }
  return Step::kMore;
}

void JpegStream::feed(std::span<const std::uint8_t> bytes, const Picture& picture) {
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  while (begun_ || find_begin()) {
    Step found = step();
    if (found == Step::kMore && waiting_.size() > kLargest) found = Step::kTorn;
    if (found == Step::kMore) return;
    begun_ = false;
    if (found == Step::kTorn) {
      ++torn_;
      waiting_.erase(waiting_.begin());  // the next one may begin anywhere behind
      continue;
    }
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(at_);
    std::vector<std::uint8_t> whole{waiting_.begin(), end};
    waiting_.erase(waiting_.begin(), end);
    picture(std::move(whole));
  }
}

}  // namespace fathom::vision
