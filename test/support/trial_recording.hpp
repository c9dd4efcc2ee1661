// A trial as Pereira and Duncan recorded theirs: a flown manoeuvre seen by an inertial package away from the origin, a
// flux-gate compass, inclinometers, a pressure gauge, acoustic transponders that drop out with attitude, and load
// cells.
#pragma once

#include "common/estimation/online/kalman_settings.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/samples/recording.hpp"

namespace fathom::test {

struct TrialSettings {
  model::Manoeuvre manoeuvre;
  unsigned seed{1};
  double inertial_rate{50.0};  ///< Hz
  double range_rate{1.0};      ///< Hz
  double outliers{0.02};       ///< share of the ranges that are metres too long
  double drop_outs{0.05};      ///< share of the ranges lost wherever the transponder is
  double disturbance{1.0};     ///< N, of the umbilical: a first-order process of one second
  double cell_gain{0.03};      ///< std of the load cells' gain errors
  double cell_noise{0.2};      ///< N
  double inclinometer{0.005};  ///< rad
  bool noise{true};            ///< false: perfect instruments
};

struct TrialRecording {
  Recording recording;
  std::vector<model::FlightMoment> flight;  ///< at the inertial rate
  Eigen::Vector3d accelerometer_bias{Eigen::Vector3d::Zero()}, gyro_bias{Eigen::Vector3d::Zero()};
};

/// `instruments` says where they sit and how well they measure, as the estimator is told.
[[nodiscard]] TrialRecording record_trial(const model::Vehicle& vehicle, const estimation::KalmanSettings& instruments,
                                          const TrialSettings& settings);

/// Section "estimator" of config/pipelines/NAME.yaml.
[[nodiscard]] estimation::KalmanSettings instruments_from_repository(const std::string& name);

}  // namespace fathom::test
