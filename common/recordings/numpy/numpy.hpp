// NumPy arrays, alone (.npy) or several in a zip (.npz). Their headers are read strictly and never evaluated; pickled
// objects are never loaded.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::numpy {

[[nodiscard]] bool is_npy(Bytes head);
void read_npy(const std::string& path, Sink& sink, Damage& damage);

[[nodiscard]] bool is_npz(Bytes head);
void read_npz(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::numpy
