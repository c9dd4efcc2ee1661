// Where a survey begins: every tag and every camera placed one after the other, from what is known already.
#pragma once

#include <vector>

#include "common/vision/calibration.hpp"

namespace fathom::vision {

struct SurveyStart {
  model::Site site;           ///< with the tags that were not in the map
  std::vector<int> surveyed;  ///< numbers of those that were
};

/// `flat`: new tags lie in the plane of the known ones, where that is level. `sizes`: of tags that are not in the
/// map; those without one are left out. Without any map the tag that is seen most is the origin and lies flat.
[[nodiscard]] SurveyStart start_survey(const model::Site& site, const std::vector<View>& views, const TagSizes& sizes,
                                       bool flat);

}  // namespace fathom::vision
