// Names of the rooms that this one shares with common/verdict.
#pragma once

namespace fathom::residual {}
namespace fathom::preflight {}

namespace fathom::diagnosis {

using namespace residual;
using namespace preflight;

}  // namespace fathom::diagnosis
