// A pass of the live regression that is still behind, on a thread of its own: it hears old samples while the trial goes
// on. What it is told, and when it is asked for its result, follows from messages alone, so that no bit depends on how
// quick the thread is.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "common/diagnosis/live_screening.hpp"

namespace fathom::diagnosis {

class BackgroundPass {
 public:
  explicit BackgroundPass(std::unique_ptr<LiveScreening> pass);
  BackgroundPass(const BackgroundPass&) = delete;
  BackgroundPass& operator=(const BackgroundPass&) = delete;
  /// What it has not heard yet it never will.
  ~BackgroundPass();

  /// The next sample. Waits when the pass is some thousand samples behind.
  void hear(const LiveSample& sample);
  /// The pass, with all that it was told; nothing is to be told after that. Throws what the pass has thrown.
  [[nodiscard]] std::unique_ptr<LiveScreening> finish();

 private:
  using Batch = std::vector<LiveSample>;
  void hand_over();
  void work();

  std::unique_ptr<LiveScreening> pass_;
  Batch filling_;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Batch> waiting_;
  bool ends_{false}, abandoned_{false};
  std::exception_ptr failed_;
  std::thread thread_;
};

}  // namespace fathom::diagnosis
