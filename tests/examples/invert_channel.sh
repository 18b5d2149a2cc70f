#!/usr/bin/env bash
# The invert channel as a user meets it: a short run, a stopped run, a run that goes wrong, and bad input.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$2\": *[^,}]*" "$1" | head -1 | sed 's/.*: *//'; }
# Compares numbers: holds NAME EXPRESSION, with awk's syntax.
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; }

short=(--set channel.length=0.5 --set run.end_time=0.06 --set compare.gauge=0.2 --set compare.from=0.2 --set compare.to=0.5)

# --- a short run gives everything that is promised
"$program" "${short[@]}" --out short > short.log || fail "the short run fails: $(cat short.log)"
for file in report.html summary.json series.h5 series_stones.xdmf series_concrete.xdmf abrasion_depth.png centre_line.png ledger.png side_view.png plan_view.png cross_section.png passed.png profiles.json; do
    [ -s "short/$file" ] || fail "short/$file is missing or empty"
done
for key in wall_s simulated_s represented_h stones concrete_spheres sediment_passed_m3 converted_sediment_m3 worn_volume_m3 \
    worn_volume_from_energy_m3 overflow_volume_m3 largest_collision_share largest_safe_beta centre_depth_mm_per_m3 max_depth_mm mean_depth_mm energy_lost_normal_J \
    energy_lost_sliding_J ledger_residual_relative bonds_broken time_step_s fluid contact bond wear concrete_level worn_out overflow worn_through waiting_volume_m3 impact_share restitution_at_1_m_per_s validity passed_volume; do
    grep -q "\"$key\":" short/summary.json || fail "summary.json has no $key"
done
holds "ledger closes" "$(value short/summary.json ledger_residual_relative) < 1e-6"
holds "something wore" "$(value short/summary.json worn_volume_m3) > 0"
worn=$(value short/summary.json worn_volume_m3) energy=$(value short/summary.json worn_volume_from_energy_m3)
holds "worn volume is the energy lost" "($worn - $energy)^2 <= (1e-9 * $worn)^2"
holds "the run is as long as asked" "($(value short/summary.json simulated_s) - 0.06)^2 < 1e-18"
grep -q "assum" short/report.html || fail "the report marks no assumptions"
grep -qE 'src="http|href="http' short/report.html && fail "the report loads something from outside"

share=$(value short/summary.json largest_collision_share) safe=$(value short/summary.json largest_safe_beta)
holds "at the safe beta a collision wears half a cell" "($safe * $share - 0.5 * 10)^2 < 1e-12"
holds "no collision wore a whole cell" "$share > 0 && $share < 1"
grep -q "Warning" short/report.html && fail "a warning although no collision wore a whole cell"
"$program" "${short[@]}" --set wear.acceleration=200000 --out fast > fast.log || fail "a run with much acceleration"
grep -q "Warning: one collision wore" fast/report.html || fail "the report does not warn of beta"
grep -q "^warning  one collision wore" fast.log || fail "the run does not warn of beta"

# --- other fluids: shallow water has come to Manning's depth and speed before the stones begin, and keeps its volume
"$program" "${short[@]}" --fluid shallow --set run.end_time=0.03 --out shallow > shallow.log || fail "shallow water: $(cat shallow.log)"
for file in report.html summary.json water.png side_view.png; do [ -s "shallow/$file" ] || fail "shallow/$file is missing or empty"; done
[ "$(value shallow/summary.json fluid)" = '"ShallowWater"' ] || fail "the fluid is not shallow water"
[ "$(value shallow/summary.json water_settled)" = true ] || fail "the water has not settled"
holds "Manning's depth" "($(value shallow/summary.json water_depth_m) / $(value shallow/summary.json manning_depth_m) - 1)^2 < 0.01"
holds "Manning's speed" "($(value shallow/summary.json water_speed_m_per_s) / $(value shallow/summary.json manning_speed_m_per_s) - 1)^2 < 0.01"
holds "the water's volume" "$(value shallow/summary.json water_volume_residual_relative) < 1e-12"
holds "the ledger closes in shallow water" "$(value shallow/summary.json ledger_residual_relative) < 1e-6"
holds "stones are moved" "$(value shallow/summary.json mean_stone_speed_m_per_s) > 1"
"$program" "${short[@]}" --fluid shallow --set fluid.settle=0.02 --set run.end_time=0.001 --out early > early.log 2>&1 || fail "water that has not settled"
grep -q "off Manning's depth" early.log || fail "water that has not settled is not mentioned"
"$program" "${short[@]}" --fluid grid --set fluid.spacing=0.04 --set run.end_time=0.03 --out grid > grid.log || fail "water on a grid: $(cat grid.log)"
[ -s grid/water.png ] || fail "grid/water.png is missing or empty"
[ "$(value grid/summary.json fluid)" = '"GridFluid"' ] || fail "the fluid is not water on a grid"
holds "Manning's depth on a grid" "($(value grid/summary.json water_depth_m) / $(value grid/summary.json manning_depth_m) - 1)^2 < 0.01"
holds "Manning's speed on a grid" "($(value grid/summary.json water_speed_m_per_s) / $(value grid/summary.json manning_speed_m_per_s) - 1)^2 < 0.01"
holds "the ledger closes on a grid" "$(value grid/summary.json ledger_residual_relative) < 1e-6"
"$program" "${short[@]}" --fluid none --set run.end_time=0.01 --out none > none.log || fail "a dry channel: $(cat none.log)"
grep -q '"water_depth_m"' none/summary.json && fail "a dry channel has water"

# --- levels, laws and ways of overflow that the file names
for chosen in 'concrete.level="rigid"' 'concrete.level="dynamic"' 'concrete.cluster=1' 'concrete.worn_out="grain"' 'concrete.worn_out="recorded"' \
    'contact.law="linear"' 'wear.overflow="drop"'; do
    "$program" "${short[@]}" --set run.end_time=0.02 --set "$chosen" --out chosen > chosen.log 2>&1 || fail "$chosen: $(cat chosen.log)"
done
"$program" "${short[@]}" --set 'wear.overflow="patch"' --set wear.overflow_length=0.2 --set wear.overflow_width=0.1 --set wear.acceleration=5000 --out patch > patch.log 2>&1 || fail "patch: $(cat patch.log)"
"$program" "${short[@]}" --set 'wear.overflow="epoch"' --set wear.overflow_length=0.2 --set wear.overflow_every=0.02 --out epoch > epoch.log 2>&1 || fail "epoch: $(cat epoch.log)"
sed '/^coefficient/d; /^acceleration/d' "$(dirname "$0")/../../examples/invert_channel/quick.toml" > unworn.toml
"$program" unworn.toml "${short[@]}" --set 'wear.law="none"' --out unworn > unworn.log 2>&1 || fail "no wear law: $(cat unworn.log)"
sed '/^stiffness = .* # N.m/d; /^restitution/d' "$(dirname "$0")/../../examples/invert_channel/quick.toml" > yields.toml
"$program" yields.toml "${short[@]}" --set 'contact.law="elastic_plastic"' --set contact.yield_pressure=1e8 --set concrete.stiffness=2e6 --set run.end_time=0.02 --out yields > yields.log 2>&1 || fail "elastic_plastic: $(cat yields.log)"
"$program" "${short[@]}" --set run.end_time=20 --set sediment.feed_until=0.5 --set 'compare.converted=[0.0005]' --out milestones > milestones.log 2>&1 || fail "milestones: $(cat milestones.log)"
[ -s milestones/milestone_2.png ] || fail "no picture of the second milestone"
holds "a milestone ends the run" "$(value milestones/summary.json simulated_s) < 20"
[ "$(value milestones/summary.json stopped_early)" = false ] || fail "a milestone counts as a stop"
for run in short patch; do
    holds "$run: worn, lost and waiting is what the energy gives" "($(value $run/summary.json worn_volume_m3) + $(value $run/summary.json overflow_volume_m3) + $(value $run/summary.json waiting_volume_m3) - $(value $run/summary.json worn_volume_from_energy_m3))^2 <= (1e-9 * $(value $run/summary.json worn_volume_m3))^2"
done

# --- measured points are drawn; a bad row is named
printf 'x,depth\n0.3,0.1\n' > points.csv
"$program" "${short[@]}" --set run.end_time=0.01 --set "compare.measured=\"points.csv\"" --out measured > /dev/null || fail "measured points"
grep -q 'points.csv' measured/centre_line.gp || fail "measured points are not in the chart"

# --- Ctrl-C ends cleanly with what there is so far
"$program" --set run.end_time=1000 --out stopped > stopped.log 2>&1 &
pid=$!
sleep 2
kill -INT $pid
wait $pid || fail "Ctrl-C: exit code $?"
[ "$(value stopped/summary.json stopped_early)" = true ] || fail "a stopped run does not say so"
"$program" --fluid grid --set fluid.settle=1000 --out unsettled > unsettled.log 2>&1 &
pid=$!
sleep 2
kill -INT $pid
wait $pid || fail "Ctrl-C while water settles: exit code $?"
[ "$(value unsettled/summary.json stopped_early)" = true ] || fail "a run stopped while water settles does not say so"
holds "only what has settled is told" "$(value unsettled/summary.json water_settled_s) < 999"

# --- a run that goes wrong: exit 3, nothing under the final name, the last good state saved
status=0
"$program" "${short[@]}" --set run.end_time=0.3 --set contact.stiffness=30 --out soft > soft.log 2>&1 || status=$?
[ $status -eq 3 ] || fail "runaway overlap: exit code $status"
grep -qE 'step [0-9]+ .*with id [0-9]+ .*overlaps' soft.log || fail "runaway overlap is not explained: $(cat soft.log)"
[ ! -e soft ] && [ -s soft.failed/last_good.h5 ] || fail "runaway overlap: wrong files"

status=0
"$program" "${short[@]}" --fluid shallow --set run.end_time=0.3 --set contact.stiffness=30 --out wet > wet.log 2>&1 || status=$?
[ $status -eq 3 ] && [ -s wet.failed/last_good.h5 ] || fail "a failed run in shallow water: exit code $status: $(cat wet.log)"
grep -q surface wet.failed/last_good.h5 || fail "the water of a failed run is not kept"

# --- pictures that fail take nothing with them: exit 1, data and summary are kept
mkdir -p stub
printf '#!/bin/sh\n[ "$1" = --version ] && { echo gnuplot 5.4; exit 0; }\nexit 1\n' > stub/gnuplot
chmod +x stub/gnuplot
status=0
PATH="$PWD/stub:$PATH" "$program" "${short[@]}" --set run.end_time=0.01 --out unpainted > unpainted.log 2>&1 || status=$?
[ $status -eq 1 ] || fail "no pictures: exit code $status"
for file in summary.json series.h5; do [ -s unpainted/$file ] || fail "no pictures: $file is lost"; done
grep -q 'null' unpainted/summary.json || fail "a depth per sediment without sediment"

# --- what a killed run left is mentioned
mkdir -p .left.partial-1
"$program" "${short[@]}" --set run.end_time=0.001 --out left > left.log 2>&1 || fail "a run beside leftovers"
grep -q 'left.partial-1 was left' left.log || fail "leftovers are not mentioned"

# --- bad input: exit 2, one clear message, nothing written
refused() { # refused WHAT REGEX OPTION...
    local what="$1" regex="$2" code=0
    shift 2
    "$program" --out refused "$@" > refused.log 2>&1 || code=$?
    [ $code -eq 2 ] || fail "$what: exit code $code"
    grep -qE "$regex" refused.log || fail "$what: message is '$(cat refused.log)'"
    [ "$(wc -l < refused.log)" -le 3 ] || fail "$what: message of $(wc -l < refused.log) lines"
    [ -z "$(ls -A | grep refused | grep -v refused.log)" ] || fail "$what: left something behind"
}
printf '[run]\nend_time = 1\noutput_every = 0.1\n[chanel]\nlength = 1\n' > typo.toml
refused "unknown table" 'typo.toml|channel.length' typo.toml
printf '[run\n' > broken.toml
refused "syntax" 'broken.toml:1' broken.toml
refused "unknown key" 'contact.frictoin.*contact.friction' --set contact.frictoin=0.3
refused "missing file" 'nowhere.toml' nowhere.toml
refused "wrong type" 'contact.friction.*number' --set 'contact.friction="high"'
refused "negative size" 'concrete.sphere_diameter.*> 0.*-0.02 m' --set concrete.sphere_diameter=-0.02
refused "unstable step" 'time_step.*at most the stable step.*1 s.*smaller step' --set run.time_step=1
refused "stones too large" 'sediment.sizes.*width.*1.5 m' --set 'sediment.sizes=[0.04,0.05,0.075,0.1,1.5]'
refused "fractions" 'fraction.*1' --set 'sediment.fractions=[0.2,0.2,0.2,0.2,0.3]'
refused "restitution" 'restitution.*\(0, 1\].*1.5' --set contact.restitution=1.5
printf 'x,depth\n0.3,high\n' > points_bad.csv
refused "bad measured points" 'points_bad.csv.*(row|line|:) *2' --set 'compare.measured="points_bad.csv"'
refused "unknown fluid" 'fluid.model.*shallow' --fluid shalow
refused "inflow too deep" 'at most critical.*got 2 m' --fluid shallow --set fluid.inflow_depth=2
refused "a coarse grid" 'fluid.spacing.*at most a quarter.*0.5 m' --fluid shallow --set fluid.spacing=0.5
refused "a law of its own water" 'fluid.model with contact.law.*uniform with linear.*got grid with linear' --fluid grid --set 'contact.law="linear"'
refused "a key of another law" 'contact.yield_pressure.*hysteretic.*no use' --set contact.yield_pressure=1e8
refused "a cluster of rigid concrete" 'concrete.cluster.*static' --set 'concrete.level="rigid"' --set concrete.cluster=1
refused "a patch without a size" 'wear.overflow_length' --set 'wear.overflow="patch"'
refused "an epoch's time for a crater" 'wear.overflow_every.*crater' --set wear.overflow_every=1
refused "unknown option" 'help' --frobnicate
mkdir -p readonly_is_a_file && touch readonly_is_a_file/inside
code=0; "$program" --out readonly_is_a_file/inside > refused.log 2>&1 || code=$?
[ $code -eq 2 ] || fail "an output folder that is a file: exit code $code, $(cat refused.log)"

[ $failures -eq 0 ] && echo "invert channel: all as promised"
exit $((failures > 0))
