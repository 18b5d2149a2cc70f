#!/usr/bin/env bash
# The invert channel as a user meets it: a short run, all choices of the file, a stopped run, a run that goes wrong, and
# bad input.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$2\": *[^,}]*" "$1" | head -1 | sed 's/.*: *//'; }
# Compares numbers: holds NAME EXPRESSION, with awk's syntax.
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; }

broken_gnuplot() { # broken_gnuplot FOLDER COMMAND: a gnuplot that does this and draws nothing
    mkdir -p "$1"
    printf '#!/bin/sh\n[ "$1" = --version ] && { echo gnuplot 5.4; exit 0; }\n%s\nexit 1\n' "$2" > "$1/gnuplot"
    chmod +x "$1/gnuplot"
}

short=(--set channel.length=0.5 --set run.end_time=0.3 --set compare.gauge=0.2 --set compare.from=0.2 --set compare.to=0.5)

# --- a short run gives everything that is promised
"$program" "${short[@]}" --out short > short.log || fail "the short run fails: $(cat short.log)"
for file in report.html summary.json series.h5 series_stones.xdmf series_concrete.xdmf abrasion_depth.png centre_line.png ledger.png side_view.png plan_view.png cross_section.png passed.png profiles.json; do
    [ -s "short/$file" ] || fail "short/$file is missing or empty"
done
for key in wall_s simulated_s represented_h stones concrete_spheres sediment_passed_m3 converted_sediment_m3 worn_volume_m3 \
    worn_volume_from_energy_m3 overflow_volume_m3 largest_collision_share largest_safe_beta centre_depth_mm_per_m3 max_depth_mm mean_depth_mm energy_lost_normal_J \
    energy_lost_sliding_J ledger_residual_relative bonds_broken time_step_s fluid contact bond wear contact_law wear_law \
    concrete_level cluster worn_out overflow worn_through waiting_volume_m3 worn_over_energy spheres_worn_out spheres_let_go impact_share \
    impact_share_compared_sampled restitution_at_1_m_per_s validity passed_volume passed_share_of_fed stones_by_size level; do
    grep -q "\"$key\":" short/summary.json || fail "summary.json has no $key"
done
holds "ledger closes" "$(value short/summary.json ledger_residual_relative) < 1e-6"
holds "something wore" "$(value short/summary.json worn_volume_m3) > 0"
accounted() { holds "$1: all wear is worn, overflow or waiting" "($(value "$1/summary.json" worn_over_energy) - 1)^2 < 1e-20"; }
accounted short
holds "restitution" "($(value short/summary.json restitution_at_1_m_per_s) - 0.6)^2 < 1e-24"
holds "the run is as long as asked" "($(value short/summary.json simulated_s) - 0.3)^2 < 1e-18"
grep -q "assum" short/report.html || fail "the report marks no assumptions"
grep -qE 'src="http|href="http' short/report.html && fail "the report loads something from outside"

# What a level of fluid costs and gives stands under one header, in the summary and in the report.
level_stands() { # level_stands FOLDER MODEL [EXCHANGE]
    local level key
    level="$(sed -n '/"level": {/,/}/p' "$1/summary.json")"
    for key in wall_s centre_depth_mm_per_m3 energy_lost_normal_J energy_lost_sliding_J sampled_stone_speed_m_per_s stones_off_bed_share; do
        [ "$(value <(echo "$level") $key)" = "$(value "$1/summary.json" $key)" ] || fail "$1: the level's $key is not that of the run: $level"
    done
    [ "$(value <(echo "$level") model)" = "\"$2\"" ] && [ "$(value <(echo "$level") exchange)" = "${3:+\"$3\"}" ] || fail "$1: the level is not named: $level"
    grep -qF ">fluid.model = $2${3:+, fluid.exchange = $3}<" "$1/report.html" || fail "$1: the report has no table of the level"
}
level_stands short uniform
# Stones by size: all looks and all hops of the run, in as many rows as there are sizes.
by_size() { awk -v key="\"$2\":" '/"stones_by_size"/ { inside = 1 } /"level"/ { inside = 0 } inside && $1 == key { sub(",", ""); print $2 }' "$1/summary.json"; }
[ "$(by_size short size_m | paste -sd ' ')" = "0.04 0.05 0.075 0.1 0.15" ] || fail "stones by size: $(by_size short size_m)"
mean_by_size() { paste <(by_size "$1" looks) <(by_size "$1" "$2") | awk '$1 > 0 { all += $1; sum += $1 * $2 } END { printf "%.15g", sum / all }'; }
holds "speeds by size" "($(mean_by_size short speed_m_per_s) / $(value short/summary.json sampled_stone_speed_m_per_s) - 1)^2 < 1e-24"
holds "off the bed by size" "($(mean_by_size short off_bed_share) / $(value short/summary.json stones_off_bed_share) - 1)^2 < 1e-24"
holds "small stones hop" "$(by_size short hops | head -1) > 0"
holds "what hops is off the bed" "$(by_size short hop_height_m | head -1) > 0.1 * 0.04 && $(by_size short clear_of_bed_share | head -1) > 0"
"$program" "${short[@]}" --set compare.hops=false --out unwatched > /dev/null || fail "a run without hops"
grep -q '"hop' unwatched/summary.json && fail "hops that nobody asked for"
for key in worn_volume_m3 energy_lost_normal_J sediment_passed_m3; do
    [ "$(value unwatched/summary.json $key)" = "$(value short/summary.json $key)" ] || fail "looking for hops changes $key"
done

share=$(value short/summary.json largest_collision_share) safe=$(value short/summary.json largest_safe_beta)
holds "at the safe beta a collision wears half a cell" "($safe * $share - 0.5 * 10)^2 < 1e-12"
holds "no collision wore a whole cell" "$share > 0 && $share < 1"
grep -q "Warning" short/report.html && fail "a warning although no collision wore a whole cell"

# --- where wear goes that its cell no longer has; beta is far above the safe one, and that is said
fast=(--set run.end_time=0.2 --set wear.acceleration=20000)
overflow() { # overflow NAME OPTION...
    local name="$1"
    shift
    "$program" "${short[@]}" "${fast[@]}" --set "wear.overflow=\"$name\"" "$@" --out "$name" > "$name.log" 2>&1 || fail "overflow $name: $(cat "$name.log")"
    [ "$(value "$name/summary.json" overflow)" = "\"$name\"" ] || fail "overflow is not $name"
    accounted "$name"
}
overflow crater
overflow patch --set wear.overflow_length=0.2 --set wear.overflow_width=0.1
overflow epoch --set wear.overflow_length=0.2 --set wear.overflow_every=0.03
overflow drop
grep -q "Warning: one collision wore .* is above the safe" crater/report.html || fail "the report does not warn of beta"
grep -q "^warning  one collision wore" crater.log || fail "the run does not warn of beta"
for name in crater patch epoch; do holds "$name: nothing overflows" "$(value $name/summary.json overflow_volume_m3) <= 1e-9 * $(value $name/summary.json worn_volume_m3)"; done
holds "wear is dropped" "$(value drop/summary.json overflow_volume_m3) > 0"
holds "spheres are worn out" "$(value crater/summary.json spheres_worn_out) > 0"

# --- what becomes of worn-out spheres; a bed that is worn through ends the run
"$program" "${short[@]}" "${fast[@]}" --set 'concrete.worn_out="recorded"' --out recorded > recorded.log 2>&1 || fail "recorded: $(cat recorded.log)"
accounted recorded
holds "a frozen bed stands" "$(value recorded/summary.json spheres_let_go) + $(value recorded/summary.json overflow_volume_m3) == 0"
grep -q '"validity": "Recorded on a frozen bed.*outside the model' recorded/summary.json || fail "a frozen bed is not called so"
grep -q 'frozen bed' recorded/report.html || fail "the report does not say that the bed is frozen"
"$program" "${short[@]}" "${fast[@]}" --set 'concrete.worn_out="grain"' --out grain > grain.log 2>&1 || fail "grain: $(cat grain.log)"
accounted grain
"$program" "${short[@]}" "${fast[@]}" --set concrete.layers=1 --set wear.acceleration=1e6 --out through > through.log 2>&1 || fail "one layer: $(cat through.log)"
[ "$(value through/summary.json worn_through)" = true ] && grep -q 'worn through.*more concrete.layers' through.log || fail "concrete that is worn through: $(cat through.log)"
holds "it ends the run" "$(value through/summary.json simulated_s) < 0.2"

# --- other fluids: shallow water has come to Manning's depth and speed before the stones begin, and keeps its volume
"$program" "${short[@]}" --fluid shallow --set run.end_time=0.03 --out shallow > shallow.log || fail "shallow water: $(cat shallow.log)"
for file in report.html summary.json water.png side_view.png; do [ -s "shallow/$file" ] || fail "shallow/$file is missing or empty"; done
[ "$(value shallow/summary.json fluid)" = '"TwoWayShallow"' ] || fail "the fluid is not shallow water"
[ "$(value shallow/summary.json water_settled)" = true ] || fail "the water has not settled"
holds "Manning's depth" "($(value shallow/summary.json water_depth_m) / $(value shallow/summary.json manning_depth_m) - 1)^2 < 0.01"
holds "Manning's speed" "($(value shallow/summary.json water_speed_m_per_s) / $(value shallow/summary.json manning_speed_m_per_s) - 1)^2 < 0.01"
holds "the water's volume" "$(value shallow/summary.json water_volume_residual_relative) < 1e-12"
holds "the ledger closes in shallow water" "$(value shallow/summary.json ledger_residual_relative) < 1e-6"
level_stands shallow shallow
holds "stones are moved" "$(value shallow/summary.json mean_stone_speed_m_per_s) > 1"
"$program" "${short[@]}" --fluid shallow --set fluid.settle=0.02 --set run.end_time=0.001 --out early > early.log 2>&1 || fail "water that has not settled"
grep -q "off Manning's depth" early.log || fail "water that has not settled is not mentioned"
"$program" "${short[@]}" --fluid grid --set fluid.spacing=0.04 --set run.end_time=0.03 --out grid > grid.log || fail "water on a grid: $(cat grid.log)"
[ -s grid/water.png ] || fail "grid/water.png is missing or empty"
[ "$(value grid/summary.json fluid)" = '"GridFluid"' ] || fail "the fluid is not water on a grid"
holds "Manning's depth on a grid" "($(value grid/summary.json water_depth_m) / $(value grid/summary.json manning_depth_m) - 1)^2 < 0.01"
holds "Manning's speed on a grid" "($(value grid/summary.json water_speed_m_per_s) / $(value grid/summary.json manning_speed_m_per_s) - 1)^2 < 0.01"
holds "the ledger closes on a grid" "$(value grid/summary.json ledger_residual_relative) < 1e-6"
holds "the water's energy account closes" "$(value grid/summary.json water_energy_residual_relative) < 1e-9"
level_stands grid grid
holds "water comes in with energy" "$(value grid/summary.json water_energy_inflow_joule) > 0"
"$program" "${short[@]}" --fluid grid --set 'fluid.surface="height"' --set fluid.energy=false --set fluid.spacing=0.04 --set run.end_time=0.03 --out height > height.log || fail "water below a height: $(cat height.log)"
holds "a height's depth is near that of volume of fluid" "$(value height/summary.json water_depth_m) < 1.05 * $(value grid/summary.json water_depth_m) && $(value height/summary.json water_depth_m) > 0.95 * $(value grid/summary.json water_depth_m)"
grep -q water_energy height/summary.json && fail "an energy account that was not asked for"
for model in unresolved resolved; do
    "$program" "${short[@]}" --fluid $model --set fluid.spacing=0.04 --set run.end_time=0.05 --out $model > $model.log || fail "$model stones: $(cat $model.log)"
    holds "the ledger closes with $model stones" "$(value $model/summary.json ledger_residual_relative) < 1e-12"
    holds "Manning's depth about $model stones" "($(value $model/summary.json water_depth_m) / $(value $model/summary.json manning_depth_m) - 1)^2 < 0.01"
    holds "the water's account closes about $model stones" "$(value $model/summary.json water_energy_residual_relative) < 1e-9"
    holds "small stones are averaged" "$(value $model/summary.json stones_averaged) > 0"
    level_stands $model $model monolithic
done
holds "unresolved: all are" "$(value unresolved/summary.json stones_resolved) == 0"
for exchange in mixture direct; do
    "$program" "${short[@]}" --fluid resolved --set "fluid.exchange=\"$exchange\"" --set fluid.spacing=0.04 --set run.end_time=0.05 --out $exchange > $exchange.log || fail "exchange $exchange: $(cat $exchange.log)"
    level_stands $exchange resolved $exchange
    holds "the ledger closes with exchange $exchange" "$(value $exchange/summary.json ledger_residual_relative) < 1e-12"
    holds "$exchange resolves all stones" "$(value $exchange/summary.json stones_averaged) == 0 && $(value $exchange/summary.json stones_resolved) > 0"
    [ "$(value $exchange/summary.json mean_stone_speed_m_per_s)" != "$(value resolved/summary.json mean_stone_speed_m_per_s)" ] || fail "exchange $exchange is the monolithic one"
done
[ "$(value mixture/summary.json mean_stone_speed_m_per_s)" != "$(value direct/summary.json mean_stone_speed_m_per_s)" ] || fail "mixture and direct are one exchange"
# ... the paper's file keeps no energy account, and stands beside what the source says of its own run
"$program" paper.toml "${short[@]}" --fluid grid --set sediment.feed_to=0.3 --set fluid.spacing=0.04 --set fluid.settle=0.05 --set run.end_time=0.001 --set 'compare.gauges=[0.2]' --out paper > paper.log 2>&1 || fail "the paper's file: $(cat paper.log)"
grep -q water_energy paper/summary.json && fail "the paper's file keeps an energy account"
grep -q '"source"' paper/summary.json && fail "a gauge at 0.2 m stands beside the source's at 10 m"
"$program" paper.toml --set channel.length=11 --set compare.to=11 --set 'compare.gauges=[10]' --set run.end_time=0.001 --out at_10_m > at_10_m.log 2>&1 || fail "a gauge at 10 m: $(cat at_10_m.log)"
grep -q '"source"' at_10_m/summary.json && grep -q 'source.*0.2075.*0.019.*0.092' at_10_m/report.html || fail "the source's run does not stand beside this one"
"$program" "${short[@]}" --fluid none --set run.end_time=0.01 --out none > none.log || fail "a dry channel: $(cat none.log)"
grep -q '"water_depth_m"' none/summary.json && fail "a dry channel has water"
level_stands none none

# --- levels and laws that the file names
chosen() { # chosen KEY NAME OPTION...: the summary has it as KEY
    local key="$1" name="$2"
    shift 2
    "$program" "$@" --out chosen > chosen.log 2>&1 || fail "$name: $(cat chosen.log)"
    [ "$(value chosen/summary.json "$key")" = "\"$name\"" ] || fail "$key is not $name"
    holds "$name: the ledger closes" "$(value chosen/summary.json ledger_residual_relative) < 1e-6"
}
quick="$(dirname "$0")/../../examples/invert_channel/quick.toml"
sed '/^stiffness = .* # N.m/d; /^restitution/d; /^coefficient/d' "$quick" > plain.toml  # keys that not all laws have
plain=(plain.toml "${short[@]}" --set concrete.stiffness=2e6)
chosen concrete_level static quick.toml "${short[@]}" --set concrete.cluster=1
chosen concrete_level rigid quick.toml "${short[@]}" --set 'concrete.level="rigid"'
chosen concrete_level dynamic quick.toml "${short[@]}" --set 'concrete.level="dynamic"' --set concrete.layers=2 --set run.end_time=0.002
chosen contact_law linear quick.toml "${short[@]}" --set 'contact.law="linear"'
chosen contact_law elastic_plastic "${plain[@]}" --set 'contact.law="elastic_plastic"' --set contact.yield_pressure=3e8
holds "it loses energy" "$(value chosen/summary.json restitution_at_1_m_per_s) < 1 && $(value chosen/summary.json energy_lost_normal_J) > 0"
chosen wear_law archard quick.toml "${short[@]}" --set 'wear.law="archard"' --set wear.hardness=1e9
holds "archard wears" "$(value chosen/summary.json worn_volume_m3) > 0"
[ "$(value chosen/summary.json worn_over_energy)" = null ] || fail "a law that goes by other things than the energy lost is held to it"
chosen wear_law ishibashi "${plain[@]}" --set contact.stiffness=2e6 --set 'wear.law="ishibashi"' --set wear.impact=1e-8 --set wear.friction=1e-9
holds "ishibashi wears" "$(value chosen/summary.json worn_volume_m3) > 0"
chosen wear_law none quick.toml "${short[@]}" --set 'wear.law="none"'
holds "nothing wears" "$(value chosen/summary.json worn_volume_m3) == 0"

# --- in flight: stones that drop hit harder; the supply ends when told
"$program" "${short[@]}" --set sediment.feed_height=1 --set sediment.feed_until=0.1 --out dropped > dropped.log 2>&1 || fail "dropped stones: $(cat dropped.log)"
holds "the supply has ended" "$(value dropped/summary.json sediment_fed_m3) <= 0.0083 * 0.1"
grep -q 'the supply fell short' dropped.log && fail "an ended supply counts as one that fell short"

# --- milestones: the bed is kept as enough has passed each end of the section, and the last ends the run
"$program" "${short[@]}" --set run.end_time=20 --set 'compare.converted=[0.02]' --out milestones > milestones.log 2>&1 || fail "milestones: $(cat milestones.log)"
for file in milestone_1.png milestone_2.png; do [ -s "milestones/$file" ] || fail "milestones/$file is missing or empty"; done
holds "a milestone ends the run" "$(value milestones/summary.json simulated_s) < 19"
[ "$(value milestones/summary.json stopped_early)" = false ] || fail "a milestone counts as a stop"
[ "$(grep -o '"past_m": *[0-9.]*' milestones/summary.json | tr -dc '0-9.\n' | tr '\n' ' ')" = "0.2 0.5 " ] || fail "milestones are not those asked for"
grep -q '"milestones":.*"across_depth_mm_per_m3"' milestones/profiles.json || fail "profiles.json has no milestones"

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
# ... and while pictures are drawn loses nothing; SIGTERM, since bash has what runs behind it ignore SIGINT
broken_gnuplot slow "touch '$PWD/slow/draws'; sleep 1"
PATH="$PWD/slow:$PATH" "$program" "${short[@]}" --set run.end_time=0.01 --out drawn > drawn.log 2>&1 &
pid=$!
while [ ! -e slow/draws ] && kill -0 $pid; do sleep 0.05; done
kill -TERM $pid
wait $pid || true
[ -s drawn/summary.json ] || fail "Ctrl-C while pictures are drawn: the results are lost"
"$program" --fluid grid --set fluid.settle=1000 --out unsettled > unsettled.log 2>&1 &
pid=$!
sleep 2
kill -INT $pid
wait $pid || fail "Ctrl-C while water settles: exit code $?"
[ "$(value unsettled/summary.json stopped_early)" = true ] || fail "a run stopped while water settles does not say so"
holds "only what has settled is told" "$(value unsettled/summary.json water_settled_s) < 999"

# --- a run that goes wrong: exit 3, nothing under the final name, the last good state saved
status=0
"$program" "${short[@]}" --set run.end_time=2 --set contact.stiffness=1000 --out soft > soft.log 2>&1 || status=$?
[ $status -eq 3 ] || fail "runaway overlap: exit code $status"
grep -qE 'step [0-9]+ .*with id [0-9]+ .*overlaps' soft.log || fail "runaway overlap is not explained: $(cat soft.log)"
[ ! -e soft ] && [ -s soft.failed/last_good.h5 ] || fail "runaway overlap: wrong files"

status=0
"$program" "${short[@]}" --fluid shallow --set run.end_time=2 --set contact.stiffness=1000 --out wet > wet.log 2>&1 || status=$?
[ $status -eq 3 ] && [ -s wet.failed/last_good.h5 ] || fail "a failed run in shallow water: exit code $status: $(cat wet.log)"
grep -q surface wet.failed/last_good.h5 || fail "the water of a failed run is not kept"

# --- pictures that fail take nothing with them: exit 1, data and summary are kept
broken_gnuplot unable :
status=0
PATH="$PWD/unable:$PATH" "$program" "${short[@]}" --set run.end_time=0.01 --out unpainted > unpainted.log 2>&1 || status=$?
[ $status -eq 1 ] || fail "no pictures: exit code $status"
for file in summary.json series.h5; do [ -s unpainted/$file ] || fail "no pictures: $file is lost"; done
grep -q 'null' unpainted/summary.json || fail "a depth per sediment without sediment"

# --- no word on a safe beta where nothing wore
"$program" "${short[@]}" --set run.end_time=0.001 --out untouched > /dev/null || fail "a run in which nothing wears"
grep -q '"validity": "No collision wore concrete' untouched/summary.json || fail "nothing wore, and beta is called safe"

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
refused "an unknown surface" 'fluid.surface.*height' --fluid grid --set 'fluid.surface="heigth"'
refused "an unknown exchange" 'fluid.exchange.*monolithic.*mixture.*direct' --fluid resolved --set 'fluid.exchange="mixed"'
refused "an exchange without one" 'fluid.exchange.*left out.*grid.*no use' --fluid grid --set 'fluid.exchange="mixture"'
refused "one fluid that averages" 'fluid.resolved_from.*left out.*mixture.*no use' --fluid resolved --set 'fluid.exchange="mixture"' --set fluid.resolved_from=3
refused "a law of its own water" 'fluid.model with contact.law.*uniform with linear.*got grid with linear' --fluid grid --set 'contact.law="linear"'
refused "a key of another law" 'contact.yield_pressure.*hysteretic.*no use' --set contact.yield_pressure=1e8
refused "a law without a restitution" 'contact.restitution.*left out.*elastic_plastic' plain.toml --set concrete.stiffness=2e6 --set 'contact.law="elastic_plastic"' --set contact.yield_pressure=1e8 --set contact.restitution=0.5
refused "no yield pressure" 'contact.yield_pressure.*required' plain.toml --set concrete.stiffness=2e6 --set 'contact.law="elastic_plastic"'
refused "yield pressure" 'contact.yield_pressure.*> 0.*-1 Pa' plain.toml --set concrete.stiffness=2e6 --set 'contact.law="elastic_plastic"' --set contact.yield_pressure=-1
refused "another law's weights" 'wear.normal_weight.*archard.*no use' --set 'wear.law="archard"' --set wear.hardness=1e9 --set wear.normal_weight=2
refused "no coefficients" 'wear.impact.*required' plain.toml --set concrete.stiffness=2e6 --set contact.stiffness=2e6 --set 'wear.law="ishibashi"'
refused "unknown level" 'concrete.level.*did you mean "static"' --set 'concrete.level="statik"'
refused "a large cluster" 'concrete.cluster.*at most 2.*3 bonds' --set concrete.cluster=3
refused "a cluster of rigid concrete" 'concrete.cluster.*static' --set 'concrete.level="rigid"' --set concrete.cluster=1
refused "a patch without a size" 'wear.overflow_length' --set 'wear.overflow="patch"'
refused "an epoch's time for a crater" 'wear.overflow_every.*crater' --set wear.overflow_every=1
refused "a gauge outside" 'compare.gauges.*inside the channel.*3 m' --set 'compare.gauges=[3]'
refused "a step beyond the stable one" 'run.safety.*\(0, 1\].*got 5' --check --set run.safety=5
refused "stones without number" 'sediment.sizes.*at most 1e8 stones' --check --set 'sediment.sizes=[1e-6,0.05,0.075,0.1,0.15]'
refused "water over everything" 'water.discharge of 1e.?09 m3/s.*below 5 m' --check --set water.discharge=1e9
refused "an empty fluid" 'fluid.model.*one of.*got ""' --fluid ""
refused "a misspelt key of water that does not flow" 'unknown key fluid.spacng; did you mean fluid.spacing' --set fluid.spacng=0.1
refused "cells above the water" 'fluid.spacing.*at most the water.s depth.*0.24 m.*shallow' --check --fluid grid --set fluid.spacing=0.24 --set water.discharge=0.05
refused "cells without number" 'fluid.spacing of 0.0005 m: cells.*at most 1e.?08.*larger cells' --check --fluid resolved --set fluid.spacing=0.0005
refused "a roughness of rocks" 'Inflow.roughness.*below 30 depths.*Strickler' --check --fluid grid --set water.manning=0.2
refused "stones of nothing" 'sediment.density.*from 1 to 30000.*got 1e.?30 kg/m3; quartz' --check --set sediment.density=1e30
refused "concrete of nothing" 'concrete.density.*from 1 to 30000.*got 0.1 kg/m3; quartz' --check --set concrete.density=0.1
refused "stones that are shot" 'sediment.feed_speed.*from 0 to 100.*got 1e.?06 m/s; stones' --check --set sediment.feed_speed=1e6
refused "water in g/cm3" 'water.density.*from 500 to 2000.*got 1 kg/m3; water has 1000' --check --set water.density=1
refused "viscosity of what is no water" 'water.viscosity.*from 0.0001 to 1.*got 1000 Pa s' --check --set water.viscosity=1000
refused "stones of a million cells" 'fluid.resolved_from.*from 0 to 1000.*unresolved' --check --fluid resolved --set fluid.resolved_from=1e6
"$program" --check --set fluid.spacing=0.04 > unused.log 2>&1 || fail "a key that has no use here: $(cat unused.log)"
grep -q 'note: --set fluid.spacing=0.04: .*uniform.*no use' unused.log || fail "a key without use is taken silently: $(cat unused.log)"
"$program" paper.toml --check > unused.log 2>&1 && [ ! -s unused.log ] || fail "a file's keys for another fluid: $(cat unused.log)"
refused "unknown option" 'help' --frobnicate
mkdir -p readonly_is_a_file && touch readonly_is_a_file/inside
code=0; "$program" --out readonly_is_a_file/inside > refused.log 2>&1 || code=$?
[ $code -eq 2 ] || fail "an output folder that is a file: exit code $code, $(cat refused.log)"

[ $failures -eq 0 ] && echo "invert channel: all as promised"
exit $((failures > 0))
