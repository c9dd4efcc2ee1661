#include "common/recordings/matlab/variables.hpp"

#include <matio.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <vector>

#include "common/recordings/little.hpp"

namespace fathom::recordings::matlab {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr rlim_t kMostMemory = RLIM_INFINITY;  // its shadow takes terabytes of addresses
#else
constexpr rlim_t kMostMemory = rlim_t{8} << 30U;  // bytes that a damaged file may ask for
#endif
constexpr rlim_t kMostSeconds = 600;
constexpr int kMostDepth = 16;
constexpr char kArray = 'A', kNote = 'N', kEnd = 'E';

class Sender {
 public:
  explicit Sender(int pipe) : pipe_(pipe) {}

  void variable(matvar_t* variable, const std::string& path, int depth) {
    if (variable == nullptr || depth > kMostDepth) return;
    switch (variable->class_type) {
      case MAT_C_STRUCT:
        return structure(variable, path, depth);
      case MAT_C_DOUBLE:
        return numbers<double>(variable, path);
      case MAT_C_SINGLE:
        return numbers<float>(variable, path);
      case MAT_C_INT8:
        return numbers<std::int8_t>(variable, path);
      case MAT_C_UINT8:
        return numbers<std::uint8_t>(variable, path);
      case MAT_C_INT16:
        return numbers<std::int16_t>(variable, path);
      case MAT_C_UINT16:
        return numbers<std::uint16_t>(variable, path);
      case MAT_C_INT32:
        return numbers<std::int32_t>(variable, path);
      case MAT_C_UINT32:
        return numbers<std::uint32_t>(variable, path);
      case MAT_C_INT64:
        return numbers<std::int64_t>(variable, path);
      case MAT_C_UINT64:
        return numbers<std::uint64_t>(variable, path);
      case MAT_C_CHAR:
      case MAT_C_EMPTY:
        return;  // words
      case MAT_C_OPAQUE:
      case MAT_C_OBJECT:
        return note("variables that only MATLAB understands (table, timetable, datetime, string): " + path +
                    "; save them as arrays");
      default:
        return note("variables of a kind that is not read (cell, sparse, function): " + path);
    }
  }

  void note(const std::string& text) {
    const auto length = static_cast<std::uint32_t>(text.size());
    put(&kNote, 1);
    put(&length, sizeof length);
    put(text.data(), text.size());
  }

  void end() { put(&kEnd, 1); }

 private:
  void structure(matvar_t* variable, const std::string& path, int depth) {
    const unsigned fields = Mat_VarGetNumberOfFields(variable);
    char* const* names = Mat_VarGetStructFieldnames(variable);
    std::size_t elements = 1;
    for (int i = 0; i < variable->rank; ++i) elements *= variable->dims[i];
    if (names == nullptr || elements == 0) return;
    for (unsigned f = 0; f < fields; ++f) {
      const std::string own = path + "." + (names[f] == nullptr ? "" : names[f]);
      if (elements == 1) {
        this->variable(Mat_VarGetStructFieldByIndex(variable, f, 0), own, depth + 1);
      } else {
        records(variable, f, elements, own);
      }
    }
  }

  /// A list of structs with one number each is a column.
  void records(matvar_t* variable, unsigned field, std::size_t elements, const std::string& path) {
    std::vector<double> column;
    for (std::size_t i = 0; i < elements; ++i) {
      const matvar_t* one = Mat_VarGetStructFieldByIndex(variable, field, i);
      if (one == nullptr || one->class_type != MAT_C_DOUBLE || one->nbytes != sizeof(double) || one->data == nullptr ||
          one->isComplex != 0)
        return note("lists of structs whose field is no single number: " + path);
      column.push_back(*static_cast<const double*>(one->data));
    }
    send(path, {elements, 1}, column);
  }

  template <class T>
  void numbers(const matvar_t* variable, const std::string& path) {
    if (variable->isComplex != 0) return note("complex variables: " + path);
    if (variable->data == nullptr || variable->rank < 1 || variable->rank > 8) return;
    std::vector<std::size_t> shape(variable->dims, variable->dims + variable->rank);
    std::size_t count = 1;
    for (const std::size_t side : shape) count *= side;
    if (static_cast<std::size_t>(variable->data_size) != sizeof(T) || variable->nbytes < count * sizeof(T)) return;
    const T* data = static_cast<const T*>(variable->data);
    std::vector<double> values(data, data + count);
    send(path, shape, values);
  }

  void send(const std::string& path, const std::vector<std::size_t>& shape, const std::vector<double>& values) {
    const auto length = static_cast<std::uint32_t>(path.size());
    const auto sides = static_cast<std::uint32_t>(shape.size());
    const std::uint64_t count = values.size();
    put(&kArray, 1);
    put(&length, sizeof length);
    put(path.data(), path.size());
    put(&sides, sizeof sides);
    put(shape.data(), shape.size() * sizeof(std::size_t));
    put(&count, sizeof count);
    put(values.data(), values.size() * sizeof(double));
  }

  void put(const void* bytes, std::size_t count) {
    const char* at = static_cast<const char*>(bytes);
    while (count > 0) {
      const ssize_t written = ::write(pipe_, at, count);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) ::_exit(1);
      at += written;
      count -= static_cast<std::size_t>(written);
    }
  }

  int pipe_;
};

/// Fields off the front; once one is missing all are.
class Front {
 public:
  explicit Front(Bytes bytes) : bytes_(bytes) {}
  bool take(void* to, std::size_t count) {
    if (count > bytes_.size()) return false;
    if (count > 0) std::memcpy(to, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return true;
  }
  bool text(std::string& to) {
    std::uint32_t length = 0;
    if (!take(&length, sizeof length) || length > bytes_.size()) return false;
    to.resize(length);
    return take(to.data(), length);
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  Bytes bytes_;
};

}  // namespace

void send_variables(const std::string& path, int pipe) {
  const rlimit memory{kMostMemory, kMostMemory}, seconds{kMostSeconds, kMostSeconds}, no_core{0, 0};
  (void)::setrlimit(RLIMIT_AS, &memory);
  (void)::setrlimit(RLIMIT_CPU, &seconds);
  (void)::setrlimit(RLIMIT_CORE, &no_core);
  Mat_LogInitFunc("fathom", [](int, char*) {});  // its complaints are ours to make
  Sender sender{pipe};
  try {
    mat_t* file = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
    if (file == nullptr) ::_exit(1);
    while (matvar_t* variable = Mat_VarReadNext(file)) {
      sender.variable(variable, variable->name == nullptr ? "unnamed" : variable->name, 0);
      Mat_VarFree(variable);
    }
    Mat_Close(file);
  } catch (const std::exception&) {  // no memory for what it claims
    ::_exit(1);
  }
  sender.end();
}

bool received(Bytes bytes, std::vector<arrays::Array>& all, Damage& damage) {
  Front front{bytes};
  char kind = 0;
  while (front.take(&kind, 1)) {
    if (kind == kEnd) return true;
    if (kind == kNote) {
      std::string text;
      if (!front.text(text)) return false;
      damage.add(text);
      continue;
    }
    arrays::Array array;
    std::uint32_t sides = 0;
    std::uint64_t count = 0;
    if (kind != kArray || !front.text(array.path) || !front.take(&sides, sizeof sides) || sides > 8) return false;
    array.shape.resize(sides);
    if (!front.take(array.shape.data(), sides * sizeof(std::size_t)) || !front.take(&count, sizeof count) ||
        count > front.left() / sizeof(double))
      return false;
    array.values.resize(count);
    if (!front.take(array.values.data(), count * sizeof(double))) return false;
    all.push_back(std::move(array));
  }
  return false;
}

}  // namespace fathom::recordings::matlab
