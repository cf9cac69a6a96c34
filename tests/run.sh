#!/usr/bin/env bash
# Installs the packages, builds a preset and runs its tests through CTest.
#
#   tests/run.sh [PRESET] [CTEST ARGUMENT...]
#
# PRESET is one of CMakePresets.json, `release` by default. The rest goes to ctest, e.g. `-R Furnace` or `-LE slow`.
# PENUMBRA_CMAKE_ARGUMENTS holds further arguments for the configuration, separated by blanks.
# Exit code 0: at least one test ran and none failed.
set -euo pipefail

case "${1:-}" in
  -h | --help)
    sed -n '2,/^set /{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
    exit 0
    ;;
esac
preset=release
if (($# > 0)) && [[ $1 != -* ]]; then
  preset=$1
  shift
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
bash .ci/install_packages.sh

read -ra cmake_arguments <<<"${PENUMBRA_CMAKE_ARGUMENTS:-}"
echo "Building preset '$preset' in build/$preset"
cmake --preset "$preset" -DBUILD_TESTING=ON "${cmake_arguments[@]}"
cmake --build --preset "$preset"

# PoCL caches compiled kernels in the home directory, which a CI account need not have.
[[ -w ${HOME:-/nonexistent} ]] || export POCL_CACHE_DIR="$root/build/$preset/pocl-cache"
ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
