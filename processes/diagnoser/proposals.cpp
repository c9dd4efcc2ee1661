#include "processes/diagnoser/proposals.hpp"

namespace fathom::diagnoser {
namespace {

std::string word(const model::ActiveEffect& effect) {
  return std::string{effect.effect->name()} + " " + effect.variant_name;
}

}  // namespace

void Proposals::complete(EffectRanking& ranking, const live::Rivals& rivals) {
  if (!rivals || !model_) return;
  const std::string question = word(rivals->first) + " or " + word(rivals->second);
  auto known = answers_.find(question);
  if (known == answers_.end())
    known = answers_.emplace(question, separation_.between(rivals->first, rivals->second, *model_)).first;
  if (!known->second) return;
  ranking.segment = known->second->segment;
  ranking.duration = known->second->seconds;
}

void Proposals::reset() {
  answers_.clear();
  model_.reset();
}

}  // namespace fathom::diagnoser
