#!/usr/bin/env bash
# Installs the packages, builds a preset and runs its tests through CTest.
#
#   tests/run.sh [--all] [PRESET] [CTEST ARGUMENT...]
#
# --all runs the slow tests too (label slow), which take some forty minutes on two cores, and Slurm's, which need its packages.
# PRESET is one of CMakePresets.json, `release` by default. The rest goes to ctest, e.g. `-R Furnace`.
# PENUMBRA_CMAKE_ARGUMENTS holds further arguments for the configuration, separated by blanks.
# Exit code 0: at least one test ran and none failed.
set -euo pipefail

packages=(build window opencl plots tests)
selection=(-LE slow)
while (($# > 0)); do
  case "$1" in
    -h | --help)
      sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    --all)
      packages+=(slurm)
      selection=()
      shift
      ;;
    *) break ;;
  esac
done
preset=release
if (($# > 0)) && [[ $1 != -* ]]; then
  preset=$1
  shift
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
bash .ci/install_packages.sh "${packages[@]}"

read -ra cmake_arguments <<<"${PENUMBRA_CMAKE_ARGUMENTS:-}"
echo "Building preset '$preset' in build/$preset"
cmake --preset "$preset" -DBUILD_TESTING=ON "${cmake_arguments[@]}" >/dev/null
cmake --build --preset "$preset"

# PoCL caches compiled kernels in the home directory, which a CI account need not have.
[[ -w ${HOME:-/nonexistent} ]] || export POCL_CACHE_DIR="$root/build/$preset/pocl-cache"
ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$(nproc)" "${selection[@]}" "$@"
