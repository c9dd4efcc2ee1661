#include <algorithm>

#include "common/inference/scan.hpp"

namespace fathom::inference {

using likelihood::Stage;

EffectColumns::EffectColumns(const likelihood::Problem& problem, const Seen& seen,
                             const likelihood::Hypothesis& hypothesis, std::size_t run)
    : problem_{problem},
      seen_{seen},
      command_offset_{hypothesis.runs[run].command_offset},
      run_{run},
      plant_{hypothesis, none_, problem.runs[run], run, false} {
  plant_.begin(problem.runs[run].start());
}

void EffectColumns::add(const model::ActiveEffect& effect, const std::vector<double>& theta) {
  Column column;
  model::ActiveEffect active = effect;
  active.theta = theta;
  column.stage = likelihood::stage_of(active);
  if (column.stage != Stage::kHull) column.model = plant_.model();
  const likelihood::RunData& run = problem_.runs[run_];
  switch (column.stage) {
    case Stage::kThrust: {
      column.model.add(active);
      Eigen::MatrixXd forces;
      thrust_forces(column.model, run, command_offset_, forces);
      plant_.mean_over_blocks(forces, column.thrust);
      column.thrust -= plant_.mean_forces();
      break;
    }
    case Stage::kMemory: {
      // Alone: what is remembered adds up.
      std::erase_if(column.model.effects,
                    [](const auto& other) { return likelihood::stage_of(other) == Stage::kMemory; });
      column.model.add(active);
      break;
    }
    case Stage::kSensor:
      std::erase_if(column.model.effects,
                    [](const auto& other) { return likelihood::stage_of(other) == Stage::kSensor; });
      column.model.add(active);
      break;
    case Stage::kHull:
      break;
  }
  column.effect = std::move(active);
  columns_.push_back(std::move(column));
  Column& added = columns_.back();
  // Of the model where it now stands: what reads it keeps its place.
  if (added.stage == Stage::kSensor) {
    added.sensor.emplace_back(added.model, run.dt());
    added.sensor.back().begin(run.start());
  }
}

void EffectColumns::at(std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut shown) {
  const auto b = static_cast<Eigen::Index>(block);
  const likelihood::RunReference& reference = seen_.reference[run_];
  const likelihood::RunData& run = problem_.runs[run_];
  if (block == 0) {
    for (Column& column : columns_) {
      if (column.stage != Stage::kMemory) continue;
      column.memory.emplace_back(column.model, none_);
      model::Motion motion = plant_.motion();
      motion.nu = run.start();
      column.memory.back().begin(motion);
    }
  }
  plant_.at_middle(block);
  const Vector6d nu = reference.nu_middle.col(b);
  const Vector6d plain = plant_.acceleration(nu);
  const Matrix6d inverse = seen_.inverse[run_].col(b).reshaped(6, 6);
  const auto& axes = problem_.axes;
  const auto put = [&](std::size_t c, const Vector6d& value) {
    for (int i = 0; i < reference.axes; ++i)
      acceleration(i, static_cast<Eigen::Index>(c)) =
          i < problem_.simulated ? value[axes[static_cast<std::size_t>(i)]] : 0.0;
  };
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    switch (column.stage) {
      case Stage::kThrust:
        put(c, inverse * (plant_.model().allocation * column.thrust.col(b)));
        break;
      case Stage::kMemory:
        put(c, inverse * column.memory.back().wrench());
        break;
      case Stage::kHull:
        put(c, plant_.added_by(column.effect, plain, inverse));
        break;
      case Stage::kSensor: {
        put(c, Vector6d::Zero());
        const likelihood::Block& here = run.blocks()[block];
        likelihood::SensorStage& sensor = column.sensor.back();
        Vector6d mean = Vector6d::Zero();
        for (std::size_t k = here.first + 1; k <= here.last; ++k) {
          const Vector6d sample = reference.trace.col(static_cast<Eigen::Index>(k));
          sensor.push(sample);
          mean += sample / static_cast<double>(here.last - here.first);
        }
        const Vector6d change = sensor.mean(here.last - here.first, column.model) - mean;
        for (int i = 0; i < problem_.simulated; ++i)
          shown(i, static_cast<Eigen::Index>(c)) = change[axes[static_cast<std::size_t>(i)]];
      }
    }
  }
  const Vector6d end = reference.nu_end.col(b);
  plant_.end_block(block, end);
  for (Column& column : columns_) {
    if (column.stage != Stage::kMemory) continue;
    model::Motion motion = plant_.motion();
    motion.nu = end;
    motion.v_WF_B.setZero();
    motion.a_WF_B.setZero();
    likelihood::feel_hull(plant_.model(), motion);
    column.memory.back().advance(motion, run.blocks()[block].dt);
  }
}

}  // namespace fathom::inference
