#!/bin/sh
# Decodes recorded.log with candied (npm) and the generated DBC file, and compares with `furcula bus decode`:
#   check.sh FURCULA BUILD_FOLDER
# Packages go to the build folder, at the versions of package-lock.json; their install scripts are not run.
set -u
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$2" && cd "$2" || exit 1
for program in node npm; do
  if ! command -v $program > /dev/null; then
    echo "SKIPPED: $program is not installed (scripts/setup installs it)"; exit 77
  fi
done
# What was installed from the same lock file is used again.
if ! cmp -s "$here/package-lock.json" installed-lock.json; then
  rm -f installed-lock.json
  cp "$here/package.json" "$here/package-lock.json" . || exit 1
  if ! npm ci --ignore-scripts --no-audit --no-fund > npm.txt 2>&1; then
    # A package that is not the pinned one is a finding; a registry that is not there is none.
    if grep -q EINTEGRITY npm.txt; then cat npm.txt; exit 1; fi
    echo "SKIPPED: npm could not install candied: $(grep -m 1 'npm error' npm.txt)"; exit 77
  fi
  cp "$here/package-lock.json" installed-lock.json || exit 1
fi
"$1" bus dbc > furcula.dbc || exit 1
"$1" bus decode "$here/recorded.log" > ours.csv || exit 1
NODE_PATH=$PWD/node_modules exec node "$here/compare.cjs" furcula.dbc "$here/recorded.log" ours.csv
