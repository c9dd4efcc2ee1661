#include "common/live/live_diagnoser.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/estimation/smoothing/state_as_measured.hpp"
#include "common/estimation/trial_columns.hpp"
#include "common/live/ranking.hpp"
#include "common/verdict/of_recordings.hpp"

namespace fathom::live {
namespace {

constexpr double kTwice = 2.0;    // as long, and there is another look: all looks together cost as much as two
constexpr double kTimeFor = 0.5;  // of what it sees: a search takes a tenth of that on two idle cores

/// A trial goes on where a candidate's column is silent.
void drop_unmeasured(const std::vector<Recording>& heard, model::Vehicle& vehicle, std::vector<std::string>& notes) {
  std::erase_if(vehicle.candidates, [&](const model::Candidate& candidate) {
    for (const Recording& recording : heard) {
      const std::string missing = estimation::missing_column(recording, candidate);
      if (missing.empty()) continue;
      notes.push_back("candidate '" + candidate.text + "' is not asked: no SIGNAL tells of " + missing);
      return true;
    }
    return false;
  });
}

const EffectRanking kCollecting{.verdict = "collecting"};

}  // namespace

LiveDiagnoser::LiveDiagnoser(const LiveSettings& settings, const model::Vehicle& vehicle,
                             std::optional<model::Site> site, Late late, std::function<bool()> go_on)
    : settings_{settings},
      vehicle_{std::make_unique<const model::Vehicle>(vehicle)},
      site_{site ? std::make_unique<const model::Site>(*std::move(site)) : nullptr},
      late_{late},
      go_on_{std::move(go_on)},
      trial_{settings.keep},
      next_look_{settings.first_look},
      told_{.ranking = kCollecting, .learned = {}, .rivals = {}, .notes = {}} {}

std::optional<EffectRanking> LiveDiagnoser::step(const StateEstimate& state) {
  trial_.hear(state);
  if (!state.valid) return {};
  first_ = std::min(state.utime, first_.value_or(state.utime));
  newest_ = std::max(state.utime, newest_);
  look();
  const Utime next = utime_after(*first_, static_cast<double>(said_ + 1) * settings_.interval);
  if (newest_ < next || !take_what_is_due(next)) return {};
  ++said_;
  told_.ranking.utime = next;
  return told_.ranking;
}

/// Begins when nothing of what it shall see is still on its way.
void LiveDiagnoser::look() {
  if (look_ || seconds_between(*first_, newest_) < next_look_ + settings_.max_skew) return;
  const double told_after = std::max((1.0 + kTimeFor) * next_look_, next_look_ + settings_.max_skew);
  const auto priority =
      late_ == Late::kIsToldLate ? BackgroundSearch::Priority::kBelow : BackgroundSearch::Priority::kAsCaller;
  look_.emplace(next_look_, utime_after(*first_, told_after),
                search(utime_after(*first_, next_look_), priority, false));
  next_look_ *= kTwice;
}

/// False: it is not there yet.
bool LiveDiagnoser::take_what_is_due(Utime utime) {
  if (!look_ || look_->due > utime) return true;
  if (late_ == Late::kIsToldLate && !look_->search.ready()) return false;
  std::optional<Found> found = look_->search.wait(go_on_);
  if (!found) return false;
  tell(*std::move(found), look_->seconds);
  look_.reset();
  look();
  return true;
}

void LiveDiagnoser::tell(Found found, double seconds) {
  char text[64];
  std::snprintf(text, sizeof text, "of %.0f s of motion: %s", seconds, found.ranking.verdict.c_str());
  std::string line = text;
  if (found.ranking.verdict == "effect" || found.ranking.verdict == "ambiguous") {
    const EffectEvidence& first = found.ranking.candidates.front();
    line += ", " + first.name + (first.variant.empty() ? "" : " " + first.variant);
  }
  notes_.push_back(std::move(line));
  std::ranges::move(found.notes, std::back_inserter(notes_));
  told_ = std::move(found);
}

BackgroundSearch LiveDiagnoser::search(Utime end, BackgroundSearch::Priority priority, bool learn) const {
  verdict::RecordingsSettings settings;
  settings.inference.threads = settings_.threads;
  settings.learning.learn = learn;
  settings.site = site_.get();
  return {[settings, heard = trial_.until(end), vehicle = *vehicle_](const Progress& progress) mutable {
            Found found;
            try {
              drop_unmeasured(heard, vehicle, found.notes);
              for (Recording& recording : heard) estimation::take_state_as_measured(recording);
              const std::size_t count = heard.size();
              verdict::Asked asked{.recordings = std::move(heard), .fitted = count};
              const auto explained = verdict::of_recordings(vehicle, std::move(asked), settings, progress, found.notes);
              found.ranking = ranking_of(explained.answer);
              found.learned = learned_of(explained.answer);
              found.rivals = rivals_of(explained.answer);
            } catch (const InputError& error) {  // too short, or without motion: the next look sees more
              found.ranking.verdict = "not_judged";
              found.notes.emplace_back(error.what());
            }
            return found;
          },
          priority};
}

std::optional<EffectRanking> LiveDiagnoser::finish() {
  if (!first_ || !go_on_()) return {};
  if (look_) look_->search.abandon();
  BackgroundSearch whole = search(std::numeric_limits<Utime>::max(), BackgroundSearch::Priority::kAsCaller, true);
  std::optional<Found> found = whole.wait(go_on_);
  if (!found) return {};
  tell(*std::move(found), seconds_between(*first_, newest_));
  look_.reset();
  told_.ranking.utime = newest_;
  if (told_.learned) told_.learned->utime = newest_;
  return told_.ranking;
}

void LiveDiagnoser::reset() {
  look_.reset();
  trial_.reset();
  first_.reset();
  newest_ = 0;
  next_look_ = settings_.first_look;
  said_ = 0;
  told_ = {.ranking = kCollecting, .learned = {}, .rivals = {}, .notes = {}};
}

}  // namespace fathom::live
