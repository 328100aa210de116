#!/usr/bin/env bash
# What does an effect cost that is in the program and not used? Builds bench/link_host.cpp once without and once with
# each effect, compares their sizes and runs them in turns: the state must have the same hash, and the processor time
# must not differ by more than its own noise.
#
#   bench/link_cost.sh [BUILD_FOLDER] [PAIRS]     a table as Markdown; exit 1 where a hash differs
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${1:-$here/../build}
pairs=${2:-15}
cmake --build "$build" --target isochor_link_hosts > /dev/null
host() { echo "$build/bench/isochor_link_$1"; }
bytes() { size "$(host "$1")" | awk 'NR == 2 { print $1 + $2 }'; }

base=$(bytes none)
wrong=0
echo "| linked, not used | code and data [kB] | more [kB] | same state | least time of $pairs runs against least | median of the pairs | half of them lie within |"
echo "|---|---|---|---|---|---|---|"
printf '| nothing | %d | | | | | |\n' $((base / 1024))
# The first line is the noise: the same program against itself.
for effect in none epidermis membrane tie cable winding cavity damping traction contact all; do
  same=yes
  ratios=
  times=
  for ((pair = 0; pair < pairs; ++pair)); do
    # Which goes first changes from pair to pair.
    if ((pair % 2)); then
      read -r b tb < <("$(host "$effect")")
      read -r a ta < <("$(host none)")
    else
      read -r a ta < <("$(host none)")
      read -r b tb < <("$(host "$effect")")
    fi
    [[ $a == "$b" ]] || same=NO
    ratios+="$(awk -v a="$ta" -v b="$tb" 'BEGIN { print 100 * (b / a - 1) }')"$'\n'
    times+="$ta $tb"$'\n'
  done
  [[ $same == yes ]] || wrong=1
  read -r low middle high < <(printf '%s' "$ratios" | sort -g |
    awk '{ v[NR] = $1 } END { print v[int((NR + 3) / 4)], v[int((NR + 1) / 2)], v[int((3 * NR + 3) / 4)] }')
  least=$(printf '%s' "$times" | awk 'NR == 1 { a = $1; b = $2 } { if ($1 < a) a = $1; if ($2 < b) b = $2 }
    END { print 100 * (b / a - 1) }')
  name=$effect
  [[ $effect != none ]] || name="nothing, against itself"
  printf '| %s | %d | %d | %s | %+.1f %% | %+.1f %% | %+.1f to %+.1f %% |\n' "$name" $(($(bytes "$effect") / 1024)) \
    $((($(bytes "$effect") - base) / 1024)) $same "$least" "$middle" "$low" "$high"
done
exit $wrong
