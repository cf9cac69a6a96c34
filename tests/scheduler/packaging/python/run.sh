#!/usr/bin/env bash
# The tests of the Python package in a virtual environment.
#
#   run.sh BUILD quick      of the source and the programs of a build folder, without slow tests
#   run.sh BUILD wheel      all of them, with a wheel made of the build folder, in a clean environment
#   run.sh BUILD bare       a render with that wheel in a Debian 12 and a Debian 13 that have nothing else; needs root
#                           and debootstrap
#
# Environments are kept in the build folder. Exit code 77: there is none, as where pip reaches no registry.
set -euo pipefail

build=$1 kind=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../../../.." && pwd)
venv=$build/python-$kind

skip() {
  echo "skipped: $*" >&2
  exit 77
}

# make_environment PACKAGE...
make_environment() {
  python3 -m venv "$venv" && "$venv/bin/pip" install -q --retries 1 "$@" && return
  rm -rf "$venv"
  skip "no virtual environment with $*"
}

quick() {
  "$venv/bin/python" -c "import numpy, OpenEXR, pytest" 2>/dev/null || make_environment numpy OpenEXR pytest
  PENUMBRA_PROGRAM=$build/penumbra "$venv/bin/python" -B -m pytest -q -p no:cacheprovider -m "not slow" "$here"
}

wheel() {
  rm -rf "$venv" "$build/dist"
  make_environment pytest mypy jupyter matplotlib pandas tqdm
  "$venv/bin/pip" install -q mitsuba || echo "without Mitsuba 3, which has no wheel for this machine" >&2
  PENUMBRA_BUILD=$build bash "$root/scheduler/packaging/python/wheel.sh" "$build/dist"
  "$venv/bin/pip" install -q "$build"/dist/*.whl
  env -u PENUMBRA_PROGRAM -u PYTHONPATH "$venv/bin/python" -B -m pytest -q -p no:cacheprovider "$here"
}

bare() {
  [[ $EUID == 0 ]] && command -v debootstrap >/dev/null || skip "needs root and debootstrap"
  compgen -G "$build/dist/*.whl" >/dev/null || skip "no wheel in $build/dist"
  local suite
  for suite in bookworm trixie; do bare_debian "$suite"; done
}

bare_debian() {
  local system
  system=$(mktemp -d)
  trap 'umount "'"$system"'"/{dev,proc} 2>/dev/null || true; rm -rf --one-file-system "'"$system"'"' EXIT
  debootstrap --variant=minbase --include=python3-venv,ca-certificates "$1" "$system" >/dev/null || skip "no Debian $1"
  cp "$build"/dist/*.whl "$root/scenes/cornell-small/cornell-small.xml" "$system/root"
  cp /etc/resolv.conf "$system/etc"
  cp /etc/ssl/certs/ca-certificates.crt "$system/etc/ssl/certs"
  mount --bind /proc "$system/proc" && mount --bind /dev "$system/dev"
  chroot "$system" bash -euc '
    cd /root && python3 -m venv venv && venv/bin/pip install -q *.whl
    venv/bin/python -c "
import penumbra
result = penumbra.render(\"cornell-small.xml\", spp=4, workers=2)
print(result, result.statistics[\"film_hash\"])
result.save(\"a.exr\")"
    venv/bin/penumbra convert a.exr a.png    # by the module that needs most libraries
    ls -l a.png; . /etc/os-release; echo "$PRETTY_NAME"'
  umount "$system"/{dev,proc}
  rm -rf --one-file-system "$system"
}

"$kind"
