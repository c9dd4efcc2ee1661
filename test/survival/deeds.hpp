// A trial by scripts/live in which processes are killed or halted, beside an undisturbed one; and when that was.
#pragma once

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "common/wire/log_reader.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom::test {

/// Lines of bash: `still` by the words in the folder still; then `disturbed` in the folder out, with `deeds` done
/// meanwhile. They may use in_mode MODE, slay DRIVER [SIGNAL] and arm.
inline std::string trials(const std::string& still, const std::string& disturbed, const std::string& environment,
                          const std::string& deeds) {
  const std::string live = environment + " FATHOM_BIN='" + FATHOM_BINARY_DIR +
                           "/bin' FATHOM_LIVE_BUS=$LCM_DEFAULT_URL " + file("scripts/live");
  return live + " $PWD/still " + still + " >still.txt 2>&1 || cat still.txt\n" +  //
         live + " $PWD/out " + disturbed + " >live.txt 2>&1 & l=$!\n" +
         "sleep 1; $fathom watch 2>watch.txt & w=$!\n"
         "in_mode() { while kill -0 $l 2>/dev/null; do tail -n 1 watch.txt | grep -q \"excite *$1\" && return; sleep "
         "0.05; "
         "done; echo \"no mode $1\"; }\n"
         "slay() { local p=fathom-$1 old at; old=$(pid $p); at=$(date +%s.%N); kill -${2:-9} $old || echo \"no $1\"; "
         "until_new $p $old; echo \"slain $1 $at $(date +%s.%N)\"; }\n"
         "arm() { $fathom arm --operator " +
         file("config/operators/simulated.yaml") + "; }\n" + deeds + "wait $l; echo \"code $?\"; kill $w\n";
}

struct Deed {
  std::string name;
  double died{}, back{};  ///< s since the epoch
};

inline std::vector<Deed> deeds_in(const std::string& text) {
  std::vector<Deed> deeds;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::string slain;
    Deed deed;
    if (words >> slain >> deed.name >> deed.died >> deed.back && slain == "slain") deeds.push_back(deed);
  }
  return deeds;
}

inline double seconds(Utime utime) { return 1e-6 * static_cast<double>(utime); }

struct Trial {
  Recording log;
  double origin{};  ///< s since the epoch

  explicit Trial(const std::string& folder) : log{wire::read_log(folder + "/run.lcmlog").recording} {
    origin = seconds(nlohmann::json::parse(read_bytes(folder + "/truth.json"))["origin_utime"].get<Utime>());
  }
};

}  // namespace fathom::test
