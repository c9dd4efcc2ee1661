// A learned force in result.json and on the report page: apart from causes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

class Album;

/// Complete: common/model/learned/learned_file.hpp reads it back.
[[nodiscard]] nlohmann::ordered_json correction_json(const CorrectionGiven& given);
/// HTML; empty where nothing unlisted was there to be learned.
[[nodiscard]] std::string correction_section(const DiagnosisResult& result, Album* album = nullptr);
/// One line of the first screen of an adopted one, HTML: how large, along what, what it gains. The whole sentence folds
/// out.
[[nodiscard]] std::string correction_line(const CorrectionGiven& given);
/// Plain words for the terminal; empty likewise.
[[nodiscard]] std::string correction_words(const DiagnosisResult& result);

}  // namespace fathom::report
