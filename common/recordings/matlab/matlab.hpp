// MATLAB's .mat, versions 4 to 7.3, through libmatio: variables and what stands in their structs, as arrays.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::matlab {

[[nodiscard]] bool is_mat(Bytes head);
/// The library reads in a process of its own: damage that it does not stand costs what it had not read yet, no more.
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::matlab
