// usage: fathom_live_trials SITE VEHICLE paper|optimal FIRST LAST [--joint] [--diagnose] [--at S,S,...] [--pipeline OLD
// NEW]
// [--simulation OLD NEW] [--hide EFFECT] [--limit S] [--text]
// Live trials in one process, as docs/live.md states them: settled, intervals that hold, and for every parameter the
// error, in percent and in its own standard deviations. --joint: with the joint estimate. --diagnose: with the live
// diagnoser, so that effects are adopted; --text tells its rankings. --at: after so many seconds
// since arming, how large errors are, in percent and in standard deviations, and what the numbers foretell of the
// wrench. --pipeline replaces a text of config/pipelines/SITE.yaml, --simulation one of config/simulation/VEHICLE.yaml:
// which error of an instrument makes which error of the model.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "common/base/error.hpp"
#include "test/common/excitation/tank_run.hpp"
#include "test/support/full_trial.hpp"

namespace {

using fathom::test::FullTrial;

struct Sum {
  std::string name;
  double error{}, square{}, z{}, z_square{}, largest_z{}, sigma{};  // relative; in standard deviations
  int within{}, inside{};
};

void print(const std::vector<FullTrial>& trials) {
  std::vector<Sum> sums;
  double ended = 0.0, inside = 0.0, all = 0.0;
  int settled = 0, contacts = 0, with_state = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();  // mean squares over stated
  for (const FullTrial& trial : trials) {
    ended += trial.ended / static_cast<double>(trials.size());
    const bool done = trial.phase == fathom::excitation::Phase::kDone;
    settled += done && std::ranges::all_of(trial.visits, [](const auto& v) { return v.left; }) ? 1 : 0;
    if (trial.position.allFinite()) {  // else there was no valid STATE
      position += trial.nees_position;
      velocity += trial.nees_velocity;
      ++with_state;
    }
    contacts += trial.contacts.walls + trial.contacts.floor + trial.contacts.surface;
    sums.resize(trial.learnt.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const auto& p = trial.learnt[i];
      Sum& s = sums[i];
      const double error = p.truth == 0.0 ? 0.0 : 100.0 * (p.value / p.truth - 1.0), z = (p.value - p.truth) / p.std;
      s.name = p.name;
      s.error += error;
      s.square += error * error;
      s.z += z;
      s.z_square += z * z;
      s.largest_z = std::max(s.largest_z, std::abs(z));
      s.sigma += p.truth == 0.0 ? 0.0 : 100.0 * p.std / std::abs(p.truth);
      s.within += std::abs(error) < 5.0 ? 1 : 0;
      s.inside += std::abs(z) < 1.96 ? 1 : 0;
      inside += std::abs(z) < 1.96 ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  const auto n = static_cast<double>(trials.size());
  std::printf("%d of %zu settled, ended after %.0f s, %d contacts, %.0f of %.0f intervals hold (%.1f %%)\n", settled,
              trials.size(), ended, contacts, inside, all, 100.0 * inside / all);
  position /= std::max(1, with_state);
  velocity /= std::max(1, with_state);
  std::printf("STATE's errors, mean square over the stated one: x y z %.2f %.2f %.2f, u v w %.2f %.2f %.2f\n",
              position.x(), position.y(), position.z(), velocity.x(), velocity.y(), velocity.z());
  std::printf("%-8s %10s %8s %9s | in standard deviations: %6s %6s %8s | %s\n", "", "mean error", "rms", "stated",
              "mean", "rms", "largest", "within 5 %, inside");
  for (const Sum& s : sums) {
    std::printf("%-8s %9.2f%% %7.2f%% %8.2f%% | %30.2f %6.2f %8.2f | %d %d\n", s.name.c_str(), s.error / n,
                std::sqrt(s.square / n), s.sigma / n, s.z / n, std::sqrt(s.z_square / n), s.largest_z, s.within,
                s.inside);
  }
}

/// Over time: are the ten well revealed parameters within 5 %, what do the numbers foretell, do the intervals hold.
void print_progress(const std::vector<FullTrial>& trials, const std::vector<double>& when) {
  std::printf("%6s %7s %8s %8s %8s %8s %8s %8s %9s\n", "s", "trials", "worst %", "all<5 %", "force %", "largest",
              "moment %", "largest", "intervals");
  for (std::size_t k = 0; k < when.size(); ++k) {
    double worst = 0.0, force = 0.0, moment = 0.0, most_force = 0.0, most_moment = 0.0, inside = 0.0, all = 0.0;
    double n = 0.0, nees = 0.0;
    int good = 0;
    std::vector<double> squares, z, z_squares;  // of each parameter: relative errors, errors over stated deviations
    for (const FullTrial& trial : trials) {
      if (trial.progress.size() <= k) continue;
      const auto& now = trial.progress[k];
      double largest = 0.0;
      for (auto* each : {&squares, &z, &z_squares}) each->resize(now.learnt.size());
      for (std::size_t i = 0; i < now.learnt.size(); ++i) {
        const auto& p = now.learnt[i];
        const double error = p.truth == 0.0 ? 0.0 : 100.0 * std::abs(p.value / p.truth - 1.0);
        squares[i] += error * error;
        const double over = (p.value - p.truth) / p.std;
        z[i] += over;
        z_squares[i] += over * over;
        inside += std::abs(p.value - p.truth) < 1.96 * p.std ? 1.0 : 0.0;
        all += 1.0;
        if (fathom::test::revealed(p.name)) largest = std::max(largest, error);
      }
      n += 1.0;
      nees += now.nees;
      worst = std::max(worst, largest);
      good += largest < 5.0 ? 1 : 0;
      force += now.force * now.force;
      moment += now.moment * now.moment;
      most_force = std::max(most_force, now.force);
      most_moment = std::max(most_moment, now.moment);
    }
    std::printf("%6.0f %7.0f %8.2f %8d %8.3f %8.3f %8.3f %8.3f %8.1f%%  NEES %.1f  rms %%:", when[k], n, worst, good,
                100.0 * std::sqrt(force / n), 100.0 * most_force, 100.0 * std::sqrt(moment / n), 100.0 * most_moment,
                100.0 * inside / all, nees / n);
    for (const double square : squares) std::printf(" %.2f", std::sqrt(square / n));
    std::printf("\n%6s in standard deviations, mean (rms):", "");
    for (std::size_t i = 0; i < z.size(); ++i) std::printf(" %.2f (%.2f)", z[i] / n, std::sqrt(z_squares[i] / n));
    std::printf("\n");
  }
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  std::istringstream stream{text};
  for (std::string each; std::getline(stream, each, ',');) values.push_back(std::stod(each));
  return values;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 5) {
    std::fputs(
        "usage: fathom_live_trials SITE VEHICLE paper|optimal FIRST LAST [--joint] [--diagnose] [--at S,S,...] "
        "[--pipeline OLD NEW] "
        "[--simulation OLD NEW] [--hide EFFECT] [--limit S] [--text]\n",
        stderr);
    return 1;
  }
  try {
    fathom::test::FullTrialOptions options{.optimal = words[2] == "optimal", .site = words[0], .vehicle = words[1]};
    const int first = std::stoi(words[3]), last = std::stoi(words[4]);
    bool text = false;
    for (std::size_t i = 5; i < words.size(); ++i) {
      if (words[i] == "--text") text = true;
      if (words[i] == "--joint") options.joint = true;
      if (words[i] == "--diagnose") options.diagnose = true;
      if (words[i] == "--hide" && i + 1 < words.size()) options.hide.push_back(words[i + 1]);
      if (words[i] == "--at" && i + 1 < words.size()) options.when = numbers(words[i + 1]);
      if (words[i] == "--limit" && i + 1 < words.size()) options.limit = std::stod(words[i + 1]);
      if (words[i] == "--pipeline" && i + 2 < words.size()) options.pipeline.emplace_back(words[i + 1], words[i + 2]);
      if (words[i] == "--simulation" && i + 2 < words.size())
        options.simulation.emplace_back(words[i + 1], words[i + 2]);
    }
    std::vector<FullTrial> trials(static_cast<std::size_t>(std::max(0, last - first + 1)));
    std::atomic<int> next{first};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
      for (int seed = next++; seed <= last; seed = next++) {
        auto own = options;
        own.seed = static_cast<unsigned>(seed);
        try {
          trials[static_cast<std::size_t>(seed - first)] = fathom::test::run_trial(own);
        } catch (...) {
          const std::scoped_lock lock{mutex};
          failure = std::current_exception();
        }
      }
    };
    {
      std::vector<std::jthread> workers;
      for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) workers.emplace_back(work);
    }
    if (failure) std::rethrow_exception(failure);
    for (const FullTrial& trial : trials) {
      if (text) std::fputs((trial.text + "\n").c_str(), stdout);
    }
    print(trials);
    if (!options.when.empty()) print_progress(trials, options.when);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fathom_live_trials: %s\n", error.what());
    return 1;
  }
  return 0;
}
