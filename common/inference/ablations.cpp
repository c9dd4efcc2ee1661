#include "common/inference/ablations.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "common/base/error.hpp"

namespace fathom::inference {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr std::array kAblations{
    Ablation{"random_force", "the random force with a memory", [](Settings& s) { s.runs.terms.random_force = false; }},
    Ablation{"coloured_noise", "coloured noise of the sensors",
             [](Settings& s) { s.runs.terms.coloured_noise = false; }},
    Ablation{"tails", "Student's t for the innovations", [](Settings& s) { s.runs.terms.tails = false; }},
    Ablation{"followed_scale", "the innovations' scale that follows the recording",
             [](Settings& s) { s.runs.terms.followed_scale = false; }},
    Ablation{"command_clock", "the clock of the commands as a number of each run",
             [](Settings& s) { s.runs.terms.command_clock = false; }},
    Ablation{"smallest_size", "the smallest size of a name and of a free force",
             [](Settings& s) { s.thresholds.smallest_size = 0.0; }},
    Ablation{"name_odds", "7 of the 10 nats that a name needs", [](Settings& s) { s.thresholds.name_odds = 3.0; }},
    Ablation{"pairs", "pairs that are fitted at once", [](Settings& s) { s.thresholds.pairs_per_round = 0; }},
    Ablation{"second_scan", "the scan with a fifth of the random force",
             [](Settings& s) { s.thresholds.large_random = kNever; }},
    Ablation{"other_fits", "all fits of a round but that of the best promise",
             [](Settings& s) { s.thresholds.fits_per_round = 1; }},
    Ablation{"free_force", "the free force that stands for what no list holds",
             [](Settings& s) { s.thresholds.free_force_odds = kNever; }},
    Ablation{"group_price", "the prices of a free force's groups",
             [](Settings& s) { s.thresholds.group_price = s.thresholds.group_gain = 0.0; }},
    Ablation{"searched_price", "the price of a moment or frequency that was sought",
             [](Settings& s) { s.thresholds.searched_price = 0.0; }},
    Ablation{"slow_memory", "a slow random force as a reason for \"unexplained\"",
             [](Settings& s) { s.thresholds.slow_memory = kNever; }},
    Ablation{"few_effects", "that a model of more than four names leaves nothing",
             [](Settings& s) { s.thresholds.few_effects = s.thresholds.most_effects; }},
    Ablation{"following", "axes that do not follow their thrust as a reason for \"no_model\"",
             [](Settings& s) { s.thresholds.following = -kNever; }},
    Ablation{"two_scores", "numbers of the multi-horizon score",
             [](Settings& s) { s.thresholds.disagreement = kNever; }},
};

}  // namespace

std::span<const Ablation> ablations() { return kAblations; }

void ablate(std::string_view name, Settings& settings) {
  const auto found = std::ranges::find(kAblations, name, &Ablation::name);
  if (found != kAblations.end()) return found->take_out(settings);
  std::string all;
  for (const Ablation& one : kAblations) all += (all.empty() ? "" : ", ") + std::string(one.name);
  throw InputError("--ablate " + std::string(name) + ": no rule or term has this name; there are " + all);
}

}  // namespace fathom::inference
