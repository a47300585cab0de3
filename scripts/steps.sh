# What the scripts share: where the project is, how a step is announced, how a preset is built. Sourced, not run.
set -euo pipefail

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=$(nproc)
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$jobs}
# Compiler output is kept for the next build where ccache is installed; nothing needs it.
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache}
fi

step() { printf '\n== %s\n' "$*" >&2; }

die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# usage: prints the script's first comment, which says what it does and how it is called.
usage() { sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"; }

# build PRESET [CMAKE_ARGUMENT...] [-- TARGET...]: configures build/PRESET and builds it, or some of its targets.
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
  step "build: $preset${targets:+ (${targets[*]:1})}"
  (cd "$project" && cmake --preset "$preset" --log-level=NOTICE "${arguments[@]}" &&
    cmake --build --preset "$preset" "${targets[@]}") >&2
}
