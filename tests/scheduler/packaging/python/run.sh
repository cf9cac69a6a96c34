#!/usr/bin/env bash
# The tests of the Python package in a virtual environment.
#
#   run.sh BUILD quick      of the source and the programs of a build folder, without slow tests
#   run.sh BUILD wheel      all of them, with a wheel made of the build folder
#
# The environment is kept in the build folder. Exit code 77: it cannot be made, as where pip reaches no registry.
set -euo pipefail

build=$1 kind=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
venv=$build/python-$kind
mkdir -p "$venv"

make_environment() {
  python3 -m venv "$venv" && "$venv/bin/pip" install -q --retries 1 "$@"
}
skip() {
  echo "skipped: no virtual environment with $*" >&2
  rm -rf "$venv"
  exit 77
}

if [[ $kind == quick ]]; then
  needed=(numpy OpenEXR pytest)
  "$venv/bin/python" -c "import numpy, OpenEXR, pytest" 2>/dev/null || make_environment "${needed[@]}" || skip "${needed[*]}"
  PENUMBRA_PROGRAM=$build/penumbra "$venv/bin/python" -m pytest -q -p no:cacheprovider -m "not slow" "$here"
else
  needed=(pytest mypy jupyter matplotlib pandas tqdm)
  rm -rf "$venv"
  make_environment "${needed[@]}" || skip "${needed[*]}"
  "$venv/bin/pip" install -q mitsuba || echo "without Mitsuba 3, which has no wheel for this machine" >&2
  dist=$(mktemp -d)
  trap 'rm -rf "$dist"' EXIT
  PENUMBRA_BUILD=$build bash "$here/../../../../scheduler/packaging/python/wheel.sh" "$dist"
  "$venv/bin/pip" install -q "$dist"/*.whl
  env -u PENUMBRA_PROGRAM -u PYTHONPATH "$venv/bin/python" -m pytest -q -p no:cacheprovider "$here"
fi
