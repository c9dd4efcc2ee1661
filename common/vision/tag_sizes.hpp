// How large tags are that no map states: of one tag, of a family, of all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/model/site.hpp"

namespace fathom::vision {

class TagSizes {
 public:
  TagSizes() = default;
  /// Every tag's edge [m].
  explicit TagSizes(double all) { add({.size = all}); }
  /// Words "0.15", "16h5=15 cm", "16h5:3=0.12 m"; a length without a unit is in metres. InputError for what is none of
  /// these, a family or number that there is none of, and what is stated twice.
  [[nodiscard]] static TagSizes parse(const std::vector<std::string>& words);

  /// Edge [m]; the most particular statement counts. Nothing: nobody stated it.
  [[nodiscard]] std::optional<double> of(const model::TagName& name) const;
  [[nodiscard]] double largest() const;  ///< m; 0 when nothing is stated
  [[nodiscard]] bool empty() const { return rules_.empty(); }
  /// InputError for a family that is not looked for at this site, and for a tag whose size its map states.
  void check_against(const model::Site& site) const;

 private:
  struct Rule {
    std::string family{};     ///< empty: every one
    std::optional<int> id{};  ///< nothing: every one of the family
    double size{};            ///< m
  };
  void add(const Rule& rule) { rules_.push_back(rule); }

  std::vector<Rule> rules_;
};

}  // namespace fathom::vision
