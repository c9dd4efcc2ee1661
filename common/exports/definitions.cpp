#include "common/exports/definitions.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/event_format.hpp"

namespace fathom::exports {
namespace {

// LCM's fingerprints (lcmgen.c, lcm_struct_hash): names of fields, names of primitive types and shapes.
void take(std::uint64_t& hash, std::int8_t byte) {
  const auto value = static_cast<std::int64_t>(hash);
  hash = ((hash << 8U) ^ static_cast<std::uint64_t>(value >> 55)) + static_cast<std::uint64_t>(std::int64_t{byte});
}

void take(std::uint64_t& hash, const std::string& text) {
  take(hash, static_cast<std::int8_t>(text.size()));
  for (const char c : text) take(hash, static_cast<std::int8_t>(c));
}

std::uint64_t own_hash(const Type& type) {
  std::uint64_t hash = 0x12345678;
  for (const Field& field : type.fields) {
    take(hash, field.name);
    if (field.primitive()) take(hash, field.type);
    take(hash, static_cast<std::int8_t>(field.sizes.size()));
    for (const std::string& size : field.sizes) {
      const bool fixed = std::ranges::all_of(size, [](char c) { return c >= '0' && c <= '9'; });
      take(hash, static_cast<std::int8_t>(fixed ? 0 : 1));
      take(hash, size);
    }
  }
  return hash;
}

}  // namespace

Definitions::Definitions(std::span<const std::string_view> texts, std::span<const std::string> paths) {
  for (std::size_t i = 0; i < texts.size(); ++i) {
    for (Type& type : types_in(texts[i], i < paths.size() ? paths[i] : "message types"))
      types_[type.package + "." + type.name] = std::move(type);
  }
  for (const auto& [name, type] : types_) by_fingerprint_[fingerprint(type)] = &type;
}

const Definitions& Definitions::built_in() {
  static const Definitions definitions{definition_texts()};
  return definitions;
}

const Type& Definitions::type(const std::string& package, const std::string& name) const {
  const bool whole = name.find('.') != std::string::npos;  // of another package
  const auto found = types_.find(whole ? name : package + "." + name);
  if (found == types_.end()) throw InputError("message type " + package + "." + name + ": is not defined");
  return found->second;
}

std::uint64_t Definitions::summed(const Type& type, std::vector<const Type*>& above) const {
  if (std::ranges::find(above, &type) != above.end()) return 0;
  above.push_back(&type);
  std::uint64_t hash = own_hash(type);
  for (const Field& field : type.fields) {
    if (!field.primitive()) hash += summed(this->type(type.package, field.type), above);
  }
  above.pop_back();
  return (hash << 1U) + ((hash >> 63U) & 1U);
}

std::uint64_t Definitions::fingerprint(const Type& type) const {
  std::vector<const Type*> above;
  return summed(type, above);
}

const Type* Definitions::type_of(std::span<const std::uint8_t> message) const {
  if (message.size() < 8) return nullptr;
  const auto found = by_fingerprint_.find(event_format::big_endian<std::uint64_t>(message));
  return found == by_fingerprint_.end() ? nullptr : found->second;
}

}  // namespace fathom::exports
