#include "common/diagnosis/linearisation.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/identification/outlier.hpp"

namespace fathom::diagnosis {

using identification::ProjectedWindow;

namespace {

std::vector<std::size_t> all_places(std::size_t count) {
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = i;
  return places;
}

/// At most `most` of them, evenly.
std::vector<std::size_t> spread(std::span<const std::size_t> all, std::size_t most) {
  const std::size_t stride = std::max<std::size_t>(1, (all.size() + most - 1) / most);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < all.size(); i += stride) chosen.push_back(all[i]);
  return chosen;
}

}  // namespace

Linearisation::Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit)
    : Linearisation{problem, fit, problem.linearise(fit), all_places(problem.windows().size())} {}

Linearisation Linearisation::on(std::span<const std::size_t> chosen) const {
  std::vector<ProjectedWindow> windows;
  std::vector<std::size_t> places;
  for (const std::size_t w : chosen) {
    windows.push_back(windows_[w]);
    places.push_back(places_[w]);
  }
  return {problem_, fit_, std::move(windows), std::move(places)};
}

Linearisation Linearisation::thinned(std::size_t most) const { return on(spread(all_places(windows_.size()), most)); }

Linearisation Linearisation::telling(std::size_t most) const {
  std::vector<std::size_t> order = all_places(windows_.size());
  if (order.size() <= most) return on(order);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return window_cost_[a] > window_cost_[b]; });
  const auto half = order.begin() + static_cast<std::ptrdiff_t>(most / 2);
  std::vector<std::size_t> chosen(order.begin(), half), others(half, order.end());
  std::ranges::sort(others);
  std::ranges::copy(spread(others, most - chosen.size()), std::back_inserter(chosen));
  std::ranges::sort(chosen);
  return on(chosen);
}

Linearisation::Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                             std::vector<ProjectedWindow> windows, std::vector<std::size_t> places)
    : problem_{problem}, fit_{fit}, windows_{std::move(windows)}, places_{std::move(places)} {
  const identification::ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    information(i, i) = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
  }
  for (const ProjectedWindow& window : windows_) information += window.jacobian.transpose() * window.jacobian;
  information_.compute(information);
  unexplained_ = stacked_residual();
  remove_base(unexplained_);
  window_cost_ = window_costs(unexplained_.col(0));
}

Eigen::VectorXd Linearisation::stacked_residual() const {
  Eigen::Index rows = 0;
  for (const ProjectedWindow& window : windows_) rows += window.residual.size();
  Eigen::VectorXd all(rows);
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : windows_) {
    all.segment(offset, window.residual.size()) = window.residual;
    offset += window.residual.size();
  }
  return all;
}

void Linearisation::remove_base(Eigen::MatrixXd& columns) const {
  const auto n = windows_[0].jacobian.cols();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, columns.cols());
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : windows_) {
    product += window.jacobian.transpose() * columns.middleRows(offset, window.jacobian.rows());
    offset += window.jacobian.rows();
  }
  const Eigen::MatrixXd step = information_.solve(product);
  offset = 0;
  for (const ProjectedWindow& window : windows_) {
    columns.middleRows(offset, window.jacobian.rows()) -= window.jacobian * step;
    offset += window.jacobian.rows();
  }
}

void Linearisation::step_base(const Eigen::VectorXd& residual, model::Model& model) const {
  const identification::ParameterMap map{model};
  const Eigen::VectorXd x = map.pack(model);
  Eigen::VectorXd gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    gradient[i] = (free.scale * x[i] - free.prior_mean) * free.scale / (free.prior_sigma * free.prior_sigma);
  }
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : windows_) {
    gradient += window.jacobian.transpose() * residual.segment(offset, window.jacobian.rows());
    offset += window.jacobian.rows();
  }
  Eigen::VectorXd next = x - information_.solve(gradient);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    next[i] = free.at_bound(x[i]) ? x[i] : std::clamp(next[i], free.low / free.scale, free.high / free.scale);
  }
  map.unpack(next, model);
}

std::vector<double> Linearisation::window_costs(const Eigen::VectorXd& residual) const {
  std::vector<double> costs;
  Eigen::Index offset = 0;
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    const ProjectedWindow& window = windows_[w];
    const Eigen::VectorXd alone =
        residual.segment(offset, window.residual.size()).array() / window.weight.array();  // as the fit would see it
    costs.push_back(identification::robust_cost(alone, problem_.windows()[places_[w]].axes()));
    offset += window.residual.size();
  }
  return costs;
}

}  // namespace fathom::diagnosis
