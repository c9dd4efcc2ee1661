#include "common/exports/models/formats.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <sstream>

#include "common/base/error.hpp"
#include "common/model/parameters.hpp"
#include "common/report/text.hpp"

namespace fathom::exports {

std::string exact(double value) {
  if (value == 0.0) return "0";  // no minus
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string identifier(const std::string& name) {
  std::string text;
  for (const unsigned char c : name) text += std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  return text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0 ? "vehicle_" + text : text;
}

std::string in_comment(const std::string& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {  // "--" ends a comment of XML
    text += words[i];
    if (words[i] == '-' && i + 1 < words.size() && words[i + 1] == '-') text += ' ';
  }
  return text;
}

std::string comment(const ModelFile& file, std::string_view mark) {
  std::string text;
  for (const std::string& note : file.unsaid) {
    text += mark;
    text += in_comment(note) + "\n";
  }
  return text;
}

ModelFile to_vehicle(const Craft& craft, const result::Stored& stored, const std::string& vehicle_text) {
  ModelFile file{.extension = "yaml", .text = {}, .unsaid = craft.notes};
  std::istringstream lines{vehicle_text};
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const bool top = !line.empty() && line[0] != ' ' && line[0] != '#' && line[0] != '\t';
    if (top) inside = line.starts_with("priors:");
    if (!inside) file.text += line + "\n";
  }
  for (const NamedValue& number : stored.result.parameters_after) {
    if (model::parameter_from_name(number.name) && !(std::isfinite(number.std) && number.std > 0.0))
      file.unsaid.push_back(number.name +
                            " has no deviation in the result: no prior is written; state the vehicle file's again");
  }
  file.text += "\n# Identified by fathom " + stored.version + " from: " + report::join(stored.result.train, ", ") +
               " (" + stored.path + ").\n" + comment(file, "# ") + "priors:\n";
  for (const NamedValue& number : stored.result.parameters_after) {
    if (!model::parameter_from_name(number.name)) continue;  // of an effect
    const double sigma = std::isfinite(number.std) && number.std > 0.0 ? number.std : 0.0;
    if (sigma <= 0.0) continue;  // said above
    file.text += "  " + number.name + ": {mean: " + exact(number.value) + " " + number.unit +
                 ", sigma: " + exact(sigma) + " " + number.unit + "}\n";
  }
  return file;
}

std::vector<std::string> model_formats() { return {"vehicle", "gz", "uuv", "stonefish", "holoocean", "mss", "json"}; }

ModelFile model_file(const std::string& to, const Craft& craft, const result::Stored& stored,
                     const std::string& vehicle_text) {
  if (to == "vehicle") return to_vehicle(craft, stored, vehicle_text);
  if (to == "gz") return to_gazebo(craft);
  if (to == "uuv") return to_uuv_simulator(craft);
  if (to == "stonefish") return to_stonefish(craft);
  if (to == "holoocean") return to_holoocean(craft);
  if (to == "mss") return to_mss(craft);
  if (to == "json") return to_json(craft, stored);
  throw InputError("--to " + to + ": no such format; known are " + report::join(model_formats(), ", "));
}

}  // namespace fathom::exports
