#!/usr/bin/env bash
# Every scene of the library on 1 to 4 ranks against the engine alone: a table for docs/machines.md. Long scenes
# for their first steps. From the root of the source, after ./test --petsc:
#
#   bash tests/machines/library.sh [RANKS...]
set -uo pipefail
cd "$(dirname "$0")/../.."
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1 OMP_NUM_THREADS=1
compare=${ISOCHOR_COMPARE_RANKS:-build-petsc/tests/isochor_compare_ranks}
[[ $# -gt 0 ]] || set -- 1 2 3 4
echo "| scene | ranks | difference over the length | iterations | alone |"
echo "|---|---|---|---|---|"
failed=0
for file in scenes/files/*.json; do
  scene=$(basename "$file" .json)
  for ranks in "$@"; do
    said=$(timeout "${SECONDS_A_SCENE:-600}" mpirun --oversubscribe --bind-to none -n "$ranks" \
      "$compare" "$scene@steps ${STEPS:-3}" 2>&1)
    row=$(sed -nE 's/^ok +[^:]*: difference ([^ ]*) of the length, ([0-9]+) iterations \(alone ([0-9]+)\)$/| \1 | \2 | \3 |/p' \
      <<<"$said")
    if [[ -n "$row" ]]; then
      echo "| \`$scene\` | $ranks $row"
    else
      failed=1
      why=$(grep -m1 -E '^     [^ ].*(step [0-9]|refused|alone refuses|bits|steps, alone)' <<<"$said" | sed 's/^ *//; s/|/\\|/g')
      echo "| \`$scene\` | $ranks | ${why:-did not end} | | |"
    fi
  done
done
exit $failed
