#!/usr/bin/env bash
# Five wear laws: closed forms of impacts and of a sliding block; what a rough bed changes.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$1\": *[^,}]*" out/05_wear_laws/summary.json | head -1 | sed 's/.*: *//'; }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; } # NAME EXPRESSION, with awk's syntax

"$program" > run.log 2>&1 || { echo "FAILED: $(cat run.log)"; exit 1; }
[ -s out/05_wear_laws/worn_against_angle.png ] || fail "worn_against_angle.png is missing or empty"

# 200 steps a contact, second order.
for law in sub_particle archard finnie sklar_dietrich ishibashi; do
    holds "impacts under $law" "$(value ${law}_impact_error_of_largest) < 0.002"
done
for law in sub_particle archard ishibashi; do
    holds "a block under $law" "$(value ${law}_block_error_relative) < 0.002"
done
# What only slides has no impacts; over a bed of spheres it has.
for law in finnie sklar_dietrich; do
    holds "$law, flat and on spheres" "$(value ${law}_block_mm3) < 1e-3 * $(value ${law}_block_on_spheres_mm3)"
done

[ $failures -eq 0 ] && echo "wear laws: closed forms hold"
exit $((failures > 0))
