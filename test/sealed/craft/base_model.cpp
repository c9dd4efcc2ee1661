#include "test/sealed/craft/base_model.hpp"

#include <Eigen/Cholesky>

#include "test/sealed/craft/flow.hpp"

namespace fathom::sealed {
namespace {

constexpr std::size_t kEvery = 4;  // samples: motion is slow, rows are many
constexpr std::size_t kSpan = 10;  // samples
constexpr std::array<const char*, 6> kAxes{"X", "Y", "Z", "K", "M", "N"};
constexpr std::array<const char*, 6> kSpeeds{"u", "v", "w", "p", "q", "r"};

/// One base number: which kind, and of which axis.
struct Number {
  enum Kind { kMass, kLinear, kQuadratic, kWeight, kMoment } kind;
  int axis;
};

std::vector<Number> numbers_of(const Craft& craft) {
  std::vector<Number> list;
  const auto driven = [&](int i) { return craft.moves[static_cast<std::size_t>(i)]; };
  for (const auto kind : {Number::kMass, Number::kLinear, Number::kQuadratic}) {
    for (int i = 0; i < 6; ++i) {
      const bool about = kind == Number::kMass && i == 3 && driven(4) && driven(5);  // (I_X - I_Y) p q
      if (driven(i) || about) list.push_back({kind, i});
    }
  }
  if (driven(2)) list.push_back({Number::kWeight, 2});
  if (craft.states_moments && (driven(3) || driven(4))) {
    for (int i = 0; i < 3; ++i) {
      if (i != 1 || driven(3)) list.push_back({Number::kMoment, i});
    }
  }
  return list;
}

/// Derivative of the sensed speed: the true one where the instruments are honest, else a central difference over a span
/// that does not make a spike of a reading that jumps.
Vector6 acceleration(const Dive& run, std::size_t k) {
  constexpr double kHonest = 1e-12;
  const auto& nu = run.sensed.nu;
  const auto honest = [&](std::size_t i) {
    return (nu[i] - run.state[i].segment<6>(kSpeed)).cwiseAbs().maxCoeff() < kHonest;
  };
  if (honest(k - kSpan) && honest(k) && honest(k + kSpan)) return run.nu_dot[k];
  return (nu[k + kSpan] - nu[k - kSpan]) / (2.0 * static_cast<double>(kSpan) * run.dt);
}

}  // namespace

std::vector<std::string> base_names(const Craft& craft) {
  std::vector<std::string> names;
  for (const Number& n : numbers_of(craft)) {
    const auto i = static_cast<std::size_t>(n.axis);
    const std::string axis = kAxes[i], speed = kSpeeds[i];
    switch (n.kind) {
      case Number::kMass:
        names.push_back(n.axis < 3 ? "m_" + axis : std::string("I_") + "XYZ"[i - 3]);
        break;
      case Number::kLinear:
        names.push_back(axis + "_" + speed);
        break;
      case Number::kQuadratic:
        names.push_back(axis + "_" + speed + "|" + speed + "|");
        break;
      case Number::kWeight:
        names.emplace_back("W-B");
        break;
      case Number::kMoment:
        names.push_back(std::string("G_") + "xyz"[i]);
        break;
    }
  }
  return names;
}

Eigen::VectorXd base_values(const Craft& craft, const Hull& hull) {
  const auto list = numbers_of(craft);
  Eigen::VectorXd values(static_cast<Eigen::Index>(list.size()));
  for (std::size_t j = 0; j < list.size(); ++j) {
    const int i = list[j].axis;
    double& value = values[static_cast<Eigen::Index>(j)];
    switch (list[j].kind) {
      case Number::kMass:
        value = hull.added[i] + (i < 3 ? hull.mass : hull.inertia[i - 3]);
        break;
      case Number::kLinear:
        value = -hull.linear[i];
        break;
      case Number::kQuadratic:
        value = -hull.quadratic[i];
        break;
      case Number::kWeight:
        value = hull.net_weight;
        break;
      case Number::kMoment:
        value = hull.first_moment[i];
        break;
    }
  }
  return values;
}

Hull hull_with(const Craft& craft, Hull hull, const Eigen::VectorXd& values) {
  const auto list = numbers_of(craft);
  for (std::size_t j = 0; j < list.size(); ++j) {
    const int i = list[j].axis;
    const double value = values[static_cast<Eigen::Index>(j)];
    switch (list[j].kind) {
      case Number::kMass:
        hull.added[i] = value - (i < 3 ? hull.mass : hull.inertia[i - 3]);
        break;
      case Number::kLinear:
        hull.linear[i] = -value;
        break;
      case Number::kQuadratic:
        hull.quadratic[i] = -value;
        break;
      case Number::kWeight:
        hull.net_weight = value;
        break;
      case Number::kMoment:
        hull.first_moment[i] = value;
        break;
    }
  }
  return hull;
}

void base_rows(const Craft& craft, const Vector6& nu_dot, const Vector6& nu, const Eigen::Vector3d& down,
               Eigen::Ref<Eigen::MatrixXd> rows) {
  rows.setZero();
  const double u = nu[0], v = nu[1], w = nu[2], p = nu[3], q = nu[4], r = nu[5];
  const auto list = numbers_of(craft);
  for (std::size_t j = 0; j < list.size(); ++j) {
    Vector6 column = Vector6::Zero();
    const int i = list[j].axis;
    switch (list[j].kind) {
      case Number::kMass:
        column[i] = nu_dot[i];
        switch (i) {  // Fossen 2011, eq. 6.43 with a diagonal mass matrix
          case 0:
            column[1] += r * u, column[2] -= q * u, column[4] += u * w, column[5] -= u * v;
            break;
          case 1:
            column[0] -= r * v, column[2] += p * v, column[3] -= v * w, column[5] += u * v;
            break;
          case 2:
            column[0] += q * w, column[1] -= p * w, column[3] += v * w, column[4] -= u * w;
            break;
          case 3:
            column[4] += p * r, column[5] -= p * q;
            break;
          case 4:
            column[3] -= q * r, column[5] += p * q;
            break;
          default:
            column[3] += q * r, column[4] -= p * r;
            break;
        }
        break;
      case Number::kLinear:
        column[i] = -nu[i];
        break;
      case Number::kQuadratic:
        column[i] = -std::abs(nu[i]) * nu[i];
        break;
      case Number::kWeight:
        column.head<3>() = -down;
        break;
      case Number::kMoment: {
        const Eigen::Vector3d unit = Eigen::Vector3d::Unit(i);
        column.tail<3>() << unit[2] * down[1] - unit[1] * down[2], unit[0] * down[2] - unit[2] * down[0],
            unit[1] * down[0] - unit[0] * down[1];
        break;
      }
    }
    Eigen::Index row = 0;
    for (int axis = 0; axis < 6; ++axis) {
      if (craft.moves[static_cast<std::size_t>(axis)]) rows(row++, static_cast<Eigen::Index>(j)) = column[axis];
    }
  }
}

BaseFit fit_base(const Craft& craft, std::span<const Dive> runs) {
  const auto count = static_cast<Eigen::Index>(numbers_of(craft).size());
  const auto allocation = craft.allocation();
  const bool flows = craft.craft_class != CraftClass::kRov;
  const auto pushed = [&](const Dive& run, std::size_t k) -> Vector6 {
    if (!flows) return allocation * run.command(k);
    return push_of(craft, acting_forces(craft, run.command(k), run.sensed.nu[k]),
                   turn_of(run.sensed.euler[k]).row(2).transpose());
  };
  // What the flow does to such a craft is no effect: it is known here.
  const auto known = [&](const Dive& run, std::size_t k) -> Vector6 {
    Vector6 tau = pushed(run, k);
    if (flows) tau += flow_wrench(craft, run.command(k), run.sensed.nu[k]);
    return tau;
  };
  std::vector<int> axes;
  for (int i = 0; i < 6; ++i) {
    if (craft.moves[static_cast<std::size_t>(i)]) axes.push_back(i);
  }
  BaseFit fit;
  Vector6 scale = Vector6::Zero();  // N, N m, of each equation; of what is not driven all known forces
  double samples = 0.0;
  const auto every_sample = [&](const auto& use) {
    for (const Dive& run : runs) {
      for (std::size_t k = kSpan; k + kSpan < run.size(); k += kEvery) use(run, k);
    }
  };
  every_sample([&](const Dive& run, std::size_t k) {
    fit.applied += pushed(run, k).cwiseAbs2();
    scale += known(run, k).cwiseAbs2();
    samples += 1.0;
  });
  fit.applied = (fit.applied / samples).cwiseSqrt();
  scale = (scale / samples).cwiseSqrt();
  for (const int axis : axes) {
    if (craft.actuated[static_cast<std::size_t>(axis)]) scale[axis] = fit.applied[axis];
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(axes.size()), count);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  const auto equations = [&](const Dive& run, std::size_t k, const auto& use) {
    base_rows(craft, acceleration(run, k), run.sensed.nu[k], turn_of(run.sensed.euler[k]).row(2), rows);
    const Vector6 tau = known(run, k);
    for (std::size_t a = 0; a < axes.size(); ++a) use(axes[a], rows.row(static_cast<Eigen::Index>(a)), tau[axes[a]]);
  };
  every_sample([&](const Dive& run, std::size_t k) {
    equations(run, k, [&](int axis, const auto& row, double tau) {
      const double weight = 1.0 / (scale[axis] * scale[axis]);
      normal += weight * row.transpose() * row;
      right += weight * tau * row.transpose();
    });
  });
  fit.values = normal.ldlt().solve(right);
  every_sample([&](const Dive& run, std::size_t k) {
    equations(run, k, [&](int axis, const auto& row, double tau) {
      fit.residual[axis] += std::pow(tau - row.dot(fit.values), 2) / samples;
    });
  });
  fit.residual = fit.residual.cwiseSqrt();
  return fit;
}

double added_share(const Craft& craft, const BaseFit& with, const BaseFit& without) {
  double sum = 0.0, axes = 0.0;
  for (int i = 0; i < 6; ++i) {
    if (!craft.actuated[static_cast<std::size_t>(i)]) continue;
    const double before = without.residual[i] / without.applied[i], after = with.residual[i] / with.applied[i];
    sum += std::max(after * after - before * before, 0.0);
    axes += 1.0;
  }
  return std::sqrt(sum / axes);
}

}  // namespace fathom::sealed
