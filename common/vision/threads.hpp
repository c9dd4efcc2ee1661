// How many cores OpenCV takes.
#pragma once

namespace fathom::vision {

/// This process's pictures are worked on by one core: what it costs is what it says it costs, and nothing is taken from
/// the processes beside it. Results are the same.
void use_one_core();

}  // namespace fathom::vision
