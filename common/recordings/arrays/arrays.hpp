// Named arrays as topics: which of them is the time of which others. Files of arrays do not say; a vector that is named
// like a time, rises, and is as long as others, is theirs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/recordings/damage.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::arrays {

struct Array {
  std::string path;  ///< "log.battery.V"
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< the first index runs fastest
  bool date{false};            ///< already seconds since 1970
};

/// Says the arrays to the sink: a topic for each time, named as what holds it ("data" at the top), a field for each
/// column. Rows may stand along either side: the length of the time decides. The others go to `damage`, by name.
void say(const std::vector<Array>& arrays, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::arrays
