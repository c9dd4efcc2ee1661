// What can be set of the diagnoser on line.
#pragma once

namespace fathom {
class Config;
}

namespace fathom::live {

struct LiveSettings {
  double first_look{30.0};  ///< s of motion until the first search: of 70 % of it a model can be judged at all
  double interval{10.0};    ///< s between rankings
  double max_skew{1.0};     ///< s by which one channel may lag STATE without changing what is looked at
  double keep{600.0};       ///< s of motion that are held: of a longer trial minutes spread evenly over it
  int threads{2};           ///< of a search; no number depends on it

  /// Keys: as the members. `threads` is optional.
  [[nodiscard]] static LiveSettings from(const Config& config);
};

}  // namespace fathom::live
