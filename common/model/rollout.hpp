// Open-loop simulation over a stretch of a trial: initial velocity and inputs in, velocities out.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/trial.hpp"

namespace fathom::model {

/// A stretch of a trial: samples [start, start + count).
struct Window {
  const Trial* trial{};
  std::size_t start{};
  std::size_t count{};
};

/// Simulates the window from the measured pose at its start and `nu0`, with the trial's inputs only. Degrees of freedom
/// that the vehicle file leaves out follow the measurement. Second-order steps of at most 50 ms, in which drag decays
/// exactly, shorter where the priors' drag is stiff; effects with memory are run in over the seconds before the window.
/// `nu` is what the sensors say: the effects that measure have been applied to it, while `nu0` is true. Returns false
/// when the motion diverged (the rest is held).
bool rollout(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu);

/// Where a window begins, against the pose that was measured there. What follows the measurement is not turned.
struct PoseShift {
  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};     ///< m
  Eigen::Vector3d turn_W{Eigen::Vector3d::Zero()};  ///< rad, rotation vector
};

/// Simulated poses, sample by sample.
struct PoseTrace {
  Eigen::Matrix3Xd p_WB;  ///< m
  std::vector<Eigen::Quaterniond> q_WB;
};

/// The same from a pose beside the measured one, and the poses that it runs through.
bool rollout(const Model& model, const Window& window, const Vector6d& nu0, const PoseShift& shift, VelocityTrace& nu,
             PoseTrace& pose);

/// Derivatives of a rollout's velocities: row 6 k + axis is sample k's. Columns: the base parameters in their order
/// [velocity per unit], then the initial velocity.
using VelocityDerivatives = Eigen::Matrix<double, Eigen::Dynamic, kBaseParameterCount + 6, Eigen::RowMajor>;

/// A rollout together with its derivatives, by the variational equation along the trajectory (Jategaonkar 2015,
/// sec. 4.6). Far cheaper than a rollout per parameter; within 1 % of differences of rollouts, see the
/// test (a few per cent more where an axis settles within a few steps). Effects' own numbers are not among the columns.
bool rollout_with_derivatives(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu,
                              VelocityDerivatives& derivatives);

/// Time in which the priors' drag, at the speed of ordinary motion, slows the quickest axis to 1/e [s].
[[nodiscard]] double quickest_decay(const Vehicle& vehicle);

/// What drove the trial, as the model says that commands act between their samples. The trial must outlive it.
[[nodiscard]] InputSignal input_of(const Model& model, const Trial& trial);

/// True velocities of `count` samples from `from` on, as the sensors' effects of the model explain the measured ones.
[[nodiscard]] VelocityTrace true_velocities(const Model& model, const Trial& trial, std::size_t from,
                                            std::size_t count);
/// The true velocity at one sample: where a prediction begins.
[[nodiscard]] Vector6d true_velocity(const Model& model, const Trial& trial, std::size_t at);

/// Scene of a set of trials, for effects that choose starts and variants by it.
[[nodiscard]] Scene scene_of(const Vehicle& vehicle, std::span<const Trial> trials);

}  // namespace fathom::model
