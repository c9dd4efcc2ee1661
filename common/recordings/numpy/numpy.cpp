#include "common/recordings/numpy/numpy.hpp"

#include <zip.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recordings/arrays/arrays.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/numpy/header.hpp"

namespace fathom::recordings::numpy {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMostBytes = std::size_t{1} << 31U;  // of one array
constexpr std::size_t kPiece = std::size_t{1} << 20U;

template <class T>
T value_of(Bytes bytes, std::size_t at, bool is_big) {
  return is_big ? big<T>(bytes, at) : little<T>(bytes, at);
}

bool readable(const Member& member) {
  switch (member.kind) {
    case 'b':
      return member.size == 1;
    case 'i':
    case 'u':
      return member.size == 1 || member.size == 2 || member.size == 4 || member.size == 8;
    case 'f':
      return member.size == 2 || member.size == 4 || member.size == 8;
    case 'M':
      return member.size == 8 && member.to_seconds > 0.0;
    default:
      return false;
  }
}

double number(const Member& member, Bytes element) {
  const std::size_t at = member.offset;
  switch (member.kind) {
    case 'b':
      return element[at];
    case 'i':
      return member.size == 1   ? static_cast<std::int8_t>(element[at])
             : member.size == 2 ? value_of<std::int16_t>(element, at, member.big)
             : member.size == 4 ? value_of<std::int32_t>(element, at, member.big)
                                : static_cast<double>(value_of<std::int64_t>(element, at, member.big));
    case 'u':
      return member.size == 1   ? element[at]
             : member.size == 2 ? value_of<std::uint16_t>(element, at, member.big)
             : member.size == 4 ? value_of<std::uint32_t>(element, at, member.big)
                                : static_cast<double>(value_of<std::uint64_t>(element, at, member.big));
    case 'M': {
      const auto ticks = value_of<std::int64_t>(element, at, member.big);
      return ticks == std::numeric_limits<std::int64_t>::min() ? std::nan("")
                                                               : static_cast<double>(ticks) * member.to_seconds;
    }
    default:
      return member.size == 2   ? half(value_of<std::uint16_t>(element, at, member.big))
             : member.size == 4 ? static_cast<double>(value_of<float>(element, at, member.big))
                                : value_of<double>(element, at, member.big);
  }
}

/// One .npy to arrays; the complaint where it cannot be.
std::string take(const std::string& name, Bytes bytes, std::vector<arrays::Array>& out) {
  if (bytes.size() < 12 || !std::equal(kMagic.begin(), kMagic.end(), reinterpret_cast<const char*>(bytes.data())))
    return "is no array";
  const int version = bytes[6];
  if (version < 1 || version > 3) return "has a version that is not known";
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length = version == 1 ? little<std::uint16_t>(bytes, 8) : little<std::uint32_t>(bytes, 8);
  if (length > bytes.size() - start) return "is cut off within its header";
  std::string reason;
  const std::optional<Header> header = header_of({reinterpret_cast<const char*>(bytes.data()) + start, length}, reason);
  if (!header) return reason;
  if (std::ranges::any_of(header->members, [](const Member& one) { return one.kind == 'O'; }))
    return "holds pickled objects, which are never loaded; save numbers";
  const Bytes data = bytes.subspan(start + length);
  std::size_t count = 1;
  for (const std::size_t side : header->shape) {
    if (side != 0 && count > kMostBytes / side) return "claims more elements than a file can hold";
    count *= side;
  }
  if (header->element == 0 || count > data.size() / header->element)
    return count == 0 ? "" : "is cut off: fewer elements than its shape says";
  std::string passed;
  for (const Member& member : header->members) {
    if (!readable(member)) {
      if (member.kind != 'U' && member.kind != 'S')
        passed = "has numbers of a kind that is not read";  // words are no numbers
      continue;
    }
    arrays::Array array{.path = name + (member.name.empty() ? "" : "." + member.name),
                        .shape = header->shape,
                        .values = {},
                        .date = member.kind == 'M'};
    array.values.resize(count);
    const std::size_t rows = header->shape.size() == 2 ? header->shape[0] : 1,
                      columns = header->shape.size() == 2 ? header->shape[1] : count;
    for (std::size_t i = 0; i < count; ++i) {
      // Rows one behind the other in the file become columns one behind the other.
      const std::size_t to = header->fortran || header->shape.size() != 2 ? i : (i % columns) * rows + i / columns;
      array.values[to] = number(member, data.subspan(i * header->element, header->element));
    }
    out.push_back(std::move(array));
  }
  return passed;
}

std::string plain_name(std::string name) {
  if (name.ends_with(".npy")) name.resize(name.size() - 4);
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace

bool is_npy(Bytes head) {
  return head.size() >= 12 && std::equal(kMagic.begin(), kMagic.end(), reinterpret_cast<const char*>(head.data()));
}

void read_npy(const std::string& path, Sink& sink, Damage& damage) {
  FileWindow file{path};
  if (file.size() > kMostBytes) throw InputError(path + ": an array of more than two gigabytes");
  std::vector<arrays::Array> all;
  if (const std::string complaint = take("array", file.at(0, static_cast<std::size_t>(file.size())), all);
      !complaint.empty()) {
    if (all.empty()) throw InputError(path + ": " + complaint);
    damage.add("array that " + complaint);
  }
  for (arrays::Array& each : all) {  // a table of its own
    if (each.path.starts_with("array.")) each.path.erase(0, 6);
  }
  arrays::say(all, sink, damage);
}

bool is_npz(Bytes head) {
  constexpr std::size_t kLocal = 30;
  if (head.size() < kLocal || little<std::uint32_t>(head) != 0x04034B50) return false;
  const std::size_t length = little<std::uint16_t>(head, 26);
  if (head.size() < kLocal + length) return false;
  const std::string_view text{reinterpret_cast<const char*>(head.data()), head.size()};
  return text.substr(kLocal, length).ends_with(".npy") || text.find(".npy") != std::string_view::npos;
}

void read_npz(const std::string& path, Sink& sink, Damage& damage) {
  int error = 0;
  const std::unique_ptr<zip_t, decltype(&zip_discard)> archive{zip_open(path.c_str(), ZIP_RDONLY, &error), zip_discard};
  if (!archive) {
    zip_error_t why;
    zip_error_init_with_code(&why, error);
    const std::string words = zip_error_strerror(&why);
    zip_error_fini(&why);
    throw InputError(path + ": cannot be read as a zip of arrays: " + words);
  }
  std::vector<arrays::Array> all;
  std::vector<std::uint8_t> bytes;
  const zip_int64_t entries = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < entries; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* name = zip_get_name(archive.get(), index, 0);
    const std::string member = name == nullptr ? "" : name;
    if (!member.ends_with(".npy")) {
      damage.add("members that are no array (" + member + ")");
      continue;
    }
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file{zip_fopen_index(archive.get(), index, 0), zip_fclose};
    bytes.clear();
    zip_int64_t got = file ? 1 : -1;
    while (got > 0 && bytes.size() < kMostBytes) {  // grows as bytes come, whatever the directory claims
      const std::size_t at = bytes.size();
      bytes.resize(at + kPiece);
      got = zip_fread(file.get(), bytes.data() + at, kPiece);
      bytes.resize(at + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
    }
    if (got < 0) {  // a wrong checksum among them: which number is wrong nobody can say
      damage.add("members that cannot be unpacked rightly (" + member + ")");
      continue;
    }
    if (const std::string complaint = take(plain_name(member), bytes, all); !complaint.empty())
      damage.add("member " + member + ", which " + complaint);
  }
  arrays::say(all, sink, damage);
}

}  // namespace fathom::recordings::numpy
