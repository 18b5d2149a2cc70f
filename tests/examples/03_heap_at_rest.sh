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
# 0 to the last bit for most heaps; a stone that still rocks at 3 s may add a few units in the last place.
holds "rest wears nothing" "$(value worn_since_rest_mm3) >= 0 && $(value worn_since_rest_mm3) <= 1e-12 * $worn"
# At this rate a year of rest (3e7 s) would wear less than a millionth of what the fall wore.
holds "wear rate at the end" "$(value end_wear_rate_mm3_per_s) * 3e7 < 1e-6 * $worn"
# A rocking stone of 1e-12 J moves by less than a micrometre; creep would be steady and larger.
holds "stays put" "$(value max_displacement_since_rest_m) < 1e-6"
holds "no motion" "$(value kinetic_J) < 1e-12"
# Force balance to the acceleration that is left: sqrt(2 E / m) omega / g with E < 1e-12 J is some 1e-4 for one
# stone of sixty; measured 4e-14.
holds "carries its weight" "$(value carried_error_relative) < 1e-6"
holds "forces are large" "$(value sum_of_contact_forces_N) > $(value weight_N)"
# Sums of a million increments, each rounded: 1e6 * 1e-16 at worst.
holds "worn is energy" "$(value worn_volume_error_relative) < 1e-10"
holds "ledger" "$(value ledger_residual_relative) < 1e-10"
# 0.8 % at half of the stable step, second order.
holds "integration residue" "$(value integration_residue_relative) < 0.02"
[ "$(value bonds_broken)" = 0 ] || fail "bonds broke under a gentle fall"

[ $failures -eq 0 ] && echo "heap at rest: no wear"
exit $((failures > 0))
