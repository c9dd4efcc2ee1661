// result.json of a diagnosis read back: what report::to_json wrote, as the same structs. Keys that this version does
// not know are ignored, keys that an older file lacks leave their field empty.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/result_origin.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::result {

struct Stored {
  std::string path;        ///< of the file
  std::string version;     ///< that wrote it
  std::string begin, end;  ///< date of the data, as the file has it; empty: unknown
  DiagnosisResult result;
  VerdictGiven given;
  ResultOrigin origin;
};

/// `path`: the file, or the folder that holds it. InputError when it is not there, no result of a diagnosis, of a later
/// schema, or has a key of another type than the schema says.
[[nodiscard]] Stored read_result(const std::string& path);

}  // namespace fathom::result
