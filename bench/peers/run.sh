#!/usr/bin/env bash
# The same problems on the same meshes by Isochor (Tet10), dolfinx and GetFEM (P2-P1 Taylor-Hood, nu = 0.5) and CalculiX
# (C3D10, nu = 0.499), one thread each: processor seconds, iterations, and where a probe ends.
#   bench/peers/run.sh [--quick] [--runs N] [CASE ...]      cases: cantilever, cook, finger
# Needs build/isochor (./run or ./test makes it). Installs the peers from Debian's packages where they are missing; all of them are
# programs of their own here, and nothing of Isochor links them. Writes out/peers/table.md.
set -euo pipefail
cd "$(dirname "$0")/../.."

missing=()
for package in python3-dolfinx python3-getfem calculix-ccx python3-meshio; do
  dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
done
if [[ ${#missing[@]} -gt 0 ]]; then
  as_root=()
  [[ $(id -u) -eq 0 ]] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
exec /usr/bin/python3 bench/peers/table.py "$@"
