// What an instrument says, on its channel.
#pragma once

#include "common/runtime/process.hpp"
#include "common/simulation/sensor.hpp"
#include "processes/simulator/darkroom.hpp"

namespace fathom::simulator {

/// Declares every channel that speak() uses.
void declare_speech(runtime::Process& process);
/// Publishes a sample; exposures become pictures.
void speak(runtime::Process& process, Darkroom& darkroom, const simulation::Sample& sample);

}  // namespace fathom::simulator
