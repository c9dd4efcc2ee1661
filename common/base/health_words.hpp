// Words by which those who say HEALTH and those who read it understand each other.
#pragma once

namespace fathom {

/// Begins the detail of a process in lockstep that would be unhealthy in real time.
inline constexpr char kWithoutConsequence[] = "in lockstep without consequence: ";

/// Of a thruster driver that was started again beside a trial: what an arming mends must not stand in its way.
inline constexpr char kNotArmedYet[] = "thrust is commanded and none is given, since this driver was not armed";

}  // namespace fathom
