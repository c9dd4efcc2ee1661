// Where and how a vehicle may be flown, for what is flown in advance: site, fence and excitation of a pipeline.
#pragma once

#include <string>

#include "common/planning/rehearsal.hpp"

namespace fathom::tool {

/// `pipeline` empty: the file of the site's name in ../pipelines/ beside the site's folder.
[[nodiscard]] planning::RehearsalSettings rehearsal_settings(const std::string& site, const std::string& pipeline,
                                                             const model::Vehicle& vehicle);

}  // namespace fathom::tool
