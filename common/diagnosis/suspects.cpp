#include "common/diagnosis/suspects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::diagnosis {
namespace {

double heading(const Moment& at) { return euler_from_rotation(at.trial.q_WB[at.k].toRotationMatrix()).z(); }
const Eigen::Vector3d& place(const Moment& at) { return at.trial.p_WB[at.k]; }
double time(const Moment& at) { return at.trial.t[at.k]; }

bool always(const Trial&) { return true; }
bool with_position(const Trial& trial) { return trial.observed.position; }
bool with_attitude(const Trial& trial) { return trial.observed.attitude; }
bool with_voltage(const Trial& trial) { return !trial.voltage.empty(); }

constexpr int kSlow = 5;  // cycles in a run: quicker swings are asked as oscillations

/// What swings with one to kSlow cycles in a run, each times `factor`.
void add_slow(const Moment& at, double factor, Columns& row) {
  const std::vector<double>& t = at.trial.t;
  const double turn = 2.0 * std::numbers::pi * (t[at.k] - t.front()) / std::max(t.back() - t.front(), 1e-9);
  for (int cycles = 1; cycles <= kSlow; ++cycles) {
    row.push_back(factor * std::cos(cycles * turn));
    row.push_back(factor * std::sin(cycles * turn));
  }
}

void add(Columns& row, std::initializer_list<double> values) { row.insert(row.end(), values); }

/// `columns` of every other axis that is simulated.
template <class Of>
void of_others(const Moment& at, int axis, Columns& row, const Of& columns) {
  for (int other = 0; other < 6; ++other) {
    if (other != axis && at.dof[static_cast<std::size_t>(other)]) columns(other, row);
  }
}

/// Which way it goes, from -1 to 1, whatever its speed but the slowest.
double way(double velocity, double ordinary) {
  constexpr double kSlowest = 0.1;  // of the ordinary: noise would turn it
  return ordinary > 0.0 ? std::tanh(velocity / (kSlowest * ordinary)) : 0.0;
}

/// What is there whichever way it goes but against it, along the axis itself and, of what reaches it through the world,
/// from north and east.
void add_ways(const Moment& at, int axis, Columns& row) {
  row.push_back(way(at.nu[axis], at.nu_rms[axis]));
  if (axis > 2) return;
  const Eigen::Matrix3d R_WB = at.trial.q_WB[at.k].toRotationMatrix();
  const Eigen::Vector3d v_W = R_WB * at.nu.head<3>();
  const double ordinary = at.nu_rms.head<2>().norm();
  const double speed = std::max(v_W.norm(), 1e-9);
  row.push_back(at.nu[axis] / speed * way(speed, ordinary));
  for (int along = 0; along < 2; ++along) {
    for (int from = 0; from < 2; ++from) row.push_back(way(v_W[from], ordinary) * R_WB(along, axis));
  }
}

constexpr std::array kSuspects{
    Suspect{"position", with_position,
            [](const Moment& at, int, Columns& row) {
              const Eigen::Vector3d& p = place(at);
              add(row, {p.x(), p.y(), p.x() * p.y(), p.x() * p.x(), p.y() * p.y()});
            }},
    Suspect{"depth", with_position,
            [](const Moment& at, int, Columns& row) {
              add(row, {place(at).z(), std::pow(place(at).z(), 2)});
            }},
    Suspect{"heading, like a force that is steady in the world", with_attitude,
            [](const Moment& at, int, Columns& row) {
              add(row, {std::sin(heading(at)), std::cos(heading(at))});
            }},
    Suspect{"heading", with_attitude,
            [](const Moment& at, int, Columns& row) {
              const double psi = heading(at);
              add(row, {std::sin(psi), std::cos(psi), std::sin(2.0 * psi), std::cos(2.0 * psi)});
            }},
    Suspect{"heading and time, like a force in the world that changes slowly", with_attitude,
            [](const Moment& at, int, Columns& row) {
              add(row, {std::sin(heading(at)), std::cos(heading(at))});
              add_slow(at, std::sin(heading(at)), row);
              add_slow(at, std::cos(heading(at)), row);
            }},
    Suspect{"speed", always,
            [](const Moment& at, int axis, Columns& row) {
              add(row, {std::abs(at.nu[axis]), std::pow(at.nu[axis], 3)});
            }},
    Suspect{"speed along other axes", always,
            [](const Moment& at, int axis, Columns& row) {
              of_others(at, axis, row, [&](int other, Columns& into) {
                add(into, {at.nu[other], at.nu[other] * std::abs(at.nu[other])});
              });
            }},
    Suspect{"products of speeds", always,
            [](const Moment& at, int, Columns& row) {
              for (int i = 0; i < 6; ++i) {
                for (int j = i; j < 6; ++j) {
                  if (at.dof[static_cast<std::size_t>(i)] && at.dof[static_cast<std::size_t>(j)])
                    row.push_back(at.nu[i] * at.nu[j]);
                }
              }
            }},
    Suspect{"thrust", always,
            [](const Moment& at, int axis, Columns& row) {
              add(row, {std::abs(at.tau[0][axis]), std::pow(at.tau[0][axis], 3)});
            }},
    Suspect{"thrust along other axes", always,
            [](const Moment& at, int axis, Columns& row) {
              of_others(at, axis, row, [&](int other, Columns& into) {
                add(into, {at.tau[0][other], std::abs(at.tau[0][other])});
              });
            }},
    Suspect{"thrust a moment ago", always,
            [](const Moment& at, int axis, Columns& row) {
              add(row, {at.tau[1][axis], at.tau[2][axis]});
            }},
    Suspect{"the way it goes, as of dry friction", always, add_ways},
    Suspect{"thrust times speed", always,
            [](const Moment& at, int axis, Columns& row) {
              const double tau = at.tau[0][axis], v = at.nu[axis];
              add(row, {tau * v, tau * std::abs(v), tau * v * v, std::pow(v, 3), std::pow(v, 4)});
            }},
    Suspect{"thrust of several axes at once", always,
            [](const Moment& at, int axis, Columns& row) {
              const double tau = at.tau[0][axis];
              of_others(at, axis, row, [&](int other, Columns& into) {
                add(into, {tau * at.tau[0][other], tau * std::abs(at.tau[0][other])});
                of_others(at, axis, into, [&](int third, Columns& of_both) {
                  if (third > other) of_both.push_back(at.tau[0][other] * at.tau[0][third]);
                });
              });
            }},
    Suspect{"thrust times turning, as of a rotor's spin", always,
            [](const Moment& at, int, Columns& row) {
              for (int force = 0; force < 3; ++force) {
                for (int rate = 3; rate < 6; ++rate) row.push_back(at.tau[0][force] * at.nu[rate]);
              }
            }},
    Suspect{"voltage", with_voltage,
            [](const Moment& at, int axis, Columns& row) {
              add(row, {at.trial.voltage[at.k], at.trial.voltage[at.k] * at.tau[0][axis]});
            }},
    Suspect{"time, as a drift", always,
            [](const Moment& at, int, Columns& row) {
              add(row, {time(at), time(at) * time(at)});
            }},
    Suspect{"time, swinging slowly", always, [](const Moment& at, int, Columns& row) { add_slow(at, 1.0, row); }},
    Suspect{"time, as thrust or drag that changes", always,
            [](const Moment& at, int axis, Columns& row) {
              const double v = at.nu[axis];
              add(row, {time(at) * at.tau[0][axis], time(at) * v, time(at) * v * std::abs(v)});
            }},
};

constexpr std::array kCircumstances{
    Circumstance{"thrust", always, [](const Moment& at, int axis) { return std::abs(at.tau[0][axis]); }},
    Circumstance{"speed", always, [](const Moment& at, int axis) { return std::abs(at.nu[axis]); }},
    Circumstance{"depth", with_position, [](const Moment& at, int) { return place(at).z(); }},
    Circumstance{"time", always, [](const Moment& at, int) { return time(at); }}};

}  // namespace

std::span<const Suspect> suspects() { return kSuspects; }

std::span<const Circumstance> circumstances() { return kCircumstances; }

void base_columns(const Moment& at, int axis, Columns& row) {
  const double v = at.nu[axis];
  add(row, {1.0, at.tau[0][axis], v, v * std::abs(v)});
  // Coriolis forces of mass and added mass, and moments of added mass (Fossen 2011, eq. 6.44): two products an axis.
  constexpr std::array<std::array<int, 4>, 6> kProducts{
      {{1, 5, 2, 4}, {0, 5, 2, 3}, {0, 4, 1, 3}, {1, 2, 4, 5}, {0, 2, 3, 5}, {0, 1, 3, 4}}};
  const auto& of = kProducts[static_cast<std::size_t>(axis)];
  add(row, {at.nu[of[0]] * at.nu[of[1]], at.nu[of[2]] * at.nu[of[3]]});
  const Eigen::Vector3d down = at.trial.q_WB[at.k].conjugate() * Eigen::Vector3d::UnitZ();
  add(row, {down.x(), down.y(), down.z()});
}

}  // namespace fathom::diagnosis
