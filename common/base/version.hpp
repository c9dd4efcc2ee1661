// Which build this is. The number comes from git when the build runs (cmake/version.cmake), so that a log, a report and
// `--version` name the same commit.
#pragma once

#include <string_view>

namespace fathom {

/// "0.2.0" of the tag v0.2.0; "0.2.0+git202611262105.20f2054" of a later commit (its time in UTC and its name), with
/// "~git" before the first tag; ".modified" behind it when files differ from the commit. Whoever calls this links
/// fathom_version.
[[nodiscard]] std::string_view version();

}  // namespace fathom
