# shellcheck shell=bash disable=SC2164
# What tools/demo and tools/test have in common. Sourced by bash after `set -euo pipefail`.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n==> %s\n' "$*"; }

fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# packages GROUP...: the package names of these groups in tools/packages.
packages() {
  local group name
  while read -r group name; do
    if [[ " $* " == *" $group "* ]]; then printf '%s\n' "$name"; fi
  done <"$root/tools/packages" | sort -u
}

# missing_packages GROUP...: those of them that are not installed.
missing_packages() {
  local name
  while read -r name; do
    if [[ $(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null) != installed ]]; then printf '%s\n' "$name"; fi
  done < <(packages "$@")
}

# install_packages GROUP...: installs what is missing, and does not call apt when nothing is.
install_packages() {
  local missing as_root=(env DEBIAN_FRONTEND=noninteractive)
  if ! command -v apt-get >/dev/null; then
    say "No apt-get here, so nothing is installed. What is needed, by its Debian names: $(packages "$@" | xargs)"
    return
  fi
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    say "The Debian packages of tools/packages are installed already"
    return
  fi
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      fail "there is no sudo; run this as root first: apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo "${as_root[@]}")
  fi
  say "Installing Debian packages: ${missing[*]}"
  "${as_root[@]}" apt-get -q update
  "${as_root[@]}" apt-get -q -y --no-install-recommends install "${missing[@]}"
}

# jobs_at_once: one per processor, but no more than one per 2 GB of free memory.
jobs_at_once() {
  local processors memory
  processors=$(nproc)
  memory=$(awk '/^MemAvailable:/ { print int($2 / 2097152) }' /proc/meminfo 2>/dev/null || true)
  if [[ -n $memory ]] && ((memory < processors)); then processors=$memory; fi
  echo $((processors > 0 ? processors : 1))
}

# build PRESET [OPTION...]: configures and builds in build/PRESET; the options go to `cmake --build`.
build() {
  local preset=$1
  shift
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(jobs_at_once)}
  cd "$root"
  say "Configuring build/$preset"
  cmake --preset "$preset"
  say "Building, $CMAKE_BUILD_PARALLEL_LEVEL files at a time; this takes some minutes the first time"
  cmake --build --preset "$preset" "$@"
}
