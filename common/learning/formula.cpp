#include "common/learning/formula.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/inference/feature_columns.hpp"
#include "common/learning/steps.hpp"
#include "common/model/learned/learned_force.hpp"

namespace fathom::learning {
namespace {

using likelihood::Fit;
using likelihood::Problem;
using model::Feature;
using model::kWorldAxis;

constexpr double kAmplitudeSigma = 0.3;  // of the applied wrench: prior of a form whose rms is that of the wrench
constexpr std::size_t kBatch = 48;       // columns that pass through the filter together
constexpr std::size_t kFitted = 3;       // forms that are fitted in full

void take_amplitudes(const Fit& fit, FormulaFound& found) {
  const Eigen::VectorXd sigma = fit.sigma();
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].kind != likelihood::NumberKind::kWeight) continue;
    const auto k = static_cast<std::size_t>(fit.numbers[j].index);
    found.amplitude.push_back(fit.hypothesis.force.weights[k] * fit.hypothesis.force.features[k].scale);
    found.amplitude_sigma.push_back(sigma[static_cast<Eigen::Index>(j)] * fit.hypothesis.force.features[k].scale);
  }
}

/// One form at one value of its inner number, as a group of a library.
struct Place {
  std::size_t form{};
  double inner{};
  double gain{};  ///< nats of the linear solution, the model's own numbers projected out
};

void score(const Problem& problem, const inference::Seen& seen, const std::vector<Form>& forms,
           std::vector<Place>& places, int threads) {
  std::vector<std::pair<std::size_t, std::size_t>> batches;  // [first, last) of the places
  std::size_t columns = kBatch;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t count = forms[places[k].form].features(places[k].inner).size();
    if (columns + count > kBatch) batches.emplace_back(k, k), columns = 0;
    columns += count;
    batches.back().second = k + 1;
  }
  for_each_index(batches.size(), threads, [&](std::size_t b) {
    likelihood::FreeForce library;
    std::vector<std::size_t> groups, beginnings;
    for (std::size_t k = batches[b].first; k < batches[b].second; ++k) {
      const std::vector<Feature> features = forms[places[k].form].features(places[k].inner);
      beginnings.push_back(library.features.size());
      groups.push_back(groups.size());
      library.groups.push_back(
          {.first = static_cast<int>(library.features.size()), .count = static_cast<int>(features.size())});
      library.features.insert(library.features.end(), features.begin(), features.end());
    }
    likelihood::ResponseSums sums;
    for (std::size_t r = 0; r < problem.runs.size(); ++r) {
      inference::FeatureColumns source{problem, seen, library, groups, r};
      likelihood::respond(
          problem, seen.reference[r], r, library.features.size(), beginnings,
          [&](std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut) {
            source.at(block, acceleration);
          },
          sums);
    }
    Eigen::MatrixXd gram = sums.gram.selfadjointView<Eigen::Lower>();
    gram -= sums.with_numbers.transpose() * (seen.covariance * sums.with_numbers);
    sums.gradient -= sums.with_numbers.transpose() * seen.step;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto first = static_cast<Eigen::Index>(library.groups[g].first);
      const auto count = static_cast<Eigen::Index>(library.groups[g].count);
      Eigen::MatrixXd G = gram.block(first, first, count, count);
      G.diagonal() *= 1.0 + 1e-9;
      const Eigen::VectorXd slope = sums.gradient.segment(first, count);
      const double gain = 0.5 * slope.dot(solve_symmetric(G, slope));
      places[batches[b].first + g].gain = std::isfinite(gain) && G.diagonal().minCoeff() > 0.0 ? gain : 0.0;
    }
  });
}

/// Best inner number of each form, twice refined about its best grid point.
std::vector<Place> best_places(const Problem& problem, const inference::Seen& seen, const std::vector<Form>& forms,
                               int threads) {
  std::vector<Place> places;
  for (std::size_t f = 0; f < forms.size(); ++f)
    for (const double inner : forms[f].grid) places.push_back({f, inner});
  score(problem, seen, forms, places, threads);
  std::map<std::size_t, Place> best;
  const auto take = [&](const std::vector<Place>& scored) {
    for (const Place& place : scored) {
      const auto [held, fresh] = best.try_emplace(place.form, place);
      if (!fresh && place.gain > held->second.gain) held->second = place;
    }
  };
  take(places);
  std::vector<Place> order;
  const auto sort = [&] {
    order.clear();
    for (const auto& [form, place] : best) order.push_back(place);
    std::ranges::sort(order, std::greater{}, [&](const Place& p) { return p.gain - forms[p.form].price; });
    if (order.size() > kFitted) order.resize(kFitted);
  };
  sort();
  for (const double part : {0.5, 0.2, 0.06}) {
    std::vector<Place> finer;
    for (const Place& place : order) {
      const Form& form = forms[place.form];
      if (form.symbol.empty()) continue;
      const double step = part * (form.grid[1] - form.grid[0]);
      for (const int side : {-2, -1, 1, 2})  // below its grid a law has no slope at rest
        finer.push_back({place.form, std::max(form.grid.front(), place.inner + 0.5 * side * step)});
    }
    if (finer.empty()) break;
    score(problem, seen, forms, finer, threads);
    take(finer);
    sort();
  }
  return order;
}

/// From the curvature of the gain about the inner number.
double inner_sigma(const Problem& problem, const inference::Seen& seen, const std::vector<Form>& forms,
                   const Place& place, int threads) {
  const Form& form = forms[place.form];
  if (form.symbol.empty()) return 0.0;
  const double step = 0.1 * (form.grid[1] - form.grid[0]);
  std::vector<Place> three{
      {place.form, place.inner - step}, {place.form, place.inner}, {place.form, place.inner + step}};
  score(problem, seen, forms, three, threads);
  const double curvature = (2.0 * three[1].gain - three[0].gain - three[2].gain) / (step * step);
  return curvature > 0.0 ? 1.0 / std::sqrt(curvature) : step;
}

double rms_of(const Problem& problem, const inference::Seen& seen, const Feature& feature) {
  double square = 0.0, count = 0.0;
  const std::vector<likelihood::Number> none;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    likelihood::Plant plant{seen.fit.hypothesis, none, problem.runs[r], r, false};
    plant.begin(problem.runs[r].start());
    for (std::size_t b = 0; b < problem.runs[r].blocks().size(); ++b) {
      plant.at_middle(b);
      const model::FeatureState state =
          plant.features_at(seen.reference[r].nu_middle.col(static_cast<Eigen::Index>(b)), false);
      const double value = feature.value(state);
      square += value * value;
      count += 1.0;
    }
  }
  return std::sqrt(square / std::max(count, 1.0));
}

}  // namespace

std::optional<FormulaFound> find_formula(const Problem& problem, const Fit& base, const model::Scene& scene,
                                         const inference::FreeForceFound& found, int threads,
                                         const Progress& progress) {
  begin(progress, kClosed, 1.0 + kFitted);  // the first is to look at all of them
  // Beside the base numbers, with the noise that the learned force leaves: the random force has swallowed nothing
  // there.
  Fit quiet = base;
  quiet.noise = found.fit.noise;
  const inference::Seen seen = inference::see(problem, quiet, threads);
  const std::vector<Form> forms = grammar(problem, scene, found);
  if (forms.empty()) return std::nullopt;
  double paid = 0.0;  // by the learned force
  if (found.fit.finite) paid = found.fit.log_evidence - base.log_evidence - found.log_odds;
  std::optional<FormulaFound> best;
  const std::vector<Place> places = best_places(problem, seen, forms, threads);
  for (const Place& place : places) {
    progress.done(kClosed.phase);
    const Form& form = forms[place.form];
    likelihood::Hypothesis hypothesis = base.hypothesis;
    model::FreeForce& force = hypothesis.force = {};
    force.features = form.features(place.inner);
    const double wrench = form.axis < kWorldAxis ? scene.tau_rms[form.axis] : scene.tau_rms.head<3>().norm();
    for (Feature& feature : force.features) {
      if (form.axis >= model::kHullDrag) continue;  // as the learned force has them
      const double rms = rms_of(problem, seen, feature);
      feature.scale = rms > 0.0 ? std::max(wrench, 1e-6) / rms : 0.0;
    }
    force.weights.assign(force.features.size(), 0.0);
    force.groups.push_back({.kind = form.words,
                            .axis = form.axis,
                            .count = static_cast<int>(force.features.size()),
                            .sigma = kAmplitudeSigma,
                            .closed = true});
    Fit fit = likelihood::fit(problem, hypothesis, found.fit.noise,
                              {.noise_rounds = 2, .steps = 3, .enough = 0.3, .threads = threads});
    if (!fit.finite) continue;
    const double price = std::log(static_cast<double>(forms.size())) + form.price;
    const double over = fit.log_evidence - price - (found.fit.log_evidence - std::max(paid, 0.0));
    if (best && over <= best->over_learned) continue;
    FormulaFound one{.form = form,
                     .inner = place.inner,
                     .over_learned = over,
                     .over_base = fit.log_evidence - price - base.log_evidence};
    one.inner_sigma = inner_sigma(problem, seen, forms, place, threads);
    take_amplitudes(fit, one);
    one.fit = std::move(fit);
    best = std::move(one);
  }
  progress.expect(kClosed.phase, 0);
  return best;
}

std::optional<FormulaFound> as_formula(const inference::FreeForceFound& found) {
  const model::FreeForce& force = found.fit.hypothesis.force;
  if (!found.fit.finite || !model::is_law(force)) return std::nullopt;
  FormulaFound formula{.fit = found.fit};
  formula.form.axis = force.features.front().axis;
  std::size_t named = 0;
  for (std::size_t g = 0; g < force.groups.size(); ++g) {
    const model::FeatureGroup& group = force.groups[g];
    const std::vector<Feature> features(force.features.begin() + group.first,
                                        force.features.begin() + group.first + group.count);
    std::string sum = equation_of(features);
    if (force.features.size() > 1) {  // numbered through all groups
      std::string numbered;
      for (std::size_t k = 0; k < features.size(); ++k) {
        const std::string product = features[k].words();
        numbered += (k == 0 ? "c_" : " + c_") + std::to_string(++named) + (product.empty() ? "" : " ") + product;
      }
      sum = features.size() > 1 && group.axis >= model::kHullDrag ? "(" + numbered + ")" : numbered;
    }
    formula.form.words += (g == 0 ? "" : "; ") + inference::words({.kind = group.kind, .axis = group.axis});
    formula.form.equation += (g == 0 ? "" : ", ") + model::direction_symbol(group.axis) + " " + sum;
  }
  take_amplitudes(found.fit, formula);
  return formula;
}

FormulaGiven given_of(const FormulaFound& found) {
  const auto text = [](const char* format, double a, double b) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, format, a, b);
    return std::string{buffer};
  };
  FormulaGiven given{.equation = found.form.equation, .over_learned = found.over_learned};
  const std::string along = model::direction_words(found.form.axis);
  const bool told = found.form.words.find(along) != std::string::npos;  // "drag of the hull, near ..." says it already
  given.words = "A closed form fits: " + (told ? std::string{} : "along " + along + ", with ") + found.form.words +
                ": " + found.form.equation;
  for (std::size_t k = 0; k < found.amplitude.size(); ++k) {
    const std::string name = found.amplitude.size() == 1 ? "c" : "c_" + std::to_string(k + 1);
    given.numbers.push_back({name, found.amplitude[k], found.amplitude_sigma[k], "SI"});
    given.words += ", " + name + text(" = %.3g ± %.2g", found.amplitude[k], 1.96 * found.amplitude_sigma[k]);
  }
  if (!found.form.symbol.empty()) {
    given.numbers.push_back({found.form.symbol, found.inner, found.inner_sigma, found.form.unit});
    given.words += ", " + found.form.symbol + text(" = %.3g ± %.2g", found.inner, 1.96 * found.inner_sigma) +
                   (found.form.unit.empty() ? "" : " " + found.form.unit);
  }
  given.words += " (SI, 95 %).";
  return given;
}

}  // namespace fathom::learning
