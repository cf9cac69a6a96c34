#!/usr/bin/env bash
# From a fresh Debian 12 machine to a first picture: installs what the build needs, builds penumbra and its worker for this
# machine's processor, and renders the Cornell box with two worker processes. Then it builds the rest, the window for one,
# while the picture can be looked at.
#
#   scenes/quickstart.sh [OUTPUT_FOLDER]        (out/ in the project's folder by default)
set -euo pipefail

case "${1:-}" in
  -h | --help)
    sed -n '2,/^set /{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
    exit 0
    ;;
esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=${1:-$root/out}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$root"

echo "1/4 Packages"
bash .ci/install_packages.sh build window

echo "2/4 Build what renders, in build/release (some minutes the first time)"
cmake --preset release >/dev/null
cmake --build --preset release --target first_picture

echo "3/4 Render scenes/cornell/cornell.xml with two workers"
build/release/penumbra render scenes/cornell/cornell.xml --workers 2 --spp 64 -o "$out/cornell.exr"

for picture in "$out/cornell.exr" "$out/cornell.png"; do
  if [[ ! -s $picture ]]; then
    echo "quickstart: $picture is missing, although the renderer reported success" >&2
    exit 1
  fi
done
cat <<END

The Cornell box is rendered:
  $out/cornell.exr   linear radiance with variance, albedo, normal, depth and sample-count layers
  $out/cornell.png   for looking at

END
echo "4/4 Build the window, readers of less usual files, and manual pages"
cmake --build --preset release --target installed
cat <<END

Next: build/release/penumbra render --help
      build/release/penumbra view scenes/star-light/star-light.xml   (where there is a screen)
END
