#include "common/diagnosis/background_pass.hpp"

#include <utility>

namespace fathom::diagnosis {
namespace {

constexpr std::size_t kBatch = 200;      // samples: waking a thread costs as much as hearing one
constexpr std::size_t kMostWaiting = 8;  // batches: a megabyte

}  // namespace

BackgroundPass::BackgroundPass(std::unique_ptr<LiveScreening> pass)
    : pass_{std::move(pass)}, thread_{[this] { work(); }} {}

BackgroundPass::~BackgroundPass() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock{mutex_};
    abandoned_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundPass::hear(const LiveSample& sample) {
  filling_.push_back(sample);
  if (filling_.size() >= kBatch) hand_over();
}

void BackgroundPass::hand_over() {
  {
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [&] { return waiting_.size() < kMostWaiting || failed_; });
    waiting_.push_back(std::exchange(filling_, {}));
  }
  changed_.notify_all();
  filling_.reserve(kBatch);
}

std::unique_ptr<LiveScreening> BackgroundPass::finish() {
  hand_over();
  {
    const std::lock_guard lock{mutex_};
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
  if (failed_) std::rethrow_exception(failed_);
  return std::move(pass_);
}

void BackgroundPass::work() {
  try {
    while (true) {
      Batch batch;
      {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return !waiting_.empty() || ends_ || abandoned_; });
        if (abandoned_ || waiting_.empty()) return;
        batch = std::move(waiting_.front());
        waiting_.pop_front();
      }
      changed_.notify_all();
      for (const LiveSample& sample : batch) (void)pass_->use(sample, true);
    }
  } catch (...) {
    const std::lock_guard lock{mutex_};
    failed_ = std::current_exception();
  }
  changed_.notify_all();
}

}  // namespace fathom::diagnosis
