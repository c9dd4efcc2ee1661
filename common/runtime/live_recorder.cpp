#include "common/runtime/live_recorder.hpp"

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <fathom_lcm/health_t.hpp>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>

#include "common/base/error.hpp"
#include "common/runtime/disk_room.hpp"
#include "common/runtime/record_file.hpp"
#include "common/runtime/speakers.hpp"
#include "common/runtime/stop_signal.hpp"

namespace fathom::runtime {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWaitMs = 50;
constexpr std::chrono::milliseconds kKeepPeriod{200};  // what a loss of power may cost
constexpr std::chrono::seconds kLookPeriod{1};         // at the room that is left
constexpr std::chrono::seconds kTryAgain{3};           // after a failure: a full disk is not full for ever

double seconds(Clock::time_point when) { return std::chrono::duration<double>(when.time_since_epoch()).count(); }

/// The log of a live bus: numbered ones go on with the next number when a disk is full and has room again.
class LiveLog {
 public:
  LiveLog(std::string path, bool number) : path_{std::move(path)}, number_{number} { open(); }

  void write(const LiveInput::Message& message, std::span<std::uint8_t> bytes) {
    if (!file_) {
      ++lost_;
      return;
    }
    const bool whole = guard([&] { file_->write(message.channel, bytes, message.received); });
    ++(whole ? written_ : lost_);
  }
  /// What is due: to the disk, look at the room, try again.
  void tick() {
    const auto now = Clock::now();
    if (now - looked_ >= kLookPeriod) look(now);
    if (!file_ && now - failed_at_ >= kTryAgain && room_.trouble().empty()) guard([&] { open(); });
    if (!file_ || now - kept_ < kKeepPeriod) return;
    kept_ = now;
    guard([&] {
      const bool something = file_->size() > 0;
      file_->keep();
      if (something) failure_.clear();
    });
  }
  void end() {
    if (!file_) return;
    guard([&] { file_->keep(); });
    if (file_) file_->end();
  }
  /// Why a trial is not, or soon will not be, recorded; empty when all is well.
  [[nodiscard]] std::string trouble() const { return failure_.empty() ? room_.trouble() : failure_; }
  [[nodiscard]] std::string text() const { return std::to_string(written_) + " messages written, " + room_.text(); }
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t written() const { return written_; }

 private:
  void open() {
    file_.emplace(number_ ? next_numbered(path_) : path_);
    look(Clock::now());
  }
  void look(Clock::time_point now) {
    looked_ = now;
    const std::filesystem::path file{path_};
    std::error_code none;
    const auto space = std::filesystem::space(file.has_parent_path() ? file.parent_path() : ".", none);
    if (!none) room_.measure(before_ + (file_ ? file_->size() : 0), space.available, seconds(now));
  }
  template <class Work>
  bool guard(Work work) {
    try {
      work();
      return true;
    } catch (const InputError& error) {
      failure_ = error.what();
      failed_at_ = Clock::now();
      if (file_) before_ += file_->size();
      file_.reset();  // what is whole stays
      if (!number_) throw;
      return false;
    }
  }

  std::string path_;
  bool number_;
  std::optional<RecordFile> file_;
  DiskRoom room_;
  std::uint64_t before_{};  // B, in files that are closed
  std::int64_t written_{}, lost_{};
  std::string failure_;
  Clock::time_point kept_{Clock::now()}, looked_{}, failed_at_{};
};

}  // namespace

RecorderHealth::RecorderHealth(Output& bus) : bus_{bus} { (void)usage_.measure(); }

void RecorderHealth::tell(const std::string& trouble, const std::string& text, std::int64_t lost) {
  const auto now = Clock::now();
  const bool changed = trouble.empty() != well_;
  if (!changed && now - last_ < std::chrono::seconds{1}) return;
  last_ = now;
  well_ = trouble.empty();
  lost_ = lost;
  say_health(well_ ? "running" : "unhealthy", well_ ? text : trouble + "; " + text);
}

void RecorderHealth::end(const std::string& state, const std::string& reason) { say_health(state, reason); }

void RecorderHealth::say_health(const std::string& state, const std::string& detail) {
  using std::chrono::duration_cast;
  fathom_lcm::health_t health{};
  const Usage::Figures used = usage_.measure();
  health.utime = duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  health.process = "recorder";
  health.host = host_name();
  health.pid = getpid();
  health.start = process_start(getpid()).value_or(0);
  health.sequence = ++words_;
  health.state = state;
  health.received = received_;
  health.dropped = lost_;
  health.cpu = used.cpu;
  health.memory = used.memory;
  health.detail = detail;
  say(bus_, "HEALTH", health);
}

void record_live(const std::vector<Url>& in, const Url& out, const std::string& path, bool number,
                 const std::vector<std::string>& without) {
  StopSignal stop;
  LiveLog log{path, number};
  Output bus{out};
  LiveInput live{in, {{".*", std::numeric_limits<std::size_t>::max()}}};
  RecorderHealth health{bus};
  const auto write = [&] {
    while (auto message = live.next()) {
      health.heard();
      if (message->channel == "LCM_SELF_TEST" || std::ranges::find(without, message->channel) != without.end())
        continue;
      log.write(*message, message->bytes);
    }
  };
  try {
    while (!stop.raised()) {
      live.wait(stop.descriptor(), kWaitMs);
      write();
      log.tick();
      health.tell(log.trouble(), log.text(), log.lost());
    }
    write();
    log.end();
  } catch (const std::exception& error) {  // a full disk: who watches shall know at once
    health.end("fault", error.what());
    throw;
  }
  const std::string failure = log.trouble();
  health.end("stopped", (failure.empty() ? "" : failure + "; ") + log.text());
}

}  // namespace fathom::runtime
