#!/usr/bin/env bash
# Installs what Penumbra needs from Debian 12: the one list of packages, for users, tests and CI alike.
# Works as root and with sudo, prints what it installs, and does nothing where everything is there.
set -euo pipefail

packages=(
  # Compilers: clang for every build, g++ for its C++ library and its warnings, the sanitizers' runtime and symbolizer.
  clang-19 libclang-rt-19-dev llvm-19 g++ cmake ninja-build ccache pkg-config git clang-format
  # Images, geometry, mathematics.
  libembree-dev libopenimageio-dev libopenexr-dev libopenvdb-dev libpng-dev libglm-dev libboost-dev
  # OpenCL with a device for any CPU.
  ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers pocl-opencl-icd
  # Scheduler and workers.
  libssl-dev libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
  # Files, command line, messages.
  zlib1g-dev libpugixml-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libfmt-dev libxxhash-dev
  libtinygltf-dev
  # The preview window.
  libglfw3-dev libepoxy-dev libimgui-dev
  # Plots of penumbra report.
  gnuplot-nox
  # Tests.
  libgtest-dev libgmock-dev libbenchmark-dev openimageio-tools procps iproute2
  # A queue of one's own, for the tests with the label slurm.
  slurm-wlm munge
  # The window's tests: a screen in memory, and OpenGL without a graphics card.
  xvfb xauth libgl1-mesa-dri
)

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
  echo "Packages: all ${#packages[@]} are installed."
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

echo "Packages to install (${#missing[@]} of ${#packages[@]}): ${missing[*]}"
lists_are_fresh=false
for package in "${missing[@]}"; do
  if ! has_candidate "$package"; then
    echo "Updating the package lists, which do not know '$package'."
    apt update
    lists_are_fresh=true
    break
  fi
done
if ! install; then
  # Lists that are some weeks old name versions which the mirror no longer has.
  if $lists_are_fresh; then exit 1; fi
  echo "Updating the package lists and trying once more."
  apt update
  install
fi
echo "Packages: installed."
