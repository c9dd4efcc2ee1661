// Variables of a .mat on their way through a pipe, from the process that reads the file to the one that asked.
#pragma once

#include <string>

#include "common/recordings/arrays/arrays.hpp"
#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"

namespace fathom::recordings::matlab {

/// Reads the file and writes its arrays to `pipe`, each as soon as it is read.
void send_variables(const std::string& path, int pipe);
/// The other end; false where the sender did not come to its end.
[[nodiscard]] bool received(Bytes bytes, std::vector<arrays::Array>& all, Damage& damage);

}  // namespace fathom::recordings::matlab
