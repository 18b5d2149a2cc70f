#!/usr/bin/env bash
# Clumps: stones as asked for, unions as in the closed form, and errors that fall with the number of spheres.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$1\": *[^,}]*" out/04_clumps/summary.json | head -1 | sed 's/.*: *//'; }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; } # NAME EXPRESSION, with awk's syntax

"$program" > run.log 2>&1 || { echo "FAILED: $(cat run.log)"; exit 1; }
for file in stones.png convergence.png pebble.stl; do [ -s "out/04_clumps/$file" ] || fail "$file is missing or empty"; done

# Gauss' rule between changes of the pattern of arcs: 1.2e-12 at worst in some thousand rows.
holds "three in a row" "$(value row_of_three_volume_error_relative) < 3e-12"
holds "volume of gravel" "$(value gravel_volume_error_relative) < 1e-11"
holds "centre of gravel" "$(value gravel_centre_error_of_size) < 1e-11"
# What make_gravel promises.
holds "form of gravel" "$(value gravel_form_error) < 1e-3"
holds "number of spheres" "$(value gravel_most_spheres) <= 100 && $(value gravel_fewest_spheres) == 1"
# Patches of a smooth surface: 1 / n, less where the finest of them meet the mesh's own triangles.
holds "order, pebble" "$(value pebble_order_of_volume_error) < -0.75"
# At edges the spheres shrink with their distance from them: slower.
holds "order, block" "$(value block_order_of_volume_error) < -0.4"
holds "a hundred spheres in a pebble" "$(value pebble_100_volume_error_relative) > -0.03"
holds "spheres keep inside" "$(value pebble_100_volume_error_relative) < 0 && $(value block_100_volume_error_relative) < 0"

code=0; "$program" --frobnicate > bad.log 2>&1 || code=$?
[ $code -eq 2 ] || fail "an unknown option: exit code $code"

[ $failures -eq 0 ] && echo "clumps: as asked for"
exit $((failures > 0))
