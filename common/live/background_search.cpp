#include "common/live/background_search.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <stop_token>

namespace fathom::live {
namespace {

using std::chrono::milliseconds;

constexpr int kBelow = 10;             // of nice: the estimator's and the supervisor's deadlines come first
constexpr milliseconds kAskAgain{50};  // whether to go on

struct Abandoned {};

/// Of this thread and of those that it starts.
void step_back() { (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kBelow); }

}  // namespace

BackgroundSearch::BackgroundSearch(Work work, Priority priority) {
  std::promise<Found> promise;
  found_ = promise.get_future();
  thread_ = std::jthread{
      [work = std::move(work), promise = std::move(promise), priority](const std::stop_token& stop) mutable {
        if (priority == Priority::kBelow) step_back();
        const Progress progress{[&stop](const Progress::Event&) {
          if (stop.stop_requested()) throw Abandoned{};
        }};
        try {
          promise.set_value(work(progress));
        } catch (...) {
          promise.set_exception(std::current_exception());
        }
      }};
}

bool BackgroundSearch::ready() const { return found_.wait_for(milliseconds{0}) == std::future_status::ready; }

std::optional<Found> BackgroundSearch::wait(const std::function<bool()>& go_on) {
  while (found_.wait_for(kAskAgain) != std::future_status::ready) {
    if (!go_on()) return {};
  }
  return found_.get();
}

}  // namespace fathom::live
