#include "processes/diagnoser/proposals.hpp"

namespace fathom::diagnoser {
namespace {

std::string word(const model::ActiveEffect& effect) {
  return std::string{effect.effect->name()} + " " + effect.variant_name;
}

}  // namespace

void Proposals::complete(EffectRanking& ranking, const Rivals& rivals) {
  if (answer_.valid()) answers_[asked_] = answer_.get();
  if (!rivals) return;
  const std::string question = word(rivals->first) + " or " + word(rivals->second);
  const auto known = answers_.find(question);
  if (known == answers_.end()) {
    if (!model_) return;
    asked_ = question;
    answer_ = std::async(std::launch::async, [this, pair = *rivals, model = *model_] {
      return separation_.between(pair.first, pair.second, model);
    });
  } else if (known->second) {
    ranking.segment = known->second->segment;
    ranking.duration = known->second->seconds;
  }
}

void Proposals::reset() {
  if (answer_.valid()) answer_.get();
  answers_.clear();
  model_.reset();
}

}  // namespace fathom::diagnoser
