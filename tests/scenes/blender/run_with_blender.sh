#!/usr/bin/env bash
# Runs a Python file of this folder with the Python that PENUMBRA_BLENDER_PYTHON names, with scenes/ in its path, so that
# the extension is the package `blender`. PENUMBRA_PROGRAM is the `penumbra` to use. Settings of Blender's users do not count.
# Exit code 77, a skip: there is no such Python.
set -euo pipefail
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
python=${PENUMBRA_BLENDER_PYTHON:-${PENUMBRA_DEFAULT_BLENDER_PYTHON:-}}
if [[ -z $python ]]; then
  echo "skipped: PENUMBRA_BLENDER_PYTHON does not name a Python that has Blender (python3.11 -m venv blender && blender/bin/pip install bpy)"
  exit 77
fi
settings=$(mktemp -d)
trap 'rm -rf "$settings"' EXIT
export BLENDER_USER_RESOURCES=$settings PYTHONDONTWRITEBYTECODE=1
export PYTHONPATH=$folder/../../../scenes:$folder${PYTHONPATH:+:$PYTHONPATH}
"$python" "$folder/$@"
