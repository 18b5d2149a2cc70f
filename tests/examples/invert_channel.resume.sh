#!/usr/bin/env bash
# A run of the invert channel that is killed again and again, and goes on each time, comes to the same as one that was
# left alone: to the last bit, with any number of threads. What cannot be gone on with is refused.
set -euo pipefail
program="$1"
kills="${ABRADE_KILLS:-12}"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
# What two runs of the same may differ in: wall times, and how many threads there were.
same_results() { # same_results WHAT FOLDER FOLDER
    for folder in "$2" "$3"; do grep -vE '"(threads|.*wall_s|contacts_and_wear|bonds|motion_and_fluid|lists|changing_fluid)":' "$folder/summary.json" > "$folder.summary"; done
    cmp -s "$2.summary" "$3.summary" || fail "$1: $(diff "$2.summary" "$3.summary" | head -5)"
    cmp -s "$2/profiles.json" "$3/profiles.json" || fail "$1: other profiles"
    for cloud in stones concrete; do
        [ "$(grep -c '<Time' "$2/series_$cloud.xdmf")" = "$(grep -c '<Time' "$3/series_$cloud.xdmf")" ] ||
            fail "$1: another number of times in series_$cloud.xdmf"
    done
    # Every file that the series names is there.
    for named in $(grep -ohE 'series[-0-9]*\.h5' "$3"/series_*.xdmf | sort -u); do [ -s "$3/$named" ] || fail "$1: $named is missing"; done
}

# Some 3 s of wall time of one core.
base=(--set channel.length=6 --set run.end_time=1.4 --set contact.stiffness=2e7 --set compare.gauge=3 --set compare.from=1 --set compare.to=5)
pause() { sleep "$(($1 / 1000)).$(printf '%03d' $(($1 % 1000)))"; }  # pause MILLISECONDS
now_ms() { echo $(($(date +%s%N) / 1000000)); }
began=$(now_ms)
"$program" "${base[@]}" --threads 1 --out whole > whole.log || fail "the run that is left alone: $(cat whole.log)"
took=$(($(now_ms) - began))
every_ms=$((took / 30 + 20))
every=$(awk "BEGIN {print $every_ms / 60000}")  # min

# --- kill -9 at random moments, after a twentieth to a fifth of the whole run's time; a run that comes to its end before all of them is compared, and begun anew
go_on() { # to the end
    "$program" "${base[@]}" --threads 2 --set run.checkpoint_every=$every --out killed "${resume[@]}" > killed.log 2>&1 || fail "the run that goes on fails: $(cat killed.log)"
}
ended() { # ended WHEN: what the killed run has come to is that of the whole one
    same_results "$1" whole killed
    [ ! -e killed.checkpoint.h5 ] || fail "a run that came to its end leaves its checkpoint"
    rm -rf killed killed.checkpoint.h5
    resume=()
}
resume=()
resumed=0
for ((kill = 0; kill < kills;)); do
    "$program" "${base[@]}" --threads $((1 + kill % 2)) --set run.checkpoint_every=$every --out killed "${resume[@]}" > killed.log 2>&1 &
    pid=$!
    ms=$((took * (5 + RANDOM % 16) / 100))
    pause $ms
    if kill -9 $pid 2> /dev/null; then
        kill=$((kill + 1))
        wait $pid 2> /dev/null || true
        resume=()
        if [ -e killed.checkpoint.h5 ]; then resume=(--resume) resumed=$((resumed + 1)); fi
    else
        wait $pid || fail "the run that goes on fails: $(cat killed.log)"
        ended "after $kill kills"
    fi
done
[ $resumed -gt $((2 * kills / 5)) ] || fail "only $resumed of $kills kills found a checkpoint"
go_on
ended "after $kill kills"

# --- a run that is killed as it draws its pictures, which went on from one that was killed: its series is whole
"$program" "${base[@]}" --threads 1 --set run.checkpoint_every=$every --out killed > killed.log 2>&1 &
pid=$!
pause $((took * 6 / 10))
kill -9 $pid || fail "the run is too short for this test"
wait $pid 2> /dev/null || true
for again in 1 2; do
    "$program" "${base[@]}" --threads 1 --set run.checkpoint_every=60 --out killed --resume > killed.log 2>&1 &
    pid=$!
    until [ -n "$(find . -path './.killed.partial-*/summary.json')" ] || ! kill -0 $pid 2> /dev/null; do sleep 0.02; done
    kill -9 $pid || fail "the pictures are drawn too soon for this test"
    wait $pid 2> /dev/null || true
    rm -f .killed.partial-*/summary.json
done
resume=(--resume)
go_on
ended "killed as it drew"

# --- what is lost is what came after the last checkpoint: no more than that time, and what a save takes
"$program" "${base[@]}" --threads 1 --set run.checkpoint_every=$every --out young > young.log 2>&1 &
pid=$!
pause $((took / 2))
kill -9 $pid || fail "the run is too short for this test"
wait $pid 2> /dev/null || true
[ -e young.checkpoint.h5 ] || fail "half a run leaves no checkpoint"
age=$(($(now_ms) - $(date -r young.checkpoint.h5 +%s%N) / 1000000))
allowed=$((5 * every_ms + took / 20))
[ $age -lt $allowed ] || fail "the last checkpoint is $age ms old, $every_ms ms are allowed, and what a save takes"

# --- signals: results so far, a checkpoint, and on from there
stopped_by() { # stopped_by SIGNAL OPTION...
    local signal="$1" pid
    shift
    "$program" "$@" --threads 1 --out ended > ended.log 2>&1 &
    pid=$!
    pause $((took / 4))
    kill "-$signal" $pid || fail "$signal: the run is too short for this test"
    wait $pid || fail "$signal: exit code $?: $(cat ended.log)"
    grep -q -- '--resume goes on' ended.log || fail "$signal: no word of how to go on: $(cat ended.log)"
    grep -q '"stopped_early": true' ended/summary.json || fail "$signal: the results do not say so"
    cp ended.checkpoint.h5 kept.h5
    "$program" "$@" --threads 1 --out ended --resume > ended.log 2>&1 || fail "after $signal it does not go on: $(cat ended.log)"
}
wet=("${base[@]}" --fluid shallow)  # water that feels the stones
"$program" "${wet[@]}" --threads 1 --out wet > wet.log || fail "shallow water that is left alone: $(cat wet.log)"
stopped_by TERM "${wet[@]}"
same_results "in shallow water" wet ended
for signal in HUP INT; do
    stopped_by $signal "${base[@]}"
    same_results "after $signal" whole ended
done

# --- what is refused: exit 2, one message, nothing written, the checkpoint left alone
refused() { # refused WHAT REGEX OPTION...
    local what="$1" regex="$2" code=0
    shift 2
    "$program" --out refused --resume "$@" > refused.log 2>&1 || code=$?
    [ $code -eq 2 ] || fail "$what: exit code $code: $(cat refused.log)"
    grep -qE "$regex" refused.log || fail "$what: message is '$(cat refused.log)'"
    [ ! -e refused ] || fail "$what: left results behind"
}
refused "no checkpoint" "no checkpoint .*refused.checkpoint.h5" "${base[@]}"
cp kept.h5 refused.checkpoint.h5
(flock 9; refused "a run that is under way" "under way" "${base[@]}") 9> refused.checkpoint.h5.lock
refused "another run" "sediment.rate" "${base[@]}" --set sediment.rate=0.001
head -c 100000 kept.h5 > refused.checkpoint.h5
refused "truncated" "cannot (open|read) .*refused.checkpoint.h5.*truncated" "${base[@]}"
echo "no HDF5" > refused.checkpoint.h5
refused "foreign" "cannot (open|read) .*refused.checkpoint.h5" "${base[@]}"
cp whole/series.h5 refused.checkpoint.h5
refused "another HDF5 file" "not what save_state\(\) wrote" "${base[@]}"

# --- a full disk ends the run, and the last checkpoint is whole: saved every 10 ms, the first is there before the series
# has filled the disk, and a later one does not fit beside it
mkdir -p small
if mount -t tmpfs -o size=12m none small 2> /dev/null; then
    code=0
    (cd small && "$program" "${base[@]}" --threads 1 --set run.output_every=0.002 --set run.checkpoint_every=0.0002 --out full > ../full.log 2>&1) || code=$?
    [ $code -eq 1 ] || fail "a full disk: exit code $code: $(cat full.log)"
    grep -qiE 'no space|disk' full.log || fail "a full disk is not named: $(cat full.log)"
    if [ -e small/full.checkpoint.h5 ]; then
        cp small/full.checkpoint.h5 refused.checkpoint.h5
        "$program" "${base[@]}" --threads 1 --set run.output_every=0.002 --out refused --resume > refused.log 2>&1 || fail "the checkpoint of a full disk: $(cat refused.log)"
    else
        fail "a full disk: no checkpoint is left"
    fi
    umount small
else
    echo "no right to mount a small disk: that a full one leaves the last checkpoint whole is not tried"
fi

[ $failures -eq 0 ] || exit 1
