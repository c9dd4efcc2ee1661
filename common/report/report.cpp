// Writes the two files of a diagnosis.
#include "common/report/report.hpp"

#include <filesystem>
#include <fstream>

#include "common/base/error.hpp"
#include "common/report/json.hpp"
#include "common/report/page.hpp"

namespace fathom::report {
namespace {

void save(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw InputError(path + ": cannot be written; check the folder's permissions and free space");
}

}  // namespace

Written write(const DiagnosisReport& report, const std::string& folder, const VerdictGiven& given,
              const ResultOrigin& origin) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw InputError(folder + ": cannot be made (" + failed.message() + "); choose another --out");
  const std::filesystem::path base(folder);
  Written paths{(base / "result.json").string(), (base / "report.html").string()};
  save(paths.json, to_json(report.result, given, origin));
  save(paths.html, to_html(report));
  return paths;
}

}  // namespace fathom::report
