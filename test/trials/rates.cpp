// Rates over seeds: consistency of filter and smoother, and selection of terms.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "common/base/spatial.hpp"
#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"
#include "common/identification/regression/manoeuvre_regression.hpp"
#include "test/trials/trials.hpp"

namespace fathom::trials {
namespace {

namespace at = model::at;

/// Of position, velocity in W and attitude, a turn in B.
Eigen::Matrix<double, 9, 1> error_of(const Eigen::VectorXd& x, const Eigen::Matrix3d& R_WB,
                                     const model::FlightMoment& m) {
  Eigen::Matrix<double, 9, 1> e;
  e.head<3>() = x.segment<3>(at::kPosition) - m.p_WB;
  e.segment<3>(3) = x.segment<3>(at::kVelocity) - m.q_WB * m.nu.head<3>();
  e.tail<3>() = rotation_vector_from_quaternion(m.q_WB.conjugate() * Eigen::Quaterniond{R_WB});
  return e;
}

struct Errors {
  double nees{};  ///< per component
  double nis{};
  Eigen::Vector3d filter_early{Eigen::Vector3d::Zero()}, filter_late{Eigen::Vector3d::Zero()};
  Eigen::Vector3d early{Eigen::Vector3d::Zero()}, late{Eigen::Vector3d::Zero()}, apart{Eigen::Vector3d::Zero()};
};

Errors errors_of(const Setup& s, const test::TrialSettings& settings) {
  const auto trial = test::record_trial(s.vehicle, s.instruments, settings);
  Errors result;
  double samples = 0.0, early = 0.0, late = 0.0;
  std::size_t back = trial.flight.size();
  const auto smoothed =
      estimation::smooth(trial.recording, s.instruments,
                         [&](Utime, const Eigen::VectorXd& x, const Eigen::Matrix3d& R_WB, const Eigen::MatrixXd& P) {
                           --back;
                           if (back % 50 != 0) return;
                           const Eigen::Matrix<double, 9, 1> e = error_of(x, R_WB, trial.flight[back]);
                           result.nees += e.dot(P.topLeftCorner<9, 9>().ldlt().solve(e)) / 9.0;
                           samples += 1.0;
                         });
  result.nees /= samples;
  double nis = 0.0, used = 0.0;
  for (const auto& one : smoothed.statistics) {
    nis += one.nis_sum;
    used += static_cast<double>(one.used);
  }
  result.nis = nis / used;
  for (std::size_t k = 0; k < trial.flight.size(); ++k) {
    const Eigen::Vector3d f = (smoothed.filtered[k].p_WB - trial.flight[k].p_WB).cwiseAbs2();
    const Eigen::Vector3d b = (smoothed.smoothed[k].p_WB - trial.flight[k].p_WB).cwiseAbs2();
    const bool first = trial.flight[k].t < 30.0;
    (first ? result.filter_early : result.filter_late) += f;
    (first ? result.early : result.late) += b;
    (first ? early : late) += 1.0;
    if (!first) result.apart += (smoothed.filtered[k].p_WB - smoothed.smoothed[k].p_WB).cwiseAbs();
  }
  result.filter_early = (result.filter_early / early).cwiseSqrt();
  result.early = (result.early / early).cwiseSqrt();
  result.filter_late = (result.filter_late / late).cwiseSqrt();
  result.late = (result.late / late).cwiseSqrt();
  result.apart /= late;
  return result;
}

void line(const char* name, const Errors& e) {
  std::printf("%-34s NEES %.2f NIS %.3f | filter %.2f %.2f | smoother %.3f %.3f m | apart %.1f %.1f %.1f cm\n", name,
              e.nees, e.nis, e.filter_early.norm(), e.filter_late.norm(), e.early.norm(), e.late.norm(),
              100 * e.apart.x(), 100 * e.apart.y(), 100 * e.apart.z());
}

struct Rates {
  std::map<std::string, int> hits;
  int false_ones{};
};

}  // namespace

void consistency(int seeds) {
  const Setup base = setup();
  std::printf("errors: root mean square of position before and after 30 s; NEES and NIS per component, 1 is right\n");
  for (const char* name : {"line", "zigzag", "circle"}) {
    Setup s = base;  // the process noise is tuned on a run of the same kind that is not among the seeds
    const auto apart =
        test::record_trial(s.vehicle, s.instruments, {.manoeuvre = model::manoeuvre_preset(name), .seed = 2000});
    s.instruments = estimation::tune_process(apart.recording, s.instruments);
    Errors mean;
    double lowest = 1e9, highest = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Errors e = errors_of(s, {.manoeuvre = model::manoeuvre_preset(name), .seed = static_cast<unsigned>(seed)});
      mean.nees += e.nees / seeds;
      mean.nis += e.nis / seeds;
      mean.filter_early += e.filter_early / seeds;
      mean.filter_late += e.filter_late / seeds;
      mean.early += e.early / seeds;
      mean.late += e.late / seeds;
      mean.apart += e.apart / seeds;
      lowest = std::min(lowest, e.nees);
      highest = std::max(highest, e.nees);
    }
    line(name, mean);
    std::printf("    NEES of single seeds %.2f to %.2f\n", lowest, highest);
  }
}

void variations() {
  const Setup base = setup();
  const auto show = [&](const char* name, const std::function<void(Setup&, test::TrialSettings&)>& change) {
    Setup s = base;
    test::TrialSettings settings{.manoeuvre = model::manoeuvre_preset("circle"), .seed = 1};
    change(s, settings);
    line(name, errors_of(s, settings));
  };
  show("as assumed", [](Setup&, test::TrialSettings&) {});
  show("inertial package at 100 Hz", [](Setup&, test::TrialSettings& t) { t.inertial_rate = 100.0; });
  show("accelerometers four times as noisy",
       [](Setup& s, test::TrialSettings&) { s.instruments.accelerometer_noise *= 4.0; });
  show("ranges 30 cm", [](Setup& s, test::TrialSettings&) { s.instruments.range_noise = 0.3; });
  show("ranges every 3 s", [](Setup&, test::TrialSettings& t) { t.range_rate = 1.0 / 3.0; });
  show("half of the ranges lost", [](Setup&, test::TrialSettings& t) { t.drop_outs = 0.5; });
  show("one in ten an outlier", [](Setup&, test::TrialSettings& t) { t.outliers = 0.1; });
  show("web twice as wide", [](Setup& s, test::TrialSettings&) {
    for (auto& one : s.instruments.transponders) one.p_WT.head<2>() *= 2.0;
  });
  show("a hull half as long again", [](Setup& s, test::TrialSettings&) { s.vehicle.hydrodynamics->length *= 1.5; });
}

// Truth: the motion of the three manoeuvres; a disturbance with or without memory is added to the force of every axis.
void selection(int seeds) {
  const Setup s = setup();
  identification::RegressionSettings settings;
  std::vector<identification::ManoeuvreRows> runs;
  for (const char* name : {"line", "zigzag", "circle"}) {
    auto manoeuvre = model::manoeuvre_preset(name);
    manoeuvre.duration = std::max(manoeuvre.duration, 95.0);
    const auto trial =
        test::record_trial(s.vehicle, s.instruments, {.manoeuvre = manoeuvre, .seed = 1, .noise = false});
    identification::ManoeuvreRows rows{.name = name, .dt = 0.1, .stretches = {{}}, .known_from = ""};
    for (std::size_t k = 0; k < trial.flight.size(); k += 5) {
      const auto& m = trial.flight[k];
      const Vector6d tau = s.vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
      rows.stretches.front().push_back({m.q_WB, m.nu, m.nu_dot, tau + m.umbilical + m.chain});
    }
    runs.push_back(rows);
  }
  std::set<std::string> truth;
  for (const auto& one : s.vehicle.hydrodynamics->coefficients) truth.insert(std::string{one.term->name});
  Vector6d sigma;
  sigma << 0.3, 0.3, 0.3, 0.02, 0.1, 0.1;  // N, N m
  for (const double phi : {0.0, 0.9}) {
    for (const bool honest : {true, false}) {
      settings.stepwise.autoregressive = settings.stepwise.effective_samples = honest;
      Rates rates;
      int absent = 0;
      for (int seed = 1; seed <= seeds; ++seed) {
        std::mt19937 random{static_cast<unsigned>(seed)};
        std::normal_distribution<double> normal;
        auto disturbed = runs;
        for (auto& run : disturbed) {
          Vector6d z = Vector6d::Zero();
          for (auto& row : run.stretches.front()) {
            for (int i = 0; i < 6; ++i) z[i] = phi * z[i] + std::sqrt(1.0 - phi * phi) * sigma[i] * normal(random);
            row.known -= z;
          }
        }
        for (const auto& axis : identification::regress(s.vehicle, disturbed, settings)) {
          for (std::size_t j = 0; j < axis.candidates.names.size(); ++j) {
            const bool chosen = std::any_of(axis.together.terms.begin(), axis.together.terms.end(),
                                            [&](const auto& t) { return t.column == static_cast<int>(j); });
            const bool acts = truth.contains(axis.candidates.names[j]);
            absent += acts ? 0 : 1;
            if (acts) rates.hits[axis.candidates.names[j]] += chosen ? 1 : 0;
            if (!acts && chosen) ++rates.false_ones;
          }
        }
      }
      std::printf("disturbance %s, %s: %d of %d that do not act are selected (%.1f %%); that act:",
                  phi > 0.0 ? "AR(1) 0.9" : "white", honest ? "AR(1) regression" : "plain least squares",
                  rates.false_ones, absent, 100.0 * rates.false_ones / absent);
      for (const auto& [name, count] : rates.hits) std::printf(" %s %.0f%%", name.c_str(), 100.0 * count / seeds);
      std::printf("\n");
    }
  }
}

// From the recorded instruments to the derivatives: ranges, gains of load cells and the umbilical's force are all
// there.
void recovery(int seeds, double cell_gain, bool exact_motion) {
  const Setup base = setup();
  std::map<std::string, double> truth;
  for (const auto& one : base.vehicle.hydrodynamics->coefficients) truth[std::string{one.term->name}] = one.value;
  std::map<std::string, std::vector<double>> errors;  // share of the truth
  Rates rates;
  int absent = 0, selected = 0, acting = 0, covered = 0, covered_white = 0, standing = 0, standing_false = 0;
  double squares = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<identification::ManoeuvreRows> runs;
    for (const char* name : {"line", "zigzag", "circle"}) {
      const auto number = static_cast<unsigned>(10 * seed) + static_cast<unsigned>(runs.size());
      auto trial =
          test::record_trial(base.vehicle, base.instruments,
                             {.manoeuvre = model::manoeuvre_preset(name), .seed = number, .cell_gain = cell_gain});
      if (exact_motion) {
        for (std::size_t k = 0; k < trial.flight.size(); ++k) {
          const model::FlightMoment& m = trial.flight[k];
          trial.recording.smoothed.push_back(
              {.utime = trial.recording.ahrs[k].utime, .p_WB = m.p_WB, .q_WB = m.q_WB, .nu = m.nu, .nu_dot = m.nu_dot});
        }
      } else {
        const auto instruments = estimation::tune_process(trial.recording, base.instruments);
        trial.recording.smoothed = estimation::smooth(trial.recording, instruments).smoothed;
      }
      runs.push_back(identification::rows_of(trial.recording, base.vehicle, 10.0));
    }
    for (const auto& axis : identification::regress(base.vehicle, runs, {})) {
      for (const std::string& name : axis.candidates.names) absent += truth.contains(name) ? 0 : 1;
      for (const auto& term : axis.together.terms) {
        const std::string& name = axis.candidates.names[static_cast<std::size_t>(term.column)];
        const auto acts = truth.find(name);
        // An interval is asked for the true number, which is zero of a term that does not act.
        const double off = std::abs(term.value - (acts == truth.end() ? 0.0 : acts->second));
        ++selected;
        covered += off < 1.96 * term.total() ? 1 : 0;
        covered_white += off < 1.96 * term.sigma ? 1 : 0;
        squares += std::pow(off / term.total(), 2);
        acting += acts == truth.end() ? 0 : 1;
        standing += term.stands() ? 1 : 0;
        standing_false += term.stands() && acts == truth.end() ? 1 : 0;
        if (std::getenv("FATHOM_TRIALS_TERMS") != nullptr)
          std::printf("seed %d %-8s %9.4f truth %9.4f scatter %.4f unseen %.4f %s%s\n", seed, name.c_str(), term.value,
                      acts == truth.end() ? 0.0 : acts->second, term.sigma, term.unseen,
                      term.stands() ? "" : "may be none", term.equivalents.empty() ? "" : ", or others");
        if (acts == truth.end()) {
          ++rates.false_ones;
          ++rates.hits[name];
        } else {
          errors[name].push_back(std::abs(term.value / acts->second - 1.0));
        }
      }
    }
  }
  std::printf("gains of load cells wrong by %.0f %%, motion %s:\n", 100.0 * cell_gain,
              exact_motion ? "exact" : "reconstructed");
  for (auto& [name, all] : errors) {
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    std::printf("%-8s selected %3.0f %%, median error %.0f %%\n", name.c_str(),
                100.0 * static_cast<double>(all.size()) / seeds, 100.0 * all[all.size() / 2]);
  }
  std::printf("%d of %d that do not act are selected (%.1f %%):", rates.false_ones, absent,
              100.0 * rates.false_ones / absent);
  for (const auto& [name, count] : rates.hits) std::printf(" %s %.0f%%", name.c_str(), 100.0 * count / seeds);
  const auto share = [](int part, int whole) { return 100.0 * part / std::max(whole, 1); };
  std::printf(
      "\n%d terms selected, %d of them act; 95 %% intervals hold the truth in %.0f %% (by scatter alone %.0f %%), "
      "rms of error over stated %.2f; %d stand, %.1f %% of these do not act (%.1f %% of what "
      "does not act)\n",
      selected, acting, share(covered, selected), share(covered_white, selected),
      std::sqrt(squares / std::max(selected, 1)), standing, share(standing_false, standing),
      share(standing_false, absent));
}

}  // namespace fathom::trials
