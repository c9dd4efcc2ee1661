// The search's moves and what they share. Room-internal: search.hpp is what others see.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/inference/search.hpp"

namespace fathom::inference {

struct Proposal {
  std::vector<model::ActiveEffect> added;
  likelihood::Noise noise;                  ///< from which its fit begins
  bool first{};                             ///< asked before the others
  std::vector<model::ActiveEffect> also{};  ///< in place of the one that is added, other numbers to begin from
};

/// What a look has passed over, for others promised more.
struct Unasked {
  double promised{};  ///< nats
  bool far{};         ///< too little beside the best promise
  Proposal proposal;
};

/// What is known of these runs before they are searched: where fits of the base model and of sets of effects begin.
struct Before {
  Start base;
  std::vector<Start> sets;
  std::vector<Start> more;  ///< of more names than `few_effects`
};

class Searching {
 public:
  Searching(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
            const Thresholds& thresholds, int threads, const Progress& progress, const Deadline& deadline)
      : problem_{problem},
        scene_{scene},
        laws_{catalogue(scene, without)},
        thresholds_{thresholds},
        threads_{threads},
        progress_{progress},
        deadline_{deadline},
        models_{problem, laws_, threads, progress} {}
  /// `before`: what stretches of these runs have told.
  Found run(const Before* before = nullptr);
  /// What a search of stretches of these runs has told of names, besides its models. Forms, times and places are not
  /// sought again, nor what could stand in another's place: on more data its odds can be expected to grow.
  void know(const Searching& ahead);
  /// What a search of whole runs after one of their stretches is expected to be.
  static void announce(const Progress& progress);

 private:
  /// The better of two after a round of each: begun from the noise's prior means, and with random forces as large as
  /// the motion's own. There the filter leans on the measurements: whatever the numbers it begins from, it does not run
  /// away, and the first steps are a fit of accelerations.
  [[nodiscard]] likelihood::Fit fit_base() const;
  /// The best of these sets is the best model where it is worth its names.
  void take_up(const std::vector<Start>& sets);
  void expect(const Step& step, double units) const;
  void begin(const Step& step) const;
  /// Scans and fits of so many rounds, this one included.
  void expect_rounds(double rounds);
  /// Adds names until there are `most` of them or nothing is left that gains enough.
  void grow(int most);
  /// What the names are worth: against other names, against none, and against a free force.
  void settle();
  /// What no list holds takes many names to imitate, and so does a craft that lacks many: it goes on beyond a few.
  void go_beyond(const Fitted& grown, const Before* before);
  /// There is time for more.
  bool goes_on();
  [[nodiscard]] const std::vector<model::ActiveEffect>& effects() const;
  [[nodiscard]] model::ActiveEffect effect_of(std::size_t law, const std::vector<double>& theta) const;
  /// What promises most beside a model: the best laws and pairs, seen at its noise and, where a random force may have
  /// swallowed something slow, at a fifth of it. `least`: what a promise must come to, in nats.
  std::vector<Proposal> proposals(const Fitted& from, double least, bool with_pairs);
  [[nodiscard]] std::vector<Start> starts(const likelihood::Hypothesis& from,
                                          const std::vector<Proposal>& proposals) const;
  [[nodiscard]] static Start without(const Fitted& from, std::size_t effect);
  /// Takes the best of these where it is a name's worth better; else false.
  bool take_best(std::vector<Fitted> fits);
  bool add_some();
  /// Of the last look, what was not asked, though by what those that were asked have really gained it should have been:
  /// a promise that is not kept hides nothing. All that promised more than that, and the first of what promised little
  /// beside the best promise and enough beside the gain. One form of each name.
  [[nodiscard]] std::vector<Proposal> hidden(const std::vector<Proposal>& asked, double gained) const;
  static bool held(const std::vector<model::ActiveEffect>& effects, const model::ActiveEffect& active);
  /// Every effect that the best model does not hold yet has the smallest practical size and numbers of its own; else
  /// it is noted why not.
  [[nodiscard]] bool counts(const Fitted& fitted);
  /// Share of the applied acceleration that an effect of the seen model does, on the worst axis: what base numbers
  /// cannot do in its place, or, where `without` it is known, the random force that takes its place there. Numbers that
  /// two axes share can do in one what it does and not in the other, and random forces then take the rest.
  [[nodiscard]] Size size_of(const Seen& seen, std::size_t effect, const Fitted* without) const;
  /// A race among forms and maxima of one name: what does not beat the best model tells nothing.
  [[nodiscard]] Odds better() const;
  /// Other forms of the effects that were just found, begun from their shared numbers, where the score promised at
  /// least half as much: the best stays.
  void simplify(const std::vector<model::ActiveEffect>& before);
  /// Times, frequencies and places of the effects that were just found, sought once more: they have many maxima, and
  /// the noise at which they were found had taken a part of them.
  void seek_again(const std::vector<model::ActiveEffect>& before);
  /// A fifth of every random force.
  void quiet(likelihood::Fit& fit) const;
  /// The random force of some axis may have swallowed something slow; if so, `fit` has a fifth of it afterwards.
  [[nodiscard]] bool quieten(const Seen& seen, likelihood::Fit& fit) const;
  /// Nats that the best model would lose without the effect, by Wald's test of its leading numbers: a linear guess.
  [[nodiscard]] double guessed_loss(const Seen& seen, std::size_t effect) const;
  /// What another effect has made small or worthless, or pushed to a limit, goes, and is not taken up beside the same
  /// others again: a name that counts as it comes and not as it stays would come for ever.
  void drop();
  /// One of its names went from beside the others.
  [[nodiscard]] bool given_up(const std::vector<std::string>& names) const;
  [[nodiscard]] std::vector<std::string> names_without(std::size_t effect) const;
  /// The best model without each effect, where none has been fitted yet.
  void leave_out();
  /// For each of several effects: leave it out, scan, fit in its place what promises about as much. Whether any was
  /// exchanged.
  bool swap();
  [[nodiscard]] FreeForceFound free_force_beside(const Fitted& fitted) const;
  static double worth(const FreeForceFound& force);
  /// Nats that a further name must promise, and gain: a fifth of what no name does yet.
  [[nodiscard]] double least_of_next() const;
  /// "Something that no list holds" may act in a name's place as well as beside it: both with the free force that is
  /// best there. Names that are not worth their odds over that are none, and the free force stays in their place. First
  /// all together that are worth less than the free force beside them, then each once, the weakest first.
  void give_way();
  /// If the free force beside `rest`, which lacks these effects, does what they do, they are gone.
  void takes_the_place(const std::vector<std::size_t>& gone, const Fitted& rest);
  void judge_effects();
  void note(const Promise& promise);
  /// By its best fit: beside all that was found it lacks odds, size or numbers of its own; in place of something that
  /// was found it is less probable.
  [[nodiscard]] Refusal refusal(const std::string& name, double promised) const;
  void list_refused();
  /// Of the best promise, and then of what was really gained: what promises less has never been the true one. Promises
  /// are linear, so that a law's own is wrong by a factor of two where its numbers are far from its grid.
  static constexpr double kFarBehind = 0.2;
  static constexpr double kDoubtful = 5.0;  // times a name's odds: a guess of less is asked of a fit

  const likelihood::Problem& problem_;
  const model::Scene& scene_;
  std::vector<Law> laws_;
  const Thresholds& thresholds_;
  int threads_;
  const Progress& progress_;
  const Deadline& deadline_;
  FittedModels models_;
  Found found_;
  double unnamed_{};  // nats that the free force beside few names is worth, less what further names have gained
  bool sought_{};     // on stretches already: forms, times and places, and what could stand in another's place
  std::map<std::string, Promise> noted_;
  std::map<std::string, double> beside_;      // what each name promised beside the best model, as it was last looked at
  std::map<std::size_t, Promise> promised_;   // by law, in the last look
  std::vector<Unasked> unasked_;              // in the last look
  std::set<std::vector<std::string>> small_;  // sets of names of which one is too small to matter
  std::map<std::string, Refusal> failed_;     // what evidence alone would have named
  std::set<std::pair<std::vector<std::string>, std::string>> given_up_;  // names that stayed, and the one that went
  std::map<std::string, Refusal> gave_way_;                              // to a free force in its place
  std::map<std::string, double> in_place_;                               // nats by which a name is worth more than that
};

}  // namespace fathom::inference
