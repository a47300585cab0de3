# What the scripts share: where the project is, how a step is announced, how a preset is built. Sourced, not run.
set -euo pipefail

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=$(nproc)
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$jobs}

# cache_folder NAME: where results are kept that every clone can use.
cache_folder() { echo "${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/furcula/$1"; }

# step WORDS...: announces a step, and writes down when it began where FURCULA_STEPS names a file (.ci/run).
step() {
  printf '\n== %s\n' "$*" >&2
  [ -z "${FURCULA_STEPS-}" ] || printf '%s %s\n' "$(date +%s)" "${*//$'\n'/ }" >>"$FURCULA_STEPS"
}

# print_minutes: minutes by step, from the file that FURCULA_STEPS names; its last line is the end's time alone.
print_minutes() {
  awk '
    BEGIN { print "\nminutes by step" }
    NR == 1 { first = $1 }
    NR > 1 { printf "%6.1f  %s\n", ($1 - last) / 60, name }
    { last = $1; name = $0; sub(/^[0-9]+ ?/, "", name) }
    END { printf "%6.1f  in all\n", (last - first) / 60 }' "$FURCULA_STEPS"
}

die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# usage: prints the script's first comment, which says what it does and how it is called.
usage() { sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"; }

# use_ccache: the compiler's output is kept for the next build, of this clone or another, where ccache is installed: in ccache's own folder
# (~/.cache/ccache), by paths relative to the project. Precompiled headers need the sloppiness.
use_ccache() {
  command -v ccache >/dev/null || return 0
  export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache}
  export CCACHE_BASEDIR=${CCACHE_BASEDIR-$project} CCACHE_NOHASHDIR=${CCACHE_NOHASHDIR-1}
  export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS-pch_defines,time_macros}
}

# build PRESET [CMAKE_ARGUMENT...] [-- TARGET...]: configures build/PRESET and builds it, or some of its targets. Whether there
# is a ccache is asked here, after scripts/setup: were it used from the second build on, that would compile everything once more.
build() {
  local preset=$1 arguments=() targets=()
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    arguments+=("$1")
    shift
  done
  if [ $# -gt 1 ]; then
    shift
    targets=(--target "$@")
  fi
  use_ccache
  step "build: $preset${targets:+ (${targets[*]:1})}"
  (cd "$project" && cmake --preset "$preset" --log-level=NOTICE "${arguments[@]}" &&
    cmake --build --preset "$preset" "${targets[@]}") >&2
}
