// Arrays as NumPy keeps several in one file (.npz): a zip of .npy files, stored as they are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fathom::recordings::numpy {

/// One array; the first index runs slowest.
struct Array {
  std::string name;                ///< of the member, without ".npy"
  std::string type;                ///< of an element, as NumPy writes it: "<f8", "<i8", "|b1", "<U12"
  std::vector<std::size_t> shape;  ///< empty: a single element
  std::vector<std::uint8_t> bytes;
};

/// Text as an array of one text per row; `rows` in UTF-8, what is none of it becomes U+FFFD.
[[nodiscard]] Array text_array(std::string name, const std::vector<std::string>& rows, std::vector<std::size_t> shape);

/// Equal arrays give equal bytes. InputError when the file cannot be written.
void write_npz(const std::string& path, const std::vector<Array>& arrays);

}  // namespace fathom::recordings::numpy
