// Derivatives from trials of the half-scale PAP-104: rates over seeds, the water's velocity, what was assumed varied.
#include "common/identification/regression/manoeuvre_regression.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "common/base/error.hpp"
#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"
#include "test/support/timing.hpp"
#include "test/support/trial_recording.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::identification {
namespace {

using model::ManoeuvreKind;

constexpr double kRowEvery = 0.1;  // s
constexpr double kMemory = 0.9;    // phi of the disturbance, from row to row

model::Manoeuvre manoeuvre(ManoeuvreKind kind) {
  return {.kind = kind, .difference = kind == ManoeuvreKind::kZigzag ? 4.5 : 3.2};
}

/// What exact instruments tell of a flight whose water moves with v_WF. Nothing about the hull's forces changes: the
/// motion through the water is the same, and so is the inertial acceleration.
ManoeuvreRows exact_rows(const model::Vehicle& vehicle, ManoeuvreKind kind,
                         const Eigen::Vector3d& v_WF = Eigen::Vector3d::Zero()) {
  ManoeuvreRows rows{.name = "exact", .dt = kRowEvery, .stretches = {{}}, .known_from = ""};
  for (const model::FlightMoment& m : model::fly(vehicle, manoeuvre(kind), kRowEvery)) {
    const Vector6d tau = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
    ManoeuvreRows::Row row{m.q_WB, m.nu, m.nu_dot, tau + m.umbilical + m.chain};
    const Eigen::Vector3d v_F = m.q_WB.conjugate() * v_WF;
    row.nu.head<3>() += v_F;
    row.nu_dot.head<3>() -= m.nu.tail<3>().cross(v_F);
    rows.stretches.front().push_back(row);
  }
  return rows;
}

std::vector<ManoeuvreRows> three_manoeuvres(const model::Vehicle& vehicle,
                                            const Eigen::Vector3d& v_WF = Eigen::Vector3d::Zero()) {
  std::vector<ManoeuvreRows> runs;
  for (const auto kind : {ManoeuvreKind::kLine, ManoeuvreKind::kZigzag, ManoeuvreKind::kCircle}) {
    runs.push_back(exact_rows(vehicle, kind, v_WF));
  }
  return runs;
}

/// A force with memory that nothing measures.
void disturb(std::vector<ManoeuvreRows>& runs, unsigned seed, double phi, double share = 1.0) {
  Vector6d sigma;
  sigma << 0.3, 0.3, 0.3, 0.02, 0.1, 0.1;  // N, N m
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  for (auto& run : runs) {
    Vector6d z = Vector6d::Zero();
    for (auto& row : run.stretches.front()) {
      for (int i = 0; i < 6; ++i) z[i] = phi * z[i] + std::sqrt(1.0 - phi * phi) * share * sigma[i] * normal(random);
      row.known -= z;
    }
  }
}

const SelectedTerm* find(const StepwiseResult& result, const AxisCandidates& candidates, const std::string& name) {
  for (const SelectedTerm& term : result.terms) {
    if (candidates.names[static_cast<std::size_t>(term.column)] == name) return &term;
  }
  return nullptr;
}

const SelectedTerm* find(const std::vector<AxisRegression>& axes, const std::string& name) {
  for (const AxisRegression& axis : axes) {
    if (const SelectedTerm* term = find(axis.together, axis.candidates, name)) return term;
  }
  return nullptr;
}

std::map<std::string, double> truth_of(const model::Vehicle& vehicle) {
  std::map<std::string, double> truth;
  for (const auto& one : vehicle.hydrodynamics->coefficients) truth[std::string{one.term->name}] = one.value;
  return truth;
}

struct Rates {
  std::map<std::string, int> hits;
  double absent{}, false_ones{};
  double square{};  ///< mean of (error / standard error)^2, of equations that hold exactly the terms that act
};

Rates rates(const model::Vehicle& vehicle, const std::vector<ManoeuvreRows>& runs, bool honest, unsigned seeds) {
  RegressionSettings settings;
  settings.errors = false;  // instruments are exact here, and it is scatter that is judged
  settings.stepwise.autoregressive = settings.stepwise.effective_samples = honest;
  const auto truth = truth_of(vehicle);
  Rates result;
  double selected = 0.0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    auto disturbed = runs;
    disturb(disturbed, seed, kMemory);
    for (const AxisRegression& axis : regress(vehicle, disturbed, settings)) {
      bool whole = true;
      double square = 0.0;
      for (const std::string& name : axis.candidates.names) {
        const SelectedTerm* term = find(axis.together, axis.candidates, name);
        const auto acts = truth.find(name);
        whole = whole && (term != nullptr) == (acts != truth.end());
        if (acts == truth.end()) {
          result.absent += 1.0;
          result.false_ones += term != nullptr ? 1.0 : 0.0;
        } else if (term != nullptr) {
          ++result.hits[name];
          square += std::pow((term->value - acts->second) / term->sigma, 2);
        }
      }
      if (!whole) continue;
      result.square += square;
      selected += static_cast<double>(axis.together.terms.size());
    }
  }
  result.square /= std::max(selected, 1.0);
  return result;
}

}  // namespace

TEST_CASE("regress: without disturbance the vehicle file's derivatives come back, dimensionless") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  auto runs = three_manoeuvres(vehicle);
  disturb(runs, 1, 0.0, 1e-3);
  const auto axes = regress(vehicle, runs, {});
  for (const auto& known : truth_of(vehicle)) {
    CAPTURE(known.first);
    const SelectedTerm* term = find(axes, known.first);
    REQUIRE(term != nullptr);
    CHECK(term->value == doctest::Approx(known.second).epsilon(0.02));
  }
}

TEST_CASE("regress: of three manoeuvres what acts is selected and the rest refused; plain least squares is fooled") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  const auto runs = three_manoeuvres(vehicle);
  const unsigned seeds = test::seeds(50);
  Rates honest = rates(vehicle, runs, true, seeds), plain = rates(vehicle, runs, false, seeds);
  MESSAGE("selected of what does not act: AR(1) "
          << 100.0 * honest.false_ones / honest.absent << " %, plain " << 100.0 * plain.false_ones / plain.absent
          << " %; mean square of error over standard error: " << honest.square << " and " << plain.square);
  for (const char* strong : {"X_uu", "Z_uw", "M_uw", "M_uq", "N_ur", "N_r|r|"}) {
    CAPTURE(strong);
    CHECK(honest.hits[strong] >= static_cast<int>(0.96 * seeds));
  }
  CHECK(honest.false_ones < 0.04 * honest.absent);
  CHECK(plain.false_ones > 4.0 * honest.false_ones);
  CHECK(honest.square > 0.7);
  CHECK(honest.square < 1.4);
  CHECK(plain.square > 4.0);  // one sample in twenty is independent
}

TEST_CASE("regress: a gain that a load cell has wrong is inside the error that is told, and not in the scatter") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  auto runs = three_manoeuvres(vehicle);
  disturb(runs, 1, 0.0, 0.1);
  for (ManoeuvreRows& run : runs) {
    run.cells = 1;  // one for both thrusters and all else
    for (auto& row : run.stretches.front()) {
      row.known *= 1.06;  // two of its standard deviations
      row.parts = {row.known};
    }
  }
  const auto axes = regress(vehicle, runs, {});
  const double truth = truth_of(vehicle).at("X_uu");
  const SelectedTerm* term = find(axes, "X_uu");
  REQUIRE(term != nullptr);
  CHECK(std::abs(term->value - truth) > 1.96 * term->sigma);
  CHECK(std::abs(term->value - truth) < 2.5 * term->total());
  RegressionSettings exact;
  exact.cell_gain = 1e-9;
  const auto without = regress(vehicle, runs, exact);
  CHECK(find(without, "X_uu")->total() < term->total());
  exact.errors = false;
  CHECK(find(regress(vehicle, runs, exact), "X_uu")->total() == find(axes, "X_uu")->sigma);
}

TEST_CASE("regress: a term that another would explain as well is told with it") {
  // In a steady turn u, v and r keep their ratios: products of them are one column but for the beginning.
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  std::vector<ManoeuvreRows> runs{exact_rows(vehicle, ManoeuvreKind::kCircle)};
  disturb(runs, 2, kMemory);
  int told = 0;
  for (const AxisRegression& axis : regress(vehicle, runs, {})) {
    for (const SelectedTerm& term : axis.together.terms) {
      CHECK_FALSE((term.stands() && !term.equivalents.empty()));  // another would do: nobody knows which acts
      told += static_cast<int>(term.equivalents.size());
      for (const int column : term.equivalents)
        CHECK(find(axis.together, axis.candidates, axis.candidates.names[static_cast<std::size_t>(column)]) == nullptr);
    }
  }
  CHECK(told > 0);
}

TEST_CASE("regress: the water's velocity is found from how surge, sway and yaw feel it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  for (const Eigen::Vector3d& v_WF :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.15, -0.1, 0.0), Eigen::Vector3d(-0.08, 0.25, 0.0)}) {
    CAPTURE(v_WF.transpose());
    auto runs = three_manoeuvres(vehicle, v_WF);
    disturb(runs, 2, kMemory);
    const Eigen::Vector3d found = estimate_current(vehicle, runs, {});
    CAPTURE(found.transpose());
    CHECK((found - v_WF).norm() < 0.03);
    // Stated or found, the derivatives are those of still water; taken for still they are not.
    RegressionSettings settings;
    settings.v_WF = found;
    const auto axes = regress(vehicle, runs, settings), still = regress(vehicle, runs, {});
    const SelectedTerm* drag = find(axes, "X_uu");
    REQUIRE(drag != nullptr);
    CHECK(drag->value == doctest::Approx(-0.030).epsilon(0.05));
    if (v_WF.norm() == 0.0) continue;
    const SelectedTerm* blind = find(still, "X_uu");
    CHECK((blind == nullptr || std::abs(blind->value + 0.030) > 0.005));
  }
}

TEST_CASE("trials: what the paper does not publish is varied, and what is found still holds") {
  struct Assumed {
    model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
    estimation::KalmanSettings instruments = test::instruments_from_repository("pap104_half");
    test::TrialSettings trial;
  };
  const std::vector<std::pair<std::string, std::function<void(Assumed&)>>> variations{
      {"as assumed", [](Assumed&) {}},
      {"a hull half as long again", [](Assumed& a) { a.vehicle.hydrodynamics->length *= 1.5; }},
      {"thrusters nearer together",
       [](Assumed& a) {
         a.vehicle.allocation.row(5) *= 0.75;
         for (auto& cell : a.vehicle.hydrodynamics->load_cells) {
           if (cell.of == "thrusters") cell.p_BL.y() *= 0.75;
         }
       }},
      {"a longer umbilical",
       [](Assumed& a) {
         a.vehicle.hydrodynamics->umbilical->paid_out = 15.0;
         a.vehicle.hydrodynamics->umbilical->p_BU.x() = -0.4;
       }},
      {"a chain elsewhere", [](Assumed& a) { a.vehicle.hydrodynamics->chain->p_BC.x() = 0.2; }},
      {"an inertial package elsewhere",
       [](Assumed& a) {
         a.instruments.p_BI = {-0.3, 0.1, 0.05};
       }},
      {"ranges of 20 cm every other second",
       [](Assumed& a) {
         a.instruments.range_noise = 0.2;
         a.trial.range_rate = 0.5;
       }},
      {"a web twice as wide",
       [](Assumed& a) {
         for (auto& one : a.instruments.transponders) one.p_WT.head<2>() *= 2.0;
       }},
      {"accelerometers twice as noisy", [](Assumed& a) { a.instruments.accelerometer_noise *= 2.0; }}};
  for (const auto& variation : variations) {
    CAPTURE(variation.first);
    Assumed a;
    variation.second(a);
    std::vector<ManoeuvreRows> runs;
    for (const auto kind : {ManoeuvreKind::kLine, ManoeuvreKind::kZigzag, ManoeuvreKind::kCircle}) {
      a.trial.manoeuvre = manoeuvre(kind);
      a.trial.seed += 1;
      const auto trial = test::record_trial(a.vehicle, a.instruments, a.trial);
      Recording recording = trial.recording;
      if (runs.empty()) a.instruments = estimation::tune_process(recording, a.instruments);
      recording.smoothed = estimation::smooth(recording, a.instruments).smoothed;
      double square = 0.0;
      for (std::size_t k = 0; k < trial.flight.size(); ++k) {
        square += (recording.smoothed[k].p_WB - trial.flight[k].p_WB).squaredNorm();
      }
      CHECK(std::sqrt(square / static_cast<double>(trial.flight.size())) < 0.2);  // m
      runs.push_back(rows_of(recording, a.vehicle, 1.0 / kRowEvery));
    }
    const auto axes = regress(a.vehicle, runs, {});
    // Load cells show 3 % more or less, of forces several times as large as what the hull's drag leaves of them.
    for (const auto& one : std::map<std::string, double>{{"X_uu", 0.2}, {"N_ur", 0.3}, {"M_uq", 0.3}}) {
      CAPTURE(one.first);
      const SelectedTerm* found = find(axes, one.first);
      REQUIRE(found != nullptr);
      CHECK(found->value == doctest::Approx(truth_of(a.vehicle).at(one.first)).epsilon(one.second));
    }
  }
}

}  // namespace fathom::identification
