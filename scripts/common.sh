# Shared by ./trial and ./check: say, install, build. To be sourced from the top folder with `set -eu -o pipefail`.

say() { if [ -t 2 ]; then printf '\033[1m==> %s\033[0m\n' "$*" >&2; else printf '==> %s\n' "$*" >&2; fi; }
fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# install_missing LIST...: installs what the lists name and the machine lacks; does nothing, quickly, when all is there.
install_missing() {
  local wanted missing=() package as_root=()
  wanted=$(sed 's/#.*//' "$@")
  command -v dpkg-query >/dev/null || fail "not a Debian system; install by hand: $(echo $wanted)"
  local present
  # dpkg-query fails when it has never heard of one of them; what it prints of the others is still right.
  present=$({ dpkg-query -W -f='${Package} ${db:Status-Status}\n' $wanted 2>/dev/null || true; } | sed -n 's/ installed$//p')
  for package in $wanted; do
    grep -qx "$package" <<<"$present" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "root or sudo is needed to install: ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  local log
  log=$(mktemp)
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=120 -q)
  if ! { "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null >"$log" 2>&1 ||
    { "${apt[@]}" update </dev/null >"$log" 2>&1 &&
      "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null >>"$log" 2>&1; }; }; then
    tail -n 15 "$log" >&2
    rm -f "$log"
    fail "apt-get could not install ${missing[*]}"
  fi
  rm -f "$log"
}

# build PRESET [TARGET...]: configures where needed and compiles all or some targets; ninja shows how far it is.
build() {
  local log launcher=() target=()
  [ $# -lt 2 ] || target=(--target "${@:2}")
  log=$(mktemp)
  command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  say "building (preset $1)"
  if ! cmake --preset "$1" "${launcher[@]}" >"$log" 2>&1; then
    tail -n 25 "$log" >&2
    rm -f "$log"
    fail "cmake could not configure the build"
  fi
  rm -f "$log"
  if [ -t 2 ]; then
    cmake --build --preset "$1" "${target[@]}" >&2 || fail "the build failed"
  else  # one line for every tenth step, everything of a failure
    cmake --build --preset "$1" "${target[@]}" 2>&1 | awk '
      /^\[[0-9]+\/[0-9]+\]/ { split(substr($1, 2), n, /[\/\]]/); if (int(n[1] * 10 / n[2]) > tenth) { tenth = int(n[1] * 10 / n[2]); print; fflush() } if (!bad) next }
      /FAILED|error:/ { bad = 1 } bad { print }' >&2 || fail "the build failed"
  fi
}

# True when LCM's multicast address has a route.
multicast_route() { ip route get 239.255.76.67 >/dev/null 2>&1; }
