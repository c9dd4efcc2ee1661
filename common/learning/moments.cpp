#include "common/learning/moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/parallel.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::Quantity;

constexpr int kMoments = 40, kAbout = 20;  // asked, all over the recordings and about the best
constexpr double kFromEnd = 0.05;          // of the recordings: nearer to their ends nothing has a before

template <typename Of>
auto moment_of(Of& feature) -> decltype(feature.factors.data()) {
  for (int i = 0; i < feature.count; ++i) {
    auto& factor = feature.factors[static_cast<std::size_t>(i)];
    if (factor.quantity == Quantity::kAfter) return &factor;
  }
  return nullptr;
}

class Profile {
 public:
  Profile(const likelihood::Problem& problem, const inference::Seen& seen, int threads)
      : problem_{problem}, seen_{seen}, threads_{threads} {}

  double best(likelihood::FreeForce& library, std::size_t g) const {
    const likelihood::FeatureGroup& group = library.groups[g];
    const double span = problem_.t_high - problem_.t_low;
    double low = problem_.t_low + kFromEnd * span, high = problem_.t_high - kFromEnd * span;
    double found = moment_of(library.features[static_cast<std::size_t>(group.first)])->a;
    double most = -std::numeric_limits<double>::infinity();
    for (const int count : {kMoments, kAbout}) {
      std::vector<double> moments{found};
      const double step = (high - low) / count;
      for (int i = 0; i <= count; ++i) moments.push_back(low + step * i);
      const std::vector<double> evidence = evidence_of(library, group, moments);
      const auto at = std::ranges::max_element(evidence);
      most = *at;
      found = moments[static_cast<std::size_t>(at - evidence.begin())];
      low = std::max(low, found - step);
      high = std::min(high, found + step);
    }
    for (int j = group.first; j < group.first + group.count; ++j)
      set(library.features[static_cast<std::size_t>(j)], found);
    return most;
  }

 private:
  /// A feature that acts for a shorter time is as large while it acts.
  void set(Feature& feature, double moment) const {
    Factor& factor = *moment_of(feature);
    const auto left = [&](double t) { return std::max(problem_.t_high - t, factor.b); };
    feature.scale *= std::sqrt(left(factor.a) / left(moment));
    factor.a = moment;
  }

  [[nodiscard]] std::vector<double> evidence_of(const likelihood::FreeForce& library,
                                                const likelihood::FeatureGroup& group,
                                                const std::vector<double>& moments) const {
    likelihood::FreeForce all;
    for (const double moment : moments) {
      likelihood::FeatureGroup one = group;
      one.first = static_cast<int>(all.features.size());
      for (int j = group.first; j < group.first + group.count; ++j) {
        all.features.push_back(library.features[static_cast<std::size_t>(j)]);
        set(all.features.back(), moment);
      }
      all.groups.push_back(std::move(one));
    }
    all.weights.assign(all.features.size(), 0.0);
    std::vector<double> evidence(moments.size());
    const std::vector<std::vector<std::size_t>> batches = inference::batches_of(all);
    for_each_index(batches.size(), threads_, [&](std::size_t b) {
      const inference::Screen several = inference::screen(problem_, seen_, all, batches[b], false);
      for (std::size_t k = 0; k < batches[b].size(); ++k)
        evidence[batches[b][k]] =
            inference::group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1),
                                      {inference::kStartSigma})
                .log_bayes_factor;
    });
    return evidence;
  }

  const likelihood::Problem& problem_;
  const inference::Seen& seen_;
  int threads_;
};

}  // namespace

bool sets_in(const Feature& feature) { return moment_of(feature) != nullptr; }

std::vector<std::pair<std::size_t, double>> profile_moments(const likelihood::Problem& problem,
                                                            const inference::Seen& seen,
                                                            const std::vector<std::size_t>& groups,
                                                            likelihood::FreeForce& library, int threads) {
  const Profile profile{problem, seen, threads};
  std::vector<std::pair<std::size_t, double>> found;
  for (const std::size_t g : groups) {
    const likelihood::FeatureGroup& group = library.groups[g];
    if (group.searched && moment_of(library.features[static_cast<std::size_t>(group.first)]) != nullptr)
      found.emplace_back(g, profile.best(library, g));
  }
  return found;
}

}  // namespace fathom::learning
