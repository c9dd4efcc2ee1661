// Live trials by scripts/live in a scratch folder, for tests of whole trials.
#pragma once

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"

namespace fathom::test {

inline bool live_network() {
  if (shell("unshare -rn ip link set lo up").code == 0) return true;
  MESSAGE("skipped: this machine allows no private network (unshare -rn)");
  return false;
}

/// The command; its folder is `out` in the scratch folder.
inline std::string live(const Scratch& scratch, const std::string& words) {
  return "FATHOM_BIN='" + std::string{FATHOM_BINARY_DIR} + "/bin' env --default-signal=INT " + limit(120) +
         file("scripts/live") + " '" + scratch.path("out") + "' " + words;
}

inline nlohmann::json result_of(const Scratch& scratch) {
  std::ifstream text{scratch.path("out/result.json")};
  return nlohmann::json::parse(text);
}

/// Processes that carry this test's folder in their command line, the shell that asks aside.
inline bool nothing_left(const Scratch& scratch) {
  return shell("for i in $(seq 40); do pgrep -f '" + scratch.path("ou") +
               "[t]/' >/dev/null || exit 0; sleep 0.05; done; exit 1")
             .code == 0;
}

}  // namespace fathom::test
