#!/usr/bin/env bash
# Installs packages of Debian 12, as root or with sudo; does nothing where all are there.
#
#   .ci/install_packages.sh [LIST...]        ("build" and "window" by default)
#
# Lists: build    what penumbra and penumbra-worker are built from
#        window   penumbra-view, the preview window
#        opencl   an OpenCL device for any CPU (PoCL), for --backend opencl
#        plots    the plots of penumbra report
#        tests    what the tests need beside those: a screen in memory; NumPy, OpenImageIO and pytest for Python (6 MB to
#                 fetch, 30 MB installed); libraries of Blender's module bpy
#        browser  Chromium, in which the tests look at pages
#        slurm    a queue of one's own for the tests with the label slurm; none of its services is started or enabled
#        checks   formatter, sanitizers' runtime and symbolizer
set -euo pipefail

case "${1:-}" in
  -h | --help)
    sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
    exit 0
    ;;
esac

declare -A lists=(
  [build]="clang-19 lld-19 g++ cmake ninja-build ccache pkg-config git
    libembree-dev libopenimageio-dev openimageio-tools libopenexr-dev libopenvdb-dev libnanovdb-dev libpng-dev libjpeg-dev libglm-dev
    libboost-dev ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers
    libssl-dev libcpp-httplib-dev libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
    zlib1g-dev libpugixml-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libfmt-dev libxxhash-dev libtinygltf-dev
    libdraco-dev libmeshoptimizer-dev"
  [window]="libglfw3-dev libepoxy-dev libimgui-dev libfreetype-dev fonts-dejavu-core"
  [opencl]="pocl-opencl-icd"
  [plots]="gnuplot-nox"
  [tests]="libgtest-dev libgmock-dev libbenchmark-dev procps iproute2 xvfb xauth libgl1-mesa-dri
    python3-numpy python3-openimageio python3-pytest python3-venv libegl1 libgl1 libsm6 libxi6 libxkbcommon0"
  [browser]="chromium"
  [slurm]="slurm-wlm munge"
  [checks]="clang-format libclang-rt-19-dev llvm-19"
)

if (($# == 0)); then set -- build window; fi
packages=()
for list in "$@"; do
  if [[ -z ${lists[$list]:-} ]]; then
    echo "install_packages: there is no list '$list'; the lists are: build window opencl plots tests browser slurm checks" >&2
    exit 2
  fi
  read -ra names <<<"$(echo ${lists[$list]})"
  packages+=("${names[@]}")
done

is_installed() { [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }
has_candidate() { [[ $(apt-cache policy "$1" 2>/dev/null) =~ Candidate:\ [^\(] ]]; }

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  printf 'install_packages: this system has no apt-get. Install the counterparts of these Debian 12 packages:\n  %s\n' \
    "${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "Packages ($*): all ${#packages[@]} are installed."
  exit 0
fi

# shellcheck disable=SC1091  # a file of the system
release=$(. /etc/os-release && echo "${VERSION_CODENAME:-unknown}")
if [[ $release != bookworm ]]; then
  echo "install_packages: made for Debian 12 (bookworm), this is '$release'; trying the same names." >&2
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    printf 'install_packages: neither root nor sudo here. As root, run:\n  apt-get install %s\n' "${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 -o DPkg::Lock::Timeout=600 \
    -o Dpkg::Use-Pty=0 "$@" </dev/null
}
install() { apt install --yes --no-install-recommends "${missing[@]}" >/dev/null; }

# Debian's packages of Slurm enable and start its services. The tests start their own, and a user's machine is left as it
# was: a service that has no unit yet is masked until the packages are there.
services=()
if [[ " ${missing[*]} " =~ \ (slurm-wlm|munge)\  ]]; then
  for service in slurmctld slurmd munge; do
    [[ -e /lib/systemd/system/$service.service || -e /etc/systemd/system/$service.service ]] || services+=("$service")
  done
fi
mask() {
  for service in "${services[@]}"; do
    "${as_root[@]}" mkdir -p /etc/systemd/system
    "${as_root[@]}" ln -s /dev/null "/etc/systemd/system/$service.service"
  done
}
unmask() {
  for service in "${services[@]}"; do
    "${as_root[@]}" rm -f "/etc/systemd/system/$service.service"
    "${as_root[@]}" update-rc.d "$service" disable >/dev/null 2>&1 || true  # it is not installed
  done
}

echo "Packages to install ($*: ${#missing[@]} of ${#packages[@]}): ${missing[*]}"
lists_are_fresh=false
for package in "${missing[@]}"; do
  if ! has_candidate "$package"; then
    echo "Updating the package lists, which do not know '$package'."
    apt update
    lists_are_fresh=true
    break
  fi
done
trap unmask EXIT
mask
if ! install; then
  # Lists that are some weeks old name versions which the mirror no longer has.
  if $lists_are_fresh; then exit 1; fi
  echo "Updating the package lists and trying once more."
  apt update
  install
fi
echo "Packages: installed."
