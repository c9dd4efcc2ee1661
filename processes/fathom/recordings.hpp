// Recordings by file name: logs and tables, with everything that was refused in them said once on stderr.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"

namespace fathom::tool {

/// Reads .lcmlog and .csv files (tables through `map`, canonical columns when it is empty). Tables may lack columns of
/// axes that `simulated`, the vehicle's 'dof', does not have. Notes go to `notes`.
/// InputError when a file is bad or two have the same name.
[[nodiscard]] std::vector<Recording> read_recordings(const std::vector<std::string>& paths, const std::string& map,
                                                     std::vector<std::string>& notes,
                                                     const std::optional<tables::SimulatedAxes>& simulated = {});

/// Sorts recordings by their time, those that begin at once by their names, and their paths with them: which file was
/// named first on a command line changes nothing.
void sort_by_time(std::span<Recording> recordings, std::span<std::string> paths);

/// "POSE_CAPTURE 5980, AHRS 5980": the streams that hold something.
[[nodiscard]] std::string counts(const Recording& recording);

}  // namespace fathom::tool
