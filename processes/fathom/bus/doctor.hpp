// What may keep a trial from running on this host, each with the command that mends it.
#pragma once

#include <string>
#include <vector>

namespace fathom::tool {

struct Finding {
  enum class Grade { kWell, kRemark, kBad };  ///< a remark keeps nothing from running
  Grade grade{};
  std::string what;   ///< "clock", "disk"
  std::string found;  ///< one phrase
  std::string mend;   ///< command or advice; empty when all is well
};

[[nodiscard]] std::vector<Finding> check_programs();
[[nodiscard]] std::vector<Finding> check_network(const std::string& url);
[[nodiscard]] std::vector<Finding> check_buffers();
[[nodiscard]] Finding check_clock();
[[nodiscard]] Finding check_disk(const std::string& folder);
/// The links of every driver in a configuration.
[[nodiscard]] std::vector<Finding> check_devices(const std::string& config);
[[nodiscard]] Finding check_operator(const std::string& file);

}  // namespace fathom::tool
