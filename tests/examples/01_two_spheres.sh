#!/usr/bin/env bash
# Two spheres: losses against the closed forms, order of the error, conservation.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$1\": *[^,}]*" out/01_two_spheres/summary.json | head -1 | sed 's/.*: *//'; }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; } # NAME EXPRESSION, with awk's syntax

"$program" > run.log 2>&1 || { echo "FAILED: $(cat run.log)"; exit 1; }
for file in energy_lost.png error_against_step.png; do [ -s "out/01_two_spheres/$file" ] || fail "$file is missing or empty"; done

# 400 steps a contact err by (50/400)^2 of 0.3 %, and more per loss at low restitution, where damping is strong.
holds "head-on loss" "$(value worst_error_head_on_of_energy_brought) < 1e-3"
# The oblique contact also turns by 3.3e-4 rad while it lasts, and the formula's contact does not.
holds "oblique normal loss" "$(value worst_error_normal_of_energy_brought) < 1e-3"
holds "sliding loss" "$(value worst_error_sliding_relative) < 1e-3"
# Mean over 32 phases of the step: what is left of the scatter is below 0.01.
holds "order of the loss" "($(value order_of_error) - 2)^2 < 0.05^2"
holds "order of the residue" "($(value order_of_integration_residue) - 2)^2 < 0.05^2"
# Round-off of some thousand steps.
holds "momentum" "$(value worst_momentum_error_relative) < 1e-13"
holds "ledger" "$(value ledger_residual_relative) < 1e-12"
grep -q '"version"' out/01_two_spheres/summary.json && grep -q '"wall_s"' out/01_two_spheres/summary.json || fail "version or wall time"

code=0; "$program" --frobnicate > bad.log 2>&1 || code=$?
[ $code -eq 2 ] || fail "an unknown option: exit code $code"

[ $failures -eq 0 ] && echo "two spheres: as in the closed forms"
exit $((failures > 0))
