#include "common/exports/any_message.hpp"

#include <bit>
#include <cmath>

#include "common/base/event_format.hpp"

namespace fathom::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kFingerprint = 8;  // bytes

struct Cut {};  // the message ends where a field should be

class Decoder {
 public:
  Decoder(const Definitions& definitions, std::span<const std::uint8_t> bytes, Bytes kept)
      : definitions_{definitions}, bytes_{bytes}, kept_{kept} {}

  Json structure(const Type& type) {
    constexpr int kDeepest = 32;  // a type may hold a list of its own kind
    if (++depth_ > kDeepest) throw Cut{};
    Json object = Json::object();
    for (const Field& field : type.fields) object[field.name] = value(type, field, object, 0);
    --depth_;
    return object;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size()) throw Cut{};
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  template <class Unsigned>
  Unsigned big() {
    return event_format::big_endian<Unsigned>(take(sizeof(Unsigned)));
  }

  /// Lengths are bounded by the bytes that are left: an element takes at least one.
  std::size_t length(const std::string& size, const Json& object) {
    const std::int64_t count = object.contains(size) ? object.at(size).get<std::int64_t>() : std::stoll(size);
    if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size()) throw Cut{};
    return static_cast<std::size_t>(count);
  }

  Json value(const Type& type, const Field& field, const Json& object, std::size_t dimension) {
    // Elements without a byte (lists of nothing) must not come without end.
    if (++elements_ > most_) throw Cut{};
    if (dimension == field.sizes.size()) return scalar(type, field);
    const std::size_t count = length(field.sizes[dimension], object);
    if (field.type == "byte" && dimension + 1 == field.sizes.size()) {
      const auto taken = take(count);
      return kept_ == Bytes::kBase64 ? Json(base64(taken)) : Json(count);
    }
    Json array = Json::array();
    for (std::size_t i = 0; i < count; ++i) array.push_back(value(type, field, object, dimension + 1));
    return array;
  }

  static Json real(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

  Json scalar(const Type& type, const Field& field) {
    const std::string& name = field.type;
    if (name == "double") return real(std::bit_cast<double>(big<std::uint64_t>()));
    if (name == "float") return real(static_cast<double>(std::bit_cast<float>(big<std::uint32_t>())));
    if (name == "int64_t") return static_cast<std::int64_t>(big<std::uint64_t>());
    if (name == "int32_t") return static_cast<std::int32_t>(big<std::uint32_t>());
    if (name == "int16_t") return static_cast<std::int16_t>(big<std::uint16_t>());
    if (name == "int8_t") return static_cast<std::int8_t>(big<std::uint8_t>());
    if (name == "byte") return big<std::uint8_t>();
    if (name == "boolean") return big<std::uint8_t>() != 0;
    if (name != "string") return structure(definitions_.type(type.package, name));
    const auto size = big<std::uint32_t>();  // with the zero at its end
    if (size == 0) throw Cut{};
    const auto text = take(size);
    return std::string{text.begin(), text.end() - 1};
  }

  const Definitions& definitions_;
  std::span<const std::uint8_t> bytes_;
  Bytes kept_;
  int depth_{};
  std::size_t elements_{}, most_{bytes_.size() + 65536};
};

Json schema_of_field(const Definitions& definitions, const Type& type, const Field& field) {
  Json inner;
  if (field.type == "byte" && !field.sizes.empty()) {
    inner = {{"type", "string"}, {"contentEncoding", "base64"}};
  } else if (field.type == "double" || field.type == "float") {
    inner = {{"type", "number"}};
  } else if (field.type == "boolean") {
    inner = {{"type", "boolean"}};
  } else if (field.type == "string") {
    inner = {{"type", "string"}};
  } else if (field.primitive()) {
    inner = {{"type", "integer"}};
  } else {
    inner = json_schema(definitions, definitions.type(type.package, field.type));
  }
  const std::size_t nested = field.sizes.size() - (field.type == "byte" && !field.sizes.empty() ? 1 : 0);
  for (std::size_t i = 0; i < nested; ++i) inner = Json{{"type", "array"}, {"items", inner}};
  if (!field.comment.empty()) inner["description"] = field.comment;
  return inner;
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8U | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kLetters[(group >> (18U - 6U * k)) & 63U] : '=';
  }
  return text;
}

std::optional<Json> decoded(const Definitions& definitions, const Type& type, std::span<const std::uint8_t> message,
                            Bytes bytes) {
  if (message.size() < kFingerprint) return std::nullopt;
  try {
    Decoder decoder{definitions, message.subspan(kFingerprint), bytes};
    Json value = decoder.structure(type);
    if (!decoder.at_end()) return std::nullopt;
    return value;
  } catch (const Cut&) {
    return std::nullopt;
  }
}

Json json_schema(const Definitions& definitions, const Type& type) {
  Json properties = Json::object();
  for (const Field& field : type.fields) properties[field.name] = schema_of_field(definitions, type, field);
  Json schema{{"title", type.package + "." + type.name}, {"type", "object"}};
  if (!type.comment.empty()) schema["description"] = type.comment;
  schema["properties"] = properties;
  return schema;
}

}  // namespace fathom::exports
