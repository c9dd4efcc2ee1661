#include "common/recordings/numpy/writer.hpp"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>

#include "common/base/error.hpp"

namespace fathom::recordings::numpy {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

// NEP 1: magic, version 1.0, length of the header, a dictionary padded with blanks to a multiple of 64.
std::vector<std::uint8_t> as_npy(const Array& array) {
  std::string shape = "(";
  for (const std::size_t size : array.shape) shape += std::to_string(size) + ",";
  std::string header = "{'descr': '" + array.type + "', 'fortran_order': False, 'shape': " + shape + "), }";
  constexpr std::size_t kFixed = 10, kMultiple = 64;
  header.append(kMultiple - (kFixed + header.size() + 1) % kMultiple, ' ');
  header += '\n';
  std::vector<std::uint8_t> npy{0x93,
                                'N',
                                'U',
                                'M',
                                'P',
                                'Y',
                                1,
                                0,
                                static_cast<std::uint8_t>(header.size() & 0xFFU),
                                static_cast<std::uint8_t>(header.size() >> 8U)};
  npy.insert(npy.end(), header.begin(), header.end());
  npy.insert(npy.end(), array.bytes.begin(), array.bytes.end());
  return npy;
}

std::u32string code_points(const std::string& text) {
  constexpr char32_t kReplacement = 0xFFFD;
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t more = lead < 0x80 ? 0 : lead >> 5U == 6 ? 1 : lead >> 4U == 14 ? 2 : lead >> 3U == 30 ? 3 : 4;
    char32_t point = more == 0 ? lead : lead & (0x3FU >> more);
    bool good = more < 4 && i + more < text.size();
    for (std::size_t k = 1; good && k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = next >> 6U == 2;
      point = point << 6U | (next & 0x3FU);
    }
    good = good && point <= 0x10FFFF;
    points += good ? point : kReplacement;
    i += good ? more + 1 : 1;
  }
  return points;
}

[[noreturn]] void fail(const std::string& path, zip_t* archive) {
  throw InputError(path + ": cannot be written: " + zip_strerror(archive));
}

}  // namespace

Array text_array(std::string name, const std::vector<std::string>& rows, std::vector<std::size_t> shape) {
  std::vector<std::u32string> texts;
  std::size_t longest = 1;  // NumPy knows no text of no characters
  for (const std::string& row : rows) {
    texts.push_back(code_points(row));
    longest = std::max(longest, texts.back().size());
  }
  Array array{.name = std::move(name), .type = "<U" + std::to_string(longest), .shape = std::move(shape)};
  array.bytes.resize(texts.size() * longest * sizeof(char32_t));
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::memcpy(array.bytes.data() + i * longest * sizeof(char32_t), texts[i].data(),
                texts[i].size() * sizeof(char32_t));
  return array;
}

void write_npz(const std::string& path, const std::vector<Array>& arrays) {
  int error = 0;
  std::unique_ptr<zip_t, decltype(&zip_discard)> archive{zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error),
                                                         zip_discard};
  if (!archive) {
    zip_error_t why;
    zip_error_init_with_code(&why, error);
    const std::string words = zip_error_strerror(&why);
    zip_error_fini(&why);
    throw InputError(path + ": cannot be written: " + words);
  }
  std::vector<std::vector<std::uint8_t>> members;  // read when the archive is closed
  members.reserve(arrays.size());
  for (const Array& array : arrays) {
    members.push_back(as_npy(array));
    zip_source_t* source = zip_source_buffer(archive.get(), members.back().data(), members.back().size(), 0);
    if (source == nullptr) fail(path, archive.get());
    const zip_int64_t index =
        zip_file_add(archive.get(), (array.name + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8 | ZIP_FL_OVERWRITE);
    if (index < 0) {
      zip_source_free(source);
      fail(path, archive.get());
    }
    constexpr std::uint16_t kFirstDay = 33;  // 1 January 1980: no clock of this machine in the file
    const auto at = static_cast<zip_uint64_t>(index);
    if (zip_set_file_compression(archive.get(), at, ZIP_CM_STORE, 0) < 0 ||
        zip_file_set_dostime(archive.get(), at, 0, kFirstDay, 0) < 0)
      fail(path, archive.get());
  }
  if (zip_close(archive.get()) < 0) fail(path, archive.get());
  static_cast<void>(archive.release());
}

}  // namespace fathom::recordings::numpy
