#include "test/sealed/dives/sealed_set.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fathom::sealed {
namespace {

constexpr double kTrial = 330.0;       // s
constexpr double kValidation = 165.0;  // s
constexpr double kCloseEnough = 0.04;  // of the share that is aimed at
constexpr double kReached = 0.10;
constexpr int kTries = 14;

struct Turn {
  Kind kind;
  const Entry* entry;
};

/// Every effect once, and in between what must stay unnamed.
std::vector<Turn> round_of(CraftClass craft_class) {
  std::vector<Turn> turns;
  int count = 0;
  for (const Entry* entry : catalogue_of(craft_class)) {
    turns.push_back({Kind::kSingle, entry});
    if (++count % 5 == 0) turns.push_back({Kind::kPair, nullptr});
    if (count % 6 == 1) turns.push_back({Kind::kForeign, nullptr});
    if (count % 6 == 3) turns.push_back({Kind::kClean, nullptr});
    if (count % 12 == 5) turns.push_back({Kind::kNoise, nullptr});
  }
  return turns;
}

bool sensor(const Entry& e) { return e.name.starts_with("sensor_") || e.name == "lever_arm"; }

bool goes_together(const Entry& a, const Entry& b) {
  const bool same = a.name == b.name || (sensor(a) && sensor(b));
  const auto either = [&](const char* x, const char* y) {
    return (a.name == x && b.name == y) || (a.name == y && b.name == x);
  };
  return !same && !either("thruster_gain", "thruster_failure") && !either("thruster_lag", "thruster_delay") &&
         !either("bottom_effect", "compressibility");
}

std::vector<Dive> train_dives(const SealedSet& set, const Mechanisms& mechanisms) {
  std::vector<Dive> dives;
  double begin = 0.0;
  const int files = set.plan.train_files;
  const double length = set.plan.validates ? kTrial / files : kTrial + kValidation;
  for (int i = 0; i < files; ++i) {
    const std::string purpose = "train-" + std::to_string(i + 1);
    dives.push_back(
        dive(set.craft, set.site, mechanisms, set.noise,
             {.begin = begin, .length = length, .seed = set.plan.seed, .purpose = purpose, .hold = set.plan.hold}));
    if (set.plan.one_clock) begin = std::round(begin + length + 31.0 + i);
  }
  return dives;
}

bool sound(std::span<const Dive> dives) {
  return std::ranges::all_of(dives, [](const Dive& one) { return one.sound; });
}

/// Mechanism `index` alone, at `size`: its share; a run that ran away is as bad as any.
double share_of(SealedSet& set, std::size_t index, double size) {
  Mechanisms alone;
  alone.push_back(std::move(set.mechanisms[index]));
  alone.front()->set_size(size);
  const std::vector<Dive> dives = train_dives(set, alone);
  set.mechanisms[index] = std::move(alone.front());
  if (!sound(dives)) return 1e3;
  return added_share(set.craft, fit_base(set.craft, dives), set.clean_fit);
}

/// Finds the size whose share is the class's: regula falsi on logarithms, since shares grow about like powers of sizes.
double scale(SealedSet& set, std::size_t index, double target) {
  Mechanism& mechanism = *set.mechanisms[index];
  const double largest = mechanism.largest();
  double size = std::min(mechanism.first_guess(), largest), low = 0.0, high = 0.0, low_share = 0.0, high_share = 0.0;
  double best = size, best_share = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double share = share_of(set, index, size);
    if (std::abs(share - target) < std::abs(best_share - target) && share < 1e3) {
      best = size;
      best_share = share;
    }
    if (std::abs(share - target) < kCloseEnough * target) break;
    if (share < target) {
      if (size >= largest) break;
      low = size;
      low_share = share;
    } else {
      high = size;
      high_share = share;
    }
    if (low > 0.0 && high > 0.0) {
      double part = 0.5;
      if (i % 3 != 2 && high_share < 1e3 && low_share > 0.0) {
        part = std::clamp(std::log(target / low_share) / std::log(high_share / low_share), 0.1, 0.9);
      }
      size = low * std::pow(high / low, part);
    } else {
      size = std::min(size * std::clamp(target / std::max(share, 1e-9), 0.3, 4.0), largest);
    }
  }
  (void)share_of(set, index, best);  // leaves the size set
  return best_share;
}

/// Open water, and the instruments of such craft: satellites for boats and ships, the others as ROVs.
void draw_other(const Needs& needs, Random& random, SealedSet& set) {
  const CraftClass craft_class = set.plan.craft_class;
  do set.craft = draw_other_craft(craft_class, random);
  while (needs.windage && !(set.craft.windage > 0.0));
  const double room = craft_class == CraftClass::kTorpedo ? random.uniform(50.0, 80.0)
                      : craft_class == CraftClass::kBoat  ? random.uniform(25.0, 45.0)
                                                          : set.craft.extent.x() * random.uniform(18.0, 28.0);
  set.site.half << room, room, random.uniform(2.5, 4.0);
  set.site.centre << random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0),
      set.craft.surfaced ? 0.0 : set.site.half.z() + random.uniform(3.0, 8.0);
  if (!set.craft.surfaced) return;
  set.noise.position = 0.015;
  set.noise.velocity = 0.01;
}

void draw_vehicle(const Needs& needs, Random& random, SealedSet& set) {
  if (set.plan.craft_class != CraftClass::kRov) return draw_other(needs, random, set);
  const auto family = static_cast<Family>(needs.tilting || random.chance(0.25) ? 4 + random.below(2) : random.below(4));
  set.craft = draw_craft(family, random);
  if (needs.moments) {
    set.craft.states_moments = false;
    set.craft.hull.first_moment.setZero();
  }
  set.site.half << random.uniform(1.5, 4.0), random.uniform(1.5, 3.5), random.uniform(0.7, 1.8);
  set.site.centre << random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), set.site.half.z() + random.uniform(0.6, 2.0);
}

std::vector<const Entry*> mixed(const std::vector<const Entry*>& listed, const std::vector<const Entry*>& foreign,
                                Random& random) {
  const auto any_of = [&](const std::vector<const Entry*>& list) {
    return list[static_cast<std::size_t>(random.below(static_cast<int>(list.size())))];
  };
  std::vector<const Entry*> chosen{any_of(listed), any_of(listed), any_of(foreign)};
  while (!goes_together(*chosen[0], *chosen[1]) || sensor(*chosen[2])) {
    chosen[1] = any_of(listed);
    chosen[2] = any_of(foreign);
  }
  return chosen;
}

std::vector<const Entry*> many(std::vector<const Entry*> listed, Random& random) {
  const auto count = static_cast<std::size_t>(5 + random.below(2));
  std::vector<const Entry*> chosen;
  while (chosen.size() < count && !listed.empty()) {
    const auto at = listed.begin() + random.below(static_cast<int>(listed.size()));
    if (std::ranges::all_of(chosen, [&](const Entry* other) { return goes_together(**at, *other); }))
      chosen.push_back(*at);
    listed.erase(at);
  }
  return chosen;
}

}  // namespace

Plan make_plan(std::uint64_t seed, const Wish& wish) {
  const std::vector<Turn> turns = round_of(wish.craft_class);
  const std::uint64_t round = seed / turns.size();
  const Turn& turn = turns[seed % turns.size()];
  Random random(seed, "plan");
  Plan plan{.seed = seed,
            .kind = turn.kind,
            .size = static_cast<Size>((seed % turns.size() + round) % kShares.size()),
            .craft_class = wish.craft_class};
  const Entry* entry = turn.entry;
  if (wish.effect == "unlisted") {
    entry = &unlisted()[seed % unlisted().size()];
    plan.kind = Kind::kForeign;
    // Each of them in each size.
    plan.size = static_cast<Size>(seed / unlisted().size() % kShares.size());
  } else if (!wish.effect.empty()) {
    entry = nullptr;
    const auto* kind = std::find(kKindNames.begin(), kKindNames.end(), wish.effect);
    if (kind != kKindNames.end()) {
      plan.kind = static_cast<Kind>(kind - kKindNames.begin());
    } else {
      entry = find_entry(wish.effect);
      if (entry == nullptr) throw std::runtime_error("no effect is called '" + wish.effect + "'");
      const auto in = [&](const std::vector<Entry>& list) {
        return std::ranges::any_of(list, [&](const Entry& e) { return &e == entry; });
      };
      const bool listed = in(catalogue()) || in(further()) || in(surface_entries());
      plan.kind = listed ? Kind::kSingle : entry == &coloured_noise() ? Kind::kNoise : Kind::kForeign;
    }
  }
  const auto any_of = [&](const std::vector<const Entry*>& list) {
    return list[static_cast<std::size_t>(random.below(static_cast<int>(list.size())))];
  };
  const std::vector<const Entry*> listed_here = catalogue_of(wish.craft_class);
  std::vector<const Entry*> chosen;
  switch (plan.kind) {
    case Kind::kClean:
      break;
    case Kind::kNoise:
      chosen = {&coloured_noise()};
      break;
    case Kind::kSingle:
      chosen = {entry != nullptr ? entry : any_of(listed_here)};
      break;
    case Kind::kForeign:
      chosen = {entry != nullptr ? entry : any_of(foreign_of(wish.craft_class))};
      break;
    case Kind::kPair:
      chosen = {any_of(listed_here), any_of(listed_here)};
      while (!goes_together(*chosen[0], *chosen[1])) chosen[1] = any_of(listed_here);
      if (!wish.size && plan.size == Size::kWeak) plan.size = Size::kMedium;
      break;
    case Kind::kMixed:
    case Kind::kMany:
      chosen = plan.kind == Kind::kMixed ? mixed(listed_here, foreign_of(wish.craft_class), random)
                                         : many(listed_here, random);
      for (std::size_t i = 0; i < chosen.size() && !wish.size; ++i)
        plan.sizes.push_back(static_cast<Size>(random.below(static_cast<int>(kShares.size()))));
      break;
  }
  if (wish.size) plan.size = *wish.size;
  bool thrusters = false, clock = false;
  for (const Entry* one : chosen) {
    plan.names.push_back(one->name);
    thrusters = thrusters || one->needs.thrusters;
    clock = clock || one->needs.clock;
  }
  plan.one_clock = random.chance(0.5);
  const double files = random.unit();
  plan.train_files = files < 0.25 && !clock ? 3 : 1;
  plan.validates = files < 0.8 || wish.new_recording;
  plan.wrench = random.chance(0.25) && !thrusters && wish.craft_class == CraftClass::kRov;
  plan.voltage = random.chance(0.3);
  plan.priors = random.chance(0.5);
  Random habit{seed, "habit of the log"};
  const double hold = habit.unit();
  plan.hold = hold < 0.55 ? Hold::kAfter : hold < 0.8 ? Hold::kLine : Hold::kBefore;
  return plan;
}

SealedSet make_set(const Plan& plan) {
  SealedSet set{.plan = plan};
  Needs needs;
  for (const std::string& name : plan.names) {
    const Needs& one = find_entry(name)->needs;
    needs.tilting = needs.tilting || one.tilting;
    needs.moments = needs.moments || one.moments;
    needs.windage = needs.windage || one.windage;
  }
  Random random(plan.seed, "vehicle");
  std::vector<Dive> clean;
  do {  // a craft that its pilot cannot hold even without an effect is nobody's
    draw_vehicle(needs, random, set);
    clean = train_dives(set, {});
  } while (!sound(clean));
  Random details(plan.seed, "effect");
  for (const std::string& name : plan.names) {
    const Entry* entry = find_entry(name);
    set.mechanisms.push_back(entry->make(name, set.craft, set.site, details));
  }
  const auto target_of = [&](std::size_t i) {
    return kShares[static_cast<std::size_t>(plan.sizes.empty() ? plan.size : plan.sizes[i])];
  };
  set.clean_fit = fit_base(set.craft, clean);
  for (std::size_t i = 0; i < set.mechanisms.size(); ++i) {
    const double target = target_of(i);
    set.shares.push_back(scale(set, i, target));
    set.reached = set.reached && std::abs(set.shares.back() - target) < kReached * target;
  }
  for (int i = 0; i < kTries; ++i) {  // two that are bearable alone may not be so together
    set.train = train_dives(set, set.mechanisms);
    if (sound(set.train)) break;
    for (const auto& mechanism : set.mechanisms) mechanism->set_size(0.7 * mechanism->size());
    set.reached = false;
  }
  set.fit = fit_base(set.craft, set.train);
  if (plan.validates) {
    const Dive& last = set.train.back();
    const double length = static_cast<double>(last.size()) * last.dt;
    const double begin = plan.one_clock ? std::round(last.begin + length + 45.0) : 0.0;
    set.validate =
        dive(set.craft, set.site, set.mechanisms, set.noise,
             {.begin = begin, .length = kValidation, .seed = plan.seed, .purpose = "validate", .hold = plan.hold});
  }
  if (!sound(set.train) || (set.validate && !set.validate->sound))
    throw RunsAway("not drawn: the vehicle runs away, however small the effect");
  return set;
}

}  // namespace fathom::sealed
