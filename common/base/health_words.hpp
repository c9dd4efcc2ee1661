// Words by which those who say HEALTH and those who read it understand each other.
#pragma once

namespace fathom {

/// Begins the detail of a process in lockstep that would be unhealthy in real time.
inline constexpr char kWithoutConsequence[] = "in lockstep without consequence: ";

}  // namespace fathom
