#include "processes/fathom/rehearsals.hpp"

#include <filesystem>

#include "common/base/config.hpp"
#include "common/model/site.hpp"

namespace fathom::tool {

planning::RehearsalSettings rehearsal_settings(const std::string& site, const std::string& pipeline,
                                               const model::Vehicle& vehicle) {
  const std::filesystem::path path{site};
  const model::Site place = model::Site::load(site);
  const Config config = Config::load(
      pipeline.empty() ? (path.parent_path().parent_path() / "pipelines" / path.filename()).string() : pipeline);
  return {.supervisor = excitation::SupervisorSettings::from(config.section("supervisor"), vehicle, place),
          .identifier = identification::IdentifierSettings::from(config.section("identifier"))};
}

}  // namespace fathom::tool
