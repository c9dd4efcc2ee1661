// What can be asked: every form of every listed effect that the data can show, with the values at which the score test
// looks. With likelihood/effect_stages.hpp the only place that reads an Effect.
#pragma once

#include <string>
#include <vector>

#include "common/likelihood/effect_stages.hpp"

namespace fathom::inference {

struct Law {
  std::string name, form;
  model::ActiveEffect seed;               ///< with some numbers
  std::vector<std::vector<double>> grid;  ///< values of all its numbers
  std::vector<std::size_t> linear;        ///< numbers that get columns of their own; the others shape them
  int onset{-1};                          ///< place of a time of an event among its numbers; -1: none
  int forms{1};                           ///< of the same effect, here
};

/// `without`: names that are left out.
[[nodiscard]] std::vector<Law> catalogue(const model::Scene& scene, const std::vector<std::string>& without);
/// The names that are listed, for messages.
[[nodiscard]] std::vector<std::string> listed_names();
/// Whether a fit moves that number in this form.
[[nodiscard]] bool moves(const model::ActiveEffect& active, std::size_t number);
/// Whether a search for its numbers was stopped by a limit that says nothing, or has come to numbers that nothing can
/// have here: it has found no effect.
[[nodiscard]] bool stopped(const model::ActiveEffect& active, const model::Scene& scene);
/// Whether it is asked before all others: where a sensor sits is the recording's business, and a force would stand in
/// for it.
[[nodiscard]] bool asked_first(const Law& law);
/// What a craft that lives by its flow has anyhow: however small it is beside the applied force, it is no false claim.
[[nodiscard]] bool by_nature(const model::ActiveEffect& active);
/// The same of a listed effect's name.
[[nodiscard]] bool by_nature(const std::string& name);
/// How many of them say that something is missing: what a craft that lives by its flow has by nature says no such
/// thing.
[[nodiscard]] std::size_t claims(const std::vector<model::ActiveEffect>& effects);
/// Whether two effects cannot stand in one model: forms that act in place of each other, or laws of one thing.
[[nodiscard]] bool exclude(const model::ActiveEffect& a, const model::ActiveEffect& b);

}  // namespace fathom::inference
