#include "common/identification/regression/manoeuvre_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "common/base/error.hpp"
#include "common/base/statistics.hpp"
#include "common/identification/known_signals.hpp"
#include "common/model/derivative_motion.hpp"

namespace fathom::identification {
namespace {

constexpr double kGap = 3.0;  // typical steps between samples that are no neighbours any more
// Typical sigmas of a run beyond which a state is left out. Of three manoeuvres flown twenty times (fathom_trials
// recovery) 102 true terms stand without this rule and 108 with it (102 and 110 with exact load cells); 15 and 15 false
// ones (9 and 7). Of the sway in ./trial --pap104 61 % is explained without, 75, 79 and 80 % at 3, 2 and 1.5.
constexpr double kMostUnsure = 2.0;
constexpr std::size_t kFewestRows = 20;  // of a run: as many as an equation may have terms

/// A wrench over time, averaged over an interval; held at the ends.
class WrenchSignal {
 public:
  void add(Utime utime, const Vector6d& wrench) {
    times_.push_back(utime);
    wrenches_.push_back(wrench);
  }
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] Vector6d at(Utime utime) const {
    const auto above = std::upper_bound(times_.begin(), times_.end(), utime);
    if (above == times_.begin()) return wrenches_.front();
    if (above == times_.end()) return wrenches_.back();
    const auto i = static_cast<std::size_t>(above - times_.begin());
    const double share = seconds_between(times_[i - 1], utime) / seconds_between(times_[i - 1], times_[i]);
    return wrenches_[i - 1] + share * (wrenches_[i] - wrenches_[i - 1]);
  }

 private:
  std::vector<Utime> times_;
  std::vector<Vector6d> wrenches_;
};

/// Of all load cells, or of those that measure `of`.
WrenchSignal cells_of(const Recording& recording, const model::Vehicle& vehicle, const std::string& of = "") {
  WrenchSignal signal;
  const auto& cells = vehicle.hydrodynamics->load_cells;
  const auto counts = [&](const model::LoadCell& cell) { return of.empty() || cell.of == of; };
  if (std::none_of(cells.begin(), cells.end(), counts)) return signal;
  for (const Loads& one : recording.loads) {
    if (one.load.size() != cells.size()) {
      throw InputError(recording.name + ": LOADS has " + std::to_string(one.load.size()) +
                       " cells and the vehicle file " + std::to_string(cells.size()));
    }
    Vector6d wrench = Vector6d::Zero();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!counts(cells[i])) continue;
      const Eigen::Vector3d force = one.load[i] * cells[i].axis_B;
      wrench.head<3>() += force;
      wrench.tail<3>() += cells[i].p_BL.cross(force);
    }
    signal.add(one.utime, wrench);
  }
  return signal;
}

WrenchSignal thrusters_of(const Recording& recording, const model::Vehicle& vehicle) {
  WrenchSignal signal;
  for (const Thrusters& one : recording.thrusters) {
    Vector6d wrench = Vector6d::Zero();
    if (static_cast<Eigen::Index>(one.force.size()) == vehicle.allocation.cols() && !one.force.empty()) {
      wrench = vehicle.allocation *
               Eigen::Map<const Eigen::VectorXd>(one.force.data(), static_cast<Eigen::Index>(one.force.size()));
    } else if (one.has_tau) {
      wrench = Eigen::Map<const Vector6d>(one.tau.data());
    } else {
      continue;
    }
    signal.add(one.utime, wrench);
  }
  return signal;
}

/// One signal for each load cell, and for each thruster whose force THRUSTERS alone tells.
std::vector<WrenchSignal> parts_of(const Recording& recording, const model::Vehicle& vehicle, bool cells, bool thrust) {
  std::vector<WrenchSignal> parts;
  const auto& all = vehicle.hydrodynamics->load_cells;
  for (std::size_t i = 0; cells && i < all.size(); ++i) {
    WrenchSignal& part = parts.emplace_back();
    for (const Loads& one : recording.loads) {
      const Eigen::Vector3d force = one.load[i] * all[i].axis_B;
      Vector6d wrench;
      wrench << force, all[i].p_BL.cross(force);
      part.add(one.utime, wrench);
    }
  }
  for (Eigen::Index i = 0; thrust && i < vehicle.allocation.cols(); ++i) {
    WrenchSignal part;
    for (const Thrusters& one : recording.thrusters) {
      if (static_cast<Eigen::Index>(one.force.size()) == vehicle.allocation.cols())
        part.add(one.utime, vehicle.allocation.col(i) * one.force[static_cast<std::size_t>(i)]);
    }
    if (!part.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

/// Drag of an umbilical whose length the log tells and whose force nothing measures.
WrenchSignal umbilical_of(const Recording& recording, const model::Vehicle& vehicle, const KnownSignal& paid_out,
                          const KnownFlow& flow) {
  WrenchSignal signal;
  for (const SmoothedState& one : recording.smoothed) {
    const Eigen::Vector3d v_WF_B = one.q_WB.conjugate() * flow.velocity(one.utime);
    const Eigen::Vector3d force = model::umbilical_drag(vehicle, paid_out.at(one.utime), one.nu, v_WF_B);
    Vector6d wrench;
    wrench << force, vehicle.hydrodynamics->umbilical->p_BU.cross(force);
    signal.add(one.utime, wrench);
  }
  return signal;
}

/// Medians over the run of what SMOOTHED says of itself from `begin` on.
Eigen::Vector3d typical_sigma(const std::vector<SmoothedState>& states, Eigen::Index begin) {
  Eigen::Vector3d result;
  std::vector<double> values(states.size());
  for (Eigen::Index i = 0; i < 3; ++i) {
    std::ranges::transform(states, values.begin(), [&](const SmoothedState& one) { return one.sigma[begin + i]; });
    result[i] = median(values);
  }
  return result;
}

/// Those states of which attitude, velocity and acceleration are as sure as they mostly are in this run: at its ends
/// and where aids were lost, what the smoother errs by lasts for seconds, and looks like a force.
std::vector<SmoothedState> sure_states(const std::vector<SmoothedState>& states) {
  constexpr Eigen::Index kFirst = 3;  // of sigma: after the position, which no force depends on
  Eigen::Matrix<double, 18, 1> most;
  for (Eigen::Index i = kFirst; i < most.size(); i += 3) most.segment<3>(i) = kMostUnsure * typical_sigma(states, i);
  std::vector<SmoothedState> sure;
  std::ranges::copy_if(states, std::back_inserter(sure), [&](const SmoothedState& one) {
    return (one.sigma.tail<18 - kFirst>().array() <= most.tail<18 - kFirst>().array()).all();
  });
  return sure;
}

double typical_step(const std::vector<SmoothedState>& states) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < states.size(); ++k)
    steps.push_back(seconds_between(states[k - 1].utime, states[k].utime));
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

void need_hydrodynamics(const model::Vehicle& vehicle) {
  if (!vehicle.hydrodynamics) throw InputError(vehicle.name + ": the vehicle file has no section hydrodynamics");
}

ManoeuvreRows rows_of(const Recording& recording, const model::Vehicle& vehicle, double rate) {
  if (recording.smoothed.size() < 3)
    throw InputError(recording.name + ": no SMOOTHED in this log; run fathom smooth first");
  need_hydrodynamics(vehicle);
  const std::vector<SmoothedState> states = sure_states(recording.smoothed);
  if (states.size() < 3)
    throw InputError(recording.name +
                     ": SMOOTHED has less than three states whose errors are stated and small enough to believe them");
  const WrenchSignal cells = cells_of(recording, vehicle);
  std::array<WrenchSignal, kPulls.size()> pulls;
  for (std::size_t i = 0; i < pulls.size(); ++i) pulls[i] = cells_of(recording, vehicle, kPulls[i]);
  const bool cells_know_thrust =
      std::any_of(vehicle.hydrodynamics->load_cells.begin(), vehicle.hydrodynamics->load_cells.end(),
                  [](const model::LoadCell& one) { return one.of == "thrusters"; });
  const WrenchSignal thrust = !cells.empty() && cells_know_thrust ? WrenchSignal{} : thrusters_of(recording, vehicle);
  if (cells.empty() && thrust.empty()) {
    throw InputError(recording.name +
                     ": neither LOADS nor forces in THRUSTERS; without forces nothing can be regressed");
  }
  ManoeuvreRows rows;
  rows.name = recording.name;
  rows.known_from = cells.empty() ? "THRUSTERS" : thrust.empty() ? "load cells" : "load cells and THRUSTERS";
  std::vector<WrenchSignal> parts = parts_of(recording, vehicle, !cells.empty(), !thrust.empty());
  const KnownFlow flow{recording};
  if (!flow.empty()) rows.known_from += ", the water's velocity";
  WrenchSignal umbilical;
  if (const KnownSignal paid_out{recording, kPaidOut, "m"};
      !paid_out.empty() && pulls[0].empty() && vehicle.hydrodynamics->umbilical) {
    umbilical = umbilical_of(recording, vehicle, paid_out, flow);
    pulls[0] = umbilical;
    parts.push_back(umbilical);
    rows.known_from += ", the umbilical's length";
  }
  rows.cells = cells.empty() ? 0 : vehicle.hydrodynamics->load_cells.size();
  rows.sigma_attitude = typical_sigma(states, 3);
  rows.sigma_velocity = typical_sigma(states, 6);
  const double step = typical_step(states);
  const auto per_row = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / (rate * step))));
  rows.dt = static_cast<double>(per_row) * step;
  rows.unsure = step * static_cast<double>(recording.smoothed.size() - states.size());

  // Averages of `per_row` samples by time, so that unequal steps do no harm; a row that holds none ends the stretch.
  std::size_t k = 0;
  while (k < states.size()) {
    const Utime origin = states[k].utime;
    auto& stretch = rows.stretches.emplace_back();
    for (int n = 0; k < states.size(); ++n) {
      const Utime end = utime_after(origin, (n + 1) * rows.dt - 0.5 * step);
      ManoeuvreRows::Row row;
      row.parts.assign(parts.size(), Vector6d::Zero());
      int count = 0;
      const std::size_t first = k;
      Eigen::Vector4d q = Eigen::Vector4d::Zero();
      for (; k < states.size() && states[k].utime < end; ++k, ++count) {
        row.nu += states[k].nu;
        row.nu_dot += states[k].nu_dot;
        if (!cells.empty()) row.known += cells.at(states[k].utime);
        for (std::size_t i = 0; i < pulls.size(); ++i) {
          if (!pulls[i].empty()) row.pulls[i] += pulls[i].at(states[k].utime);
        }
        if (!thrust.empty()) row.known += thrust.at(states[k].utime);
        if (!umbilical.empty()) row.known += umbilical.at(states[k].utime);
        row.v_WF += flow.velocity(states[k].utime);
        row.a_WF += flow.acceleration(states[k].utime);
        for (std::size_t i = 0; i < parts.size(); ++i) row.parts[i] += parts[i].at(states[k].utime);
        const double sign = states[k].q_WB.dot(states[first].q_WB) < 0.0 ? -1.0 : 1.0;
        q += sign * states[k].q_WB.coeffs();
      }
      if (count == 0) break;
      row.nu /= count;
      row.nu_dot /= count;
      row.known /= count;
      row.v_WF /= count;
      row.a_WF /= count;
      for (Vector6d& pull : row.pulls) pull /= count;
      for (Vector6d& part : row.parts) part /= count;
      row.q_WB = Eigen::Quaterniond{Eigen::Vector4d(q.normalized())};
      stretch.push_back(row);
      if (k < states.size() && seconds_between(end, states[k].utime) > kGap * std::max(step, 0.5 * rows.dt)) break;
    }
  }
  std::size_t count = 0;
  for (const auto& stretch : rows.stretches) count += stretch.size();
  if (count < kFewestRows) {
    char text[120];
    std::snprintf(text, sizeof text,
                  ": %zu rows of %.3g s; regression needs %zu at least, so a higher --rate or a longer run", count,
                  rows.dt, kFewestRows);
    throw InputError(recording.name + text);
  }
  return rows;
}

}  // namespace fathom::identification
