// Runs lines of bash on a network, and among processes, of their own: what they leave behind ends with them.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"

namespace fathom::test {

inline bool private_network() {
  if (shell("unshare -rnm --pid --fork --mount-proc true").code == 0) return true;
  MESSAGE("skipped: this machine allows no private network (unshare -rn)");
  return false;
}

/// In the scratch folder, with $deputy, $sheriff, $fathom, $configs, and `pid NAME`, `until_new NAME OLD_PID`,
/// `within SECONDS COMMAND...` (until it succeeds), `up FILE` (a deputy's words: it hears orders), `vehicle
/// [ARGUMENTS]` (a deputy of that name, $d; it is up). No fixed pauses: machines are slow at times.
inline Ran on_a_network(const Scratch& scratch, const std::string& lines, int seconds = 60) {
  write_bytes(
      scratch.path("script"),
      "ip link set lo up; ip route add 224.0.0.0/4 dev lo; cd " + scratch.path("") + "\n" +
          "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'\n" +
          "deputy=" + program("deputy") + " sheriff=" + program("sheriff") + " fathom=" + program("fathom") +
          " configs=" + file("procman") + "\n" +
          // Number of the program whose command line begins with $1, with or without its folder.
          "pid() { pgrep -f \"^(/[^ ]*/)?$1\" | head -n 1; }\n"
          "until_new() { for i in $(seq 400); do b=$(pid \"$1\"); [ -n \"$b\" ] && [ \"$b\" != \"$2\" ] && "
          "return; sleep 0.05; done; echo \"no new $1\"; }\n"
          "within() { local e=$((SECONDS + $1)) t=$1; shift; while ! \"$@\"; do sleep 0.05; [ $SECONDS -lt $e ] || "
          "{ echo \"not within $t s: $*\"; return 1; }; done; }\n"
          "up() { within 20 grep -qs 'waits for orders' $1; }\n"
          "vehicle() { rm -f deputy.txt; $deputy -i vehicle \"$@\" 2>deputy.txt & d=$!; up deputy.txt; }\n" +
          lines);
  return shell(limit(seconds) + "unshare -rnm --pid --fork --kill-child --mount-proc bash " + scratch.path("script"));
}

}  // namespace fathom::test
