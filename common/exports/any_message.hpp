// Any message of a log as a tree of named values, by its type's definition.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "common/exports/definitions.hpp"

namespace fathom::exports {

/// Bytes as JSON has them: text in base64 (RFC 4648).
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

enum class Bytes { kBase64, kCount };  ///< what becomes of an array of bytes

/// Fields in the type's order; numbers that are not finite are null. Nothing where the message is damaged: cut off, too
/// long, or with a length that its bytes cannot hold.
[[nodiscard]] std::optional<nlohmann::ordered_json> decoded(const Definitions& definitions, const Type& type,
                                                            std::span<const std::uint8_t> message,
                                                            Bytes bytes = Bytes::kBase64);

/// JSON Schema of what decoded() gives, with the comments as descriptions.
[[nodiscard]] nlohmann::ordered_json json_schema(const Definitions& definitions, const Type& type);

}  // namespace fathom::exports
