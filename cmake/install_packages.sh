#!/usr/bin/env bash
# Installs what a build on Debian 12 (or a relative of it) needs and does not have. Does nothing when all is there.
# With --petsc: also what ISOCHOR_WITH_PETSC needs.
set -euo pipefail

packages=(g++ cmake ninja-build ccache libeigen3-dev libsuitesparse-dev libmumps-seq-dev libmetis-dev
  libopenblas-dev libtbb-dev catch2 nlohmann-json3-dev libcli11-dev libbenchmark-dev libpugixml-dev zlib1g-dev libceres-dev libcpp-httplib-dev
  binutils git ca-certificates
  python3-dev pybind11-dev python3-numpy python3-pytest python3-meshio python3-venv python3-pip)
# The results page is bundled by node; Chromium takes its pictures and runs its tests.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
command -v chromium >/dev/null || packages+=(chromium fonts-dejavu-core)
[[ " $* " == *" --petsc "* ]] && packages+=(libpetsc-real-dev openmpi-bin pkg-config)

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  [[ "$state" == ii* ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

echo "Installing: ${missing[*]}"
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || { echo "these packages are missing and there is no sudo: ${missing[*]}" >&2; exit 2; }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
