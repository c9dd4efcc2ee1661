#include "common/inference/product_features.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace fathom::inference {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::kWorldAxis;
using likelihood::Quantity;

constexpr int kSteps = 4, kDepthBumps = 3, kPlanBumps = 3;
constexpr double kMomentLasts = 0.3,
                 kMomentMargin = 0.05;                   // s; share of the data at its ends where no moment is sought
constexpr double kSmallestRange = 0.05;                  // m
constexpr double kLowestLine = 0.2, kHighestLine = 6.0;  // rad/s
constexpr double kMoves = 1e-3;                          // m/s, rad/s: an axis that does less shows nothing

/// Features of one term of the base model, which a modulator multiplies.
struct Term {
  std::string name;
  int axis{};
  std::vector<std::vector<Factor>> parts;
  bool of_place{false};  ///< the library has it with place, or time, already
  bool of_time{false};
};

Factor velocity(int axis) { return {.quantity = Quantity::kVelocity, .index = axis}; }
Factor speed(int axis) { return {.quantity = Quantity::kSpeed, .index = axis}; }

std::vector<Term> terms_of(const likelihood::Problem& problem, const model::Scene& scene) {
  std::vector<Term> terms;
  const auto& axes = problem.axes;
  const auto simulated = [&](int axis) {
    return std::find(axes.begin(), axes.begin() + problem.simulated, axis) != axes.begin() + problem.simulated;
  };
  for (int i = 0; i < problem.simulated; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)];
    const std::string name = model::kAxisNames[static_cast<std::size_t>(axis)];
    terms.push_back({"drag in " + name, axis, {{velocity(axis)}, {speed(axis), velocity(axis)}}});
    terms.push_back({"thrust in " + name, axis, {{{.quantity = Quantity::kWrench, .index = axis}}}, false, true});
  }
  if (!scene.attitude) return terms;
  if (simulated(2)) terms.push_back({"buoyancy", kWorldAxis + 2, {{}}});
  if (simulated(0) && simulated(1)) {
    terms.push_back({"a force toward north", kWorldAxis, {{}}, true});
    terms.push_back({"a force toward east", kWorldAxis + 1, {{}}, true});
    terms.push_back({"flow toward north", kWorldAxis, {{{.quantity = Quantity::kFlowSpeed}}}});
    terms.push_back({"flow toward east", kWorldAxis + 1, {{{.quantity = Quantity::kFlowSpeed}}}});
  }
  return terms;
}

class Products {
 public:
  Products(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
           const std::vector<Eigen::MatrixXd>& adjoint, likelihood::FreeForce& force)
      : problem_{problem}, seen_{seen}, scene_{scene}, force_{force}, terms_{terms_of(problem, scene)} {
    slopes(adjoint);
  }

  void make() {
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      term_ = &terms_[k];
      time(k);
      place();
      motion();
      inputs();
    }
  }

 private:
  void begin(const std::string& modulator, bool searched = false) {
    force_.groups.push_back({.kind = term_->name + ", with " + modulator,
                             .axis = term_->axis,
                             .first = static_cast<int>(force_.features.size()),
                             .searched = searched});
  }
  void times(const Factor& modulator) {
    for (const std::vector<Factor>& part : term_->parts) {
      Feature feature{.axis = term_->axis, .count = static_cast<int>(part.size()) + 1};
      std::ranges::copy(part, feature.factors.begin());
      feature.factors[part.size()] = modulator;
      force_.features.push_back(feature);
      ++force_.groups.back().count;
    }
  }
  void end() {
    if (force_.groups.back().count == 0) force_.groups.pop_back();
  }

  void time(std::size_t k) {
    const double length = problem_.t_high - problem_.t_low;
    if (!term_->of_time) {
      begin("time");
      for (int i = 0; i < kSteps; ++i)
        times({.quantity = Quantity::kAfter, .a = problem_.t_low + length * (i + 0.5) / kSteps, .b = length / kSteps});
    }
    begin("a moment", true);
    times({.quantity = Quantity::kAfter, .a = moment(k), .b = kMomentLasts});
    begin("a swing", true);
    const double omega = line(k);
    times({.quantity = Quantity::kToneCosine, .a = omega});
    times({.quantity = Quantity::kToneSine, .a = omega});
  }

  void place() {
    if (scene_.position) {
      const double low = scene_.p_low.z(), range = scene_.p_high.z() - low;
      if (range > kSmallestRange) {
        begin("depth");
        const double width = range / (kDepthBumps - 1);
        for (int i = 0; i < kDepthBumps; ++i)
          times({.quantity = Quantity::kDepthBump, .a = low + i * width, .b = width});
      }
      const Eigen::Vector3d wide = scene_.p_high - scene_.p_low;
      const double width = std::max(wide.head<2>().maxCoeff() / (kPlanBumps - 1), kSmallestRange);
      begin("place");
      for (int i = 0; i < kPlanBumps && !term_->of_place; ++i) {
        for (int j = 0; j < kPlanBumps; ++j)
          times({.quantity = Quantity::kPlanBump,
                 .a = scene_.p_low.x() + wide.x() * i / (kPlanBumps - 1),
                 .b = scene_.p_low.y() + wide.y() * j / (kPlanBumps - 1),
                 .c = width});
      }
      end();
    }
    if (!scene_.attitude) return;
    begin("heading");
    for (int n = 1; n <= 2; ++n) {
      times({.quantity = Quantity::kHeadingCosine, .index = n});
      times({.quantity = Quantity::kHeadingSine, .index = n});
    }
  }

  void motion() {
    begin("speed");
    times({.quantity = Quantity::kFlowSpeed});
    for (int j = 0; j < 6; ++j) {
      if (scene_.nu_rms[j] <= kMoves) continue;
      times(speed(j));
    }
    end();
  }

  void inputs() {
    begin("other thrust");
    for (int i = 0; i < problem_.simulated; ++i) {
      const int axis = problem_.axes[static_cast<std::size_t>(i)];
      times({.quantity = Quantity::kWrenchSize, .index = axis});
    }
    end();
  }

  /// d log L / d amplitude of every term, block by block, in one pass: terms x blocks per run.
  void slopes(const std::vector<Eigen::MatrixXd>& adjoint) {
    const std::vector<likelihood::Number> none;
    for (std::size_t r = 0; r < problem_.runs.size(); ++r) {
      likelihood::Plant plant{seen_.fit.hypothesis, none, problem_.runs[r], r, false};
      plant.begin(problem_.runs[r].start());
      const auto blocks = static_cast<Eigen::Index>(problem_.runs[r].blocks().size());
      Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(terms_.size()), blocks);
      for (Eigen::Index b = 0; b < blocks; ++b) {
        plant.at_middle(static_cast<std::size_t>(b));
        likelihood::FeatureState state = plant.features();
        state.nu = seen_.reference[r].nu_middle.col(b);
        const Matrix6d inverse = seen_.inverse[r].col(b).reshaped(6, 6);
        for (std::size_t k = 0; k < terms_.size(); ++k) {
          Feature feature{.axis = terms_[k].axis, .count = static_cast<int>(terms_[k].parts.back().size())};
          std::ranges::copy(terms_[k].parts.back(), feature.factors.begin());
          Vector6d wrench = Vector6d::Zero();
          feature.add(state, 1.0, wrench);
          const Vector6d nu_dot = inverse * wrench;
          for (int i = 0; i < problem_.simulated; ++i)
            slope(static_cast<Eigen::Index>(k), b) +=
                adjoint[r](i, b) * nu_dot[problem_.axes[static_cast<std::size_t>(i)]];
        }
        plant.end_block(static_cast<std::size_t>(b), seen_.reference[r].nu_end.col(b));
      }
      slope_.push_back(std::move(slope));
    }
  }

  [[nodiscard]] double moment(std::size_t k) const {
    const double margin = kMomentMargin * (problem_.t_high - problem_.t_low);
    double sum = 0.0, most = 0.0, at = 0.5 * (problem_.t_low + problem_.t_high);
    for (std::size_t r = slope_.size(); r-- > 0;) {
      const auto& blocks = problem_.runs[r].blocks();
      for (std::size_t b = blocks.size(); b-- > 0;) {
        sum += slope_[r](static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(b));
        const double t = problem_.runs[r].trial().t[blocks[b].first];
        if (t < problem_.t_low + margin || t > problem_.t_high - margin || std::abs(sum) <= most) continue;
        most = std::abs(sum);
        at = t;
      }
    }
    return at;
  }

  /// Strongest line of the longest run, rad/s.
  [[nodiscard]] double line(std::size_t k) const {
    std::size_t longest = 0;
    for (std::size_t r = 0; r < slope_.size(); ++r) {
      if (slope_[r].cols() > slope_[longest].cols()) longest = r;
    }
    const likelihood::RunData& run = problem_.runs[longest];
    const auto& blocks = run.blocks();
    constexpr double kCoarse = 0.2;  // s, that slopes are summed over: a fifth of the shortest period
    const auto together = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(kCoarse / blocks.front().dt));
    std::vector<double> series;
    for (Eigen::Index b = 0; b + together <= slope_[longest].cols(); b += together)
      series.push_back(slope_[longest].row(static_cast<Eigen::Index>(k)).segment(b, together).sum());
    const double dt = static_cast<double>(together) * blocks.front().dt;
    const double spacing = std::numbers::pi / std::max(run.last_time() - run.first_time(), 1.0);
    double most = -1.0, at = kLowestLine;
    for (double omega = kLowestLine; omega < kHighestLine; omega += spacing) {
      std::complex<double> sum{}, turned{1.0, 0.0};
      const std::complex<double> turn{std::cos(omega * dt), std::sin(omega * dt)};
      for (const double x : series) {
        sum += x * turned;
        turned *= turn;
      }
      if (std::norm(sum) <= most) continue;
      most = std::norm(sum);
      at = omega;
    }
    return at;
  }

  const likelihood::Problem& problem_;
  const Seen& seen_;
  const model::Scene& scene_;
  likelihood::FreeForce& force_;
  std::vector<Term> terms_;
  const Term* term_{};
  std::vector<Eigen::MatrixXd> slope_;
};

}  // namespace

void add_products(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                  const std::vector<Eigen::MatrixXd>& adjoint, likelihood::FreeForce& force) {
  Products{problem, seen, scene, adjoint, force}.make();
}

}  // namespace fathom::inference
