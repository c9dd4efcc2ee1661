// LCM logs of other projects, by their .lcm files, as recordings of topics: a channel is a topic.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "common/exports/definitions.hpp"
#include "common/recordings/import.hpp"

namespace fathom::exports {

/// A reader of logs whose types the files `paths` define. InputError "file:line: what" where one cannot be read or a
/// type is missing.
class ForeignLcm {
 public:
  explicit ForeignLcm(std::span<const std::string> paths);

  /// The files as recordings::read_files and import_files take them. A message whose 'utime' (also of its header) is a
  /// time was measured then.
  [[nodiscard]] recordings::Files files(std::span<const std::string> logs) const;

 private:
  std::shared_ptr<const Definitions> definitions_;
};

}  // namespace fathom::exports
