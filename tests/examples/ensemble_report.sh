#!/usr/bin/env bash
# Ensembles as a user meets them: a product, a resumed one, failed runs, two hosts, and bad input.
set -euo pipefail
here="$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
ensemble="$here/../../examples/ensemble"
programs="$(dirname "$1")"
folder="$2"
export ABRADE_NO_INSTALL=1
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; }  # NAME EXPRESSION, with awk's syntax
value() { grep -oE "\"$2\": *[^,}]*" "$1" | head -1 | sed 's/.*: *//'; }
scene=quick.toml end_time=0.05
# run FOLDER OPTION...: its output goes to FOLDER.log, its exit code to `code`.
run() {
    local out="$1"
    shift
    code=0
    "$ensemble" "$scene" --programs "$programs" --set "run.end_time=$end_time" --set channel.length=0.5 --set compare.gauge=0.1 \
        --set compare.from=0.1 --set compare.to=0.5 --out "$folder/$out" "$@" >"$out.log" 2>&1 || code=$?
}
done_runs() { tail -n +2 "$1/jobs.log" | wc -l; }

# --- a product of values and seeds: each run in its folder, means over them
run product --seeds 2 --sweep contact.friction=0.3,0.6 --jobs 2
[ $code -eq 0 ] || fail "a product: exit code $code: $(cat product.log)"
for run in 1_contact.friction=0.3/seed_{1,2} 2_contact.friction=0.6/seed_{1,2}; do
    for file in log.txt results/summary.json results/profiles.json results/report.html; do
        [ -s "product/runs/$run/$file" ] || fail "$run/$file is missing or empty"
    done
done
for file in report.html ensemble.json jobs.log charts/metric.png charts/centre_lines.png charts/across.png; do
    [ -s "product/$file" ] || fail "product/$file is missing or empty"
done
grep -qE 'src="http|href="http' product/report.html && fail "the report loads something from outside"
of_run() { value "product/runs/1_contact.friction=0.3/seed_$1/results/summary.json" worn_volume_m3; }
of_case() { awk '/"worn_volume_m3"/ { found = 1 } found' product/ensemble.json >metric.txt; value metric.txt "$1"; }
holds "the mean" "(($(of_run 1) + $(of_run 2)) / 2 / $(of_case mean) - 1)^2 < 1e-24"
holds "the standard error" "(($(of_run 1) - $(of_run 2)) / 2 / $(of_case standard_error))^2 - 1 < 1e-12"
grep -q '"contact.friction": "0.6"' product/ensemble.json || fail "ensemble.json does not name the overrides"
holds "threads" "$(value product/runs/2_contact.friction=0.6/seed_2/results/summary.json threads) == 1"

# --- the same again runs nothing; more seeds run only what is new
cp product/jobs.log before.log
run product --seeds 2 --sweep contact.friction=0.3,0.6 --jobs 2
[ $code -eq 0 ] && cmp -s before.log product/jobs.log || fail "the same command again: exit code $code: $(cat product.log)"
run product --seeds 1,2,7 --sweep contact.friction=0.3,0.6
[ $code -eq 0 ] && [ "$(done_runs product)" -eq 6 ] || fail "one more seed: exit code $code: $(cat product.log)"
head -n 5 product/jobs.log | cmp -s - before.log || fail "with one more seed, done runs are run again"

# --- interrupted: exit 130; what was done stays, the rest is run by the same command
"$ensemble" "$scene" --programs "$programs" --set "run.end_time=$end_time" --set channel.length=0.5 --set compare.gauge=0.1 \
    --set compare.from=0.1 --set compare.to=0.5 --out "$folder/broken_off" --seeds 3 --jobs 1 >broken_off.log 2>&1 &
pid=$!
for _ in $(seq 600); do
    if [ -e broken_off/jobs.log ] && [ "$(done_runs broken_off)" -ge 1 ]; then break; fi
    sleep 0.1
done
kill -TERM $pid
code=0
wait $pid || code=$?
[ $code -eq 130 ] || fail "interrupted: exit code $code: $(cat broken_off.log)"
grep -q 'the same command goes on' broken_off.log || fail "interrupted: no word of how to go on"
before="$(done_runs broken_off)"
[ "$before" -lt 3 ] || fail "nothing was left to be interrupted"
first="$(sed -n 2p broken_off/jobs.log)"
flock -w 20 broken_off/.lock true || fail "a run goes on after the ensemble was interrupted"  # one may still draw
run broken_off --seeds 3 --jobs 1
[ $code -eq 0 ] && [ "$(done_runs broken_off)" -eq 3 ] || fail "gone on: exit code $code: $(cat broken_off.log)"
grep -qxF "$first" broken_off/jobs.log || fail "a run that was done is run again"
[ "$(cut -f 1 broken_off/jobs.log | sort | uniq -d | wc -l)" -eq 0 ] || fail "a run stands twice in jobs.log"
grep -q '"ok": 3' broken_off/ensemble.json || fail "not all runs count"

# --- levels of fluid: each runs to its end and closes its ledger, and the report says what each costs and changes
levels=(none uniform shallow grid unresolved resolved) end_time=0.1
# Stones of 3 cells, that water flows around where it is resolved, and smaller ones.
of_levels=(--fluid all --seeds 1 --set fluid.spacing=0.04 --set sediment.rate=0.03 --set 'sediment.sizes=[0.05,0.12]' --set 'sediment.fractions=[0.3,0.7]')
run levels "${of_levels[@]}"
[ $code -eq 0 ] || fail "all levels of fluid: exit code $code: $(cat levels.log)"
holds "all levels are done" "$(value levels/ensemble.json ok) == 6 && $(value levels/ensemble.json failed) == 0"
level() { echo "levels/runs/$1_fluid.model=${levels[$1 - 1]}/seed_1"; }  # NUMBER: its folder
of_level() { value "$(level "$1")/results/summary.json" "$2"; }
largest=0
for number in 1 2 3 4 5 6; do
    name="${levels[number - 1]}"
    holds "$name: stones wear" "$(of_level $number worn_volume_m3) > 0"
    holds "$name: the ledger closes" "$(of_level $number ledger_residual_relative) < 1e-12"
    largest="$(awk "BEGIN { x = $(of_level $number ledger_residual_relative); printf \"%.2g\", (x > $largest ? x : $largest) }")"
    row="$(grep -F ">fluid.model = $name<" levels/report.html)" || fail "$name is not in the table"
    for key in wall_s energy_lost_normal_J energy_lost_sliding_J sampled_stone_speed_m_per_s stones_off_bed_share; do
        shown="$(printf '%.4g' "$(of_level $number $key)")"
        [[ "$row" == *">$shown (one value)<"* ]] || fail "$name: the table has no $key of $shown: $row"
        drawn="$(of_level $number $key)"
        awk -v drawn="$drawn" 'NF && $1 + 0 == drawn + 0 { found = 1 } END { exit !found }' levels/charts/metric.dat || fail "$name: the picture has no $key"
    done
done
grep -qF "ledger closes in every run: the largest relative residual is $largest (" levels/report.html || fail "the report does not say that the ledgers close: $largest"
[ "$(for n in 1 2 3 4; do of_level $n fluid; done | paste -sd " ")" = '"NoFluid" "UniformFlow" "TwoWayShallow" "GridFluid"' ] || fail "levels do not run in fluids of their own"
holds "unresolved: no stone is" "$(of_level 5 stones_resolved) == 0"
holds "resolved: large stones are" "$(of_level 6 stones_resolved) > 0 && $(of_level 6 stones_averaged) > 0"
holds "water drives stones" "$(of_level 1 sampled_stone_speed_m_per_s) < $(of_level 6 sampled_stone_speed_m_per_s)"
# ... and so do exchanges of momentum
run exchanges --fluid resolved --sweep 'fluid.exchange="mixture","direct"' --seeds 1 --set fluid.spacing=0.04
[ $code -eq 0 ] || fail "two exchanges: exit code $code: $(cat exchanges.log)"
for name in mixture direct; do grep -qF ">fluid.exchange = $name<" exchanges/report.html || fail "$name is not in the table"; done
grep -q 'wall time of a run' exchanges/report.html || fail "the table of exchanges does not say what each costs"
grep -q '"level\.' exchanges/ensemble.json && fail "figures of the level are in ensemble.json twice"
# ... a summary of another scene, or without a figure of the table, is named, and its remedy helps
sed -i 's/"configuration": "quick.toml"/"configuration": "paper.toml"/' "$(level 1)/results/summary.json"
sed -i '/"stones_off_bed_share"/d' "$(level 2)/results/summary.json"
code=0
"$programs/ensemble_report" levels >mixed.log 2>&1 || code=$?
[ $code -eq 3 ] || fail "summaries of others: exit code $code: $(cat mixed.log)"
grep -q 'model=none, seed 1.*summary.json must be of quick.toml under seed 1, got of paper.toml under seed 1; delete the folder' mixed.log || fail "another scene is not named: $(cat mixed.log)"
grep -q 'model=uniform, seed 1.*summary.json: stones_off_bed_share must be a number.*, got nothing; delete the folder' mixed.log || fail "a missing figure is not named: $(cat mixed.log)"
holds "neither counts" "$(value levels/ensemble.json ok) == 4"
cp levels/jobs.log before.log
rm -r "$(level 1)" "$(level 2)"
run levels "${of_levels[@]}"
[ $code -eq 0 ] || fail "levels made again: exit code $code: $(cat levels.log)"
holds "all levels are done again" "$(value levels/ensemble.json ok) == 6"
[ "$(grep -cxFf before.log levels/jobs.log)" -eq 5 ] || fail "other levels than the two that were deleted are run again"
end_time=0.05

# --- failed runs are named and leave the others alone; they are run again only when asked
fails=(--seeds 2 --sweep contact.stiffness=30 --sweep contact.friction=0.3 --one-at-a-time)
run failing "${fails[@]}" --metric worn_volume_m3
[ $code -eq 0 ] || fail "three cases of short runs: exit code $code: $(cat failing.log)"
[ -s failing/charts/tornado.png ] || fail "no tornado chart"
grep -q less_base failing/ensemble.json || fail "no differences to the base"
end_time=0.1  # long enough for springs that are too soft
run failing "${fails[@]}"
[ $code -eq 2 ] && grep -q 'another --set.*--fresh' failing.log || fail "other values in the same folder: exit code $code: $(cat failing.log)"
run failing "${fails[@]}" --fresh
[ $code -eq 3 ] || fail "failed runs: exit code $code: $(cat failing.log)"
for seed in 1 2; do
    grep -qE "failed: 1_contact.stiffness=30, seed $seed, exit code 3: .*(overlaps|of its radius in a step)" failing.log || fail "seed $seed is not named: $(cat failing.log)"
done
grep -q '2 of 6 runs failed' failing/report.html || fail "the report does not tell of failed runs"
[ "$(done_runs failing)" -eq 6 ] || fail "a failed run keeps others from being run"
holds "failed runs" "$(value failing/ensemble.json failed) == 2"
cp failing/jobs.log before.log
run failing "${fails[@]}"
[ $code -eq 3 ] && cmp -s before.log failing/jobs.log || fail "failed runs are run again without being asked"
run failing "${fails[@]}" --retry-failed --metric worn_volume
[ $code -eq 2 ] && grep -q 'did you mean worn_volume_m3' failing.log || fail "unknown metric: exit code $code: $(cat failing.log)"
[ "$(done_runs failing)" -eq 6 ] || fail "not all runs are in jobs.log: $(cat failing/jobs.log)"
[ "$(grep -cxFf before.log failing/jobs.log)" -eq 5 ] || fail "other runs than the failed ones are run again"

end_time=0.05

# --- two hosts that are this machine: each has a home of its own; files go there and come back
cat >ssh <<TEXT
#!/usr/bin/env bash
# Stands in for ssh: ssh [OPTION...] HOST COMMAND...
host="\$1"
shift
[ "\$1" != -- ] || shift
mkdir -p "$folder/homes/\$host"
cd "$folder/homes/\$host" || exit
exec env -i PATH="\$PATH" SHELL=/bin/bash HOME="\$PWD" bash -c "\$*"
TEXT
chmod +x ssh
printf '# two\n1/alpha\n1/beta\n' >hosts.txt
PARALLEL_SSH="$folder/ssh" run hosts --seeds 3 --hosts "$folder/hosts.txt"
[ $code -eq 0 ] || fail "hosts: exit code $code: $(cat hosts.log)"
[ "$(tail -n +2 hosts/jobs.log | cut -f 2 | sort -u | paste -sd ' ')" = "alpha beta" ] || fail "not both hosts worked: $(cat hosts/jobs.log)"
grep -q '"ok": 3' hosts/ensemble.json || fail "not all runs came back from the hosts"
[ -z "$(find homes -type f)" ] || fail "something is left on the hosts: $(find homes -type f)"
printf '#!/bin/sh\necho refused >&2\nexit 255\n' >ssh
PARALLEL_SSH="$folder/ssh" run no_hosts --seeds 1 --hosts "$folder/hosts.txt"
[ $code -eq 2 ] && grep -q 'alpha.*refused' no_hosts.log && grep -q 'every host must have this checkout' no_hosts.log || fail "hosts that cannot be reached: exit code $code: $(cat no_hosts.log)"
[ ! -e no_hosts/runs ] || fail "hosts that cannot be reached get runs"

# --- another program or file in the same folder is told
mkdir -p other
cp "$programs/invert_channel" "$programs/ensemble_report" other/
printf ' ' >>other/invert_channel
run broken_off --seeds 3 --programs "$folder/other"
[ $code -eq 2 ] && grep -q 'another build.*--fresh' broken_off.log || fail "another build: exit code $code: $(cat broken_off.log)"
{ cat "$here/../../examples/invert_channel/quick.toml"; echo '# changed'; } >quick.toml
scene="$folder/quick.toml"
run broken_off --seeds 3
[ $code -eq 2 ] && grep -q 'another content of quick.toml' broken_off.log || fail "another file: exit code $code: $(cat broken_off.log)"
scene=quick.toml
run broken_off --seeds 2
[ $code -eq 2 ] && grep -q 'another list of --seeds' broken_off.log || fail "fewer seeds: exit code $code: $(cat broken_off.log)"

# --- bad input: exit 2, one clear message, nothing made
refused() {  # WHAT REGEX OPTION...
    local what="$1" regex="$2"
    shift 2
    run refused "$@"
    [ $code -eq 2 ] || fail "$what: exit code $code: $(cat refused.log)"
    grep -qE "^error: .*$regex" refused.log || fail "$what: message is '$(cat refused.log)'"
    [ "$(wc -l <refused.log)" -eq 1 ] || fail "$what: message of $(wc -l <refused.log) lines"
    [ ! -e refused ] || fail "$what: left something behind"
}
refused "unknown key" 'contact.frictoin.*contact.friction' --sweep contact.frictoin=0.3,0.4
refused "value out of range" 'restitution.*\(0, 1\].*1.5' --sweep contact.restitution=0.5,1.5
refused "text without quotes" 'concrete.join.*quotes' --sweep concrete.join=mean,minimum
refused "empty list" '--sweep contact.friction must list values' --sweep contact.friction=
refused "gap in a list" '--sweep contact.friction must list values' --sweep contact.friction=0.3,,0.5
refused "no list" '--sweep must be section.key=value,value' --sweep contact.friction
refused "value twice" 'different values, got 0.3 twice' --sweep contact.friction=0.3,0.3
refused "key twice" 'contact.friction must be given once' --sweep contact.friction=0.3,0.4 --set contact.friction=0.2
refused "seed by --set" 'run.seed must be given by --seeds' --set run.seed=3
refused "no seeds" '--seeds must be how many.*0' --seeds 0
refused "negative seed" '--seeds must be whole numbers.*-2' --seeds 1,-2
refused "seed twice" '--seeds must differ, got 2 twice' --seeds 2,1,2
refused "no jobs" '--jobs must be a whole number.*0' --jobs 0
refused "missing hosts" '--hosts must be a file.*nowhere' --hosts nowhere
printf '# none\n' >empty.txt
refused "no hosts" '--hosts must list at least one host' --hosts "$folder/empty.txt"
refused "nothing to vary" '--one-at-a-time must come with' --one-at-a-time
refused "unknown option" 'no option --sed; did you mean --se' --sed 3
refused "two fluids" 'fluid.model must be given once' --fluid shallow --sweep 'fluid.model="grid"'
refused "unknown fluid" 'fluid.model.*shallow' --fluid shalow
refused "unknown fluid among several" 'fluid.model.*shallow' --fluid none,shalow
refused "fluid twice" 'fluid.model must list different values, got "none" twice' --fluid none,grid,none
refused "fluids twice" 'fluid.model must be given once' --fluid all --set 'fluid.model="grid"'
refused "two files" 'one FILE.toml must be given' paper.toml
refused "missing programs" '--programs must be a folder' --programs "$folder/homes"
scene=nowhere.toml
refused "missing file" 'nowhere.toml'
scene=quick.toml
touch a_file
for out in a_file a_file/inside; do
    code=0
    "$ensemble" "$scene" --programs "$programs" --out "$folder/$out" --seeds 1 >refused.log 2>&1 || code=$?
    [ $code -eq 2 ] && grep -q -- '--out must be a folder' refused.log || fail "--out $out: exit code $code: $(cat refused.log)"
done
mkdir -p mine && touch mine/letter.txt
run mine --seeds 1
[ $code -eq 2 ] && grep -q 'holds other files' mine.log || fail "a folder of other files: exit code $code: $(cat mine.log)"
code=0
"$programs/ensemble_report" mine >mine.log 2>&1 || code=$?
[ $code -eq 2 ] && grep -q 'examples/ensemble' mine.log || fail "a report of no ensemble: exit code $code: $(cat mine.log)"

[ $failures -eq 0 ] && echo "ensembles: all as promised"
exit $((failures > 0))
