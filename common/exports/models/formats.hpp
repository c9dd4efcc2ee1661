// Models as other simulators read them. Signs, frames and names are those of each simulator's documentation, named in
// its source file here; what a format cannot say stands in the file as a comment, and in `unsaid`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/exports/models/craft.hpp"

namespace fathom::exports {

struct ModelFile {
  std::string extension;  ///< "sdf"
  std::string text;
  std::vector<std::string> unsaid;
};

/// `to`: "vehicle", "gz", "uuv", "stonefish", "holoocean", "mss" or "json". `vehicle_text`: the vehicle's file.
/// InputError for another name.
[[nodiscard]] ModelFile model_file(const std::string& to, const Craft& craft, const result::Stored& stored,
                                   const std::string& vehicle_text);

[[nodiscard]] std::vector<std::string> model_formats();

[[nodiscard]] ModelFile to_gazebo(const Craft& craft);
[[nodiscard]] ModelFile to_uuv_simulator(const Craft& craft);
[[nodiscard]] ModelFile to_stonefish(const Craft& craft);
[[nodiscard]] ModelFile to_holoocean(const Craft& craft);
[[nodiscard]] ModelFile to_mss(const Craft& craft);
[[nodiscard]] ModelFile to_json(const Craft& craft, const result::Stored& stored);
/// The vehicle's file with the identified numbers as its priors.
[[nodiscard]] ModelFile to_vehicle(const Craft& craft, const result::Stored& stored, const std::string& vehicle_text);

// Small words that the formats share.
/// Shortest text that reads back as the same number.
[[nodiscard]] std::string exact(double value);
/// All of `values` so, `between` them.
template <class Values>
[[nodiscard]] std::string exact(const Values& values, std::string_view between) {
  std::string text;
  for (const double value : values) text += (text.empty() ? std::string{} : std::string{between}) + exact(value);
  return text;
}
/// "name" with what an identifier must not have as '_'.
[[nodiscard]] std::string identifier(const std::string& name);
/// Words as a comment of XML may hold them.
[[nodiscard]] std::string in_comment(const std::string& words);
/// Each note a line behind `mark`.
[[nodiscard]] std::string comment(const ModelFile& file, std::string_view mark);
/// Forward-right-down to forward-left-up, and back.
[[nodiscard]] inline Eigen::Vector3d flipped(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

}  // namespace fathom::exports
