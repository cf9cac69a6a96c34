#!/usr/bin/env bash
# Makes a Python environment that has Blender's module bpy, of PyPI, and prints the path of its Python.
#
#   .ci/install_blender.sh VERSION        (as in 4.5: the newest of that series)
#
# It stays for later runs, in PENUMBRA_BLENDER_FOLDER or /var/tmp. Exit code 77: there is no Python for it, or the registry
# cannot be reached.
set -euo pipefail
version=$1
folder=${PENUMBRA_BLENDER_FOLDER:-/var/tmp/penumbra-blender-$(id -u)}/$version
python=$folder/bin/python
has_blender() { "$python" -c 'import bpy, numpy' >/dev/null 2>&1; }

if ! has_blender; then
  for command in python3.11 python3; do
    if [[ $("$command" -c 'import sys; print(sys.version_info[:2])' 2>/dev/null) == "(3, 11)" ]]; then break; fi
    command=
  done
  if [[ -z $command ]]; then
    echo "install_blender: skipped: bpy $version needs Python 3.11, which is not here" >&2
    exit 77
  fi
  rm -rf "$folder"
  mkdir -p "$(dirname "$folder")"
  if ! { "$command" -m venv "$folder" && "$python" -m pip install --quiet --disable-pip-version-check "bpy==$version.*"; } >&2; then
    rm -rf "$folder"
    echo "install_blender: skipped: bpy $version cannot be installed from the package registry" >&2
    exit 77
  fi
  has_blender || { echo "install_blender: bpy $version is installed and does not run" >&2; exit 1; }
fi
echo "$python"
