#include "common/planning/separation.hpp"

#include <cmath>

namespace fathom::planning {
namespace {

constexpr int kRounds = 6;       // of finding the size; most effects are nearly proportional
constexpr double kClose = 0.03;  // of the size

/// The part of a change that base parameters cannot make.
Eigen::VectorXd own(const View& data, const Base& base, const Eigen::VectorXd& change) {
  return change - data.jacobian() * base.solve(data.jacobian().transpose() * change);
}

}  // namespace

std::optional<Answer> segment_between(const model::ActiveEffect& found, const model::Effect& other,
                                      const model::Scene& scene, const View& data, std::span<const Extra> extras) {
  const View* alone = &data;
  const Base base{data.model(), std::span{&alone, 1}};
  std::vector<Suspect> pair(2);
  pair[0] = {.active = found, .change = data.change(found), .imitated = {}};
  const Eigen::VectorXd target = own(data, base, pair[0].change);
  double nearest = 0.0;
  const std::vector<std::string> forms = other.variants(scene);
  for (std::size_t form = 0; form < forms.size(); ++form) {
    if (forms[form] == "-") continue;
    const int variant = static_cast<int>(form);
    for (const std::vector<double>& start : other.starts(scene, variant)) {
      Suspect like{.active = {&other, variant, forms[form], start}, .change = {}, .imitated = {}};
      double cosine = 0.0;
      for (int round = 0; round < kRounds; ++round) {
        like.change = data.change(like.active);
        const Eigen::VectorXd does = own(data, base, like.change);
        if (!does.allFinite() || !(does.norm() > 0.0)) break;
        cosine = does.dot(target) / (does.norm() * target.norm());
        const double factor = does.dot(target) / does.squaredNorm();
        if (std::abs(factor - 1.0) < kClose || !grow(like.active, factor)) break;
      }
      if (cosine <= nearest) continue;
      nearest = cosine;
      pair[1] = std::move(like);
    }
  }
  if (nearest <= 0.0) return std::nullopt;
  const Energies energies{data, extras, pair};
  if (energies.beside(0, 1, 0) >= kToldApart) return std::nullopt;
  return energies.tells_apart(0, 1);
}

}  // namespace fathom::planning
