// truth.json: what the simulator knows and nobody else may, for the report's last section.
#pragma once

#include <string>

#include "common/model/site.hpp"
#include "common/model/vehicle.hpp"
#include "common/simulation/simulator.hpp"
#include "processes/simulator/options.hpp"

namespace fathom::simulator {

/// Writes DIR/truth.json anew; makes the folder. InputError when it cannot be written.
void write_truth(const Options& options, const model::Vehicle& vehicle, const model::Site& site,
                 const simulation::Simulator& simulator);

}  // namespace fathom::simulator
