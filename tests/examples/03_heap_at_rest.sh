#!/usr/bin/env bash
# A heap at rest: it carries its weight and wears nothing. How it settles is chaotic, so another compiler sees
# another heap: only what holds for any heap is checked.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$1\": *[^,}]*" out/03_heap_at_rest/summary.json | head -1 | sed 's/.*: *//'; }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; } # NAME EXPRESSION, with awk's syntax

"$program" > run.log 2>&1 || { echo "FAILED: $(cat run.log)"; exit 1; }
for file in heap.png force_and_wear.png decay.png; do [ -s "out/03_heap_at_rest/$file" ] || fail "$file is missing or empty"; done

worn=$(value worn_volume_mm3)
holds "the fall wore something" "$worn > 100"
# 0 to the last bit for most heaps. In some a stone still rocks at 4 s: it can wear half of what it loses, no more.
# 1e-12: units in the last place of the sum.
holds "rest wears only what is lost" "$(value worn_since_rest_mm3) >= 0 &&
    $(value worn_since_rest_mm3) <= $(value wearable_at_rest_mm3) + 1e-12 * $worn"
holds "what still swings is little" "$(value wearable_at_rest_mm3) < 1e-7 * $worn"
# Of the mean rate of the fall, about a second long.
holds "wear rate at the end" "$(value end_wear_rate_mm3_per_s) < 1e-9 * $worn"
# A stone of 20 g that rocks once a second with 1e-9 J does so by 50 um; creep would go on to be more.
holds "stays put" "$(value max_displacement_since_rest_m) < 5e-5"
holds "no motion" "$(value kinetic_J) < 1e-9"
# Force balance to the acceleration that is left: with 1e-9 J in one stone of sixty some 1e-5.
holds "carries its weight" "$(value carried_error_relative) < 1e-4"
holds "forces are large" "$(value sum_of_contact_forces_N) > $(value weight_N)"
# Sums of a million increments, each rounded: 1e6 * 1e-16 at worst.
holds "worn is energy" "$(value worn_volume_error_relative) < 1e-10"
holds "ledger" "$(value ledger_residual_relative) < 1e-10"
# 0.5 % at half of the stable step, second order.
holds "integration residue" "$(value integration_residue_relative) < 0.02"
[ "$(value bonds_broken)" = 0 ] || fail "bonds broke under a gentle fall"

[ $failures -eq 0 ] && echo "heap at rest: no wear"
exit $((failures > 0))
