#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bakes that are cut short: killed at random moments, interrupted, gone on with other settings. The
# field in the end has the bytes of one that was never cut short.   check_resume.sh NACRE SOURCE
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"
RANDOM=${SEED:=$$}
echo "seed $SEED"

fail() {
    echo "$*" >&2
    cat "$work/err" >&2 || true
    exit 1
}

# A scene whose light costs nothing, captured for a second or two.
jq '.presets.quick.irradiance = {"rays": 4, "bounces": 1, "spacing": 0.5}' \
    data/scenes/spheres.json >"$work/scene.json"
bake=(bake "$work/scene.json" --preset quick --points 60 --cube 128 --map 16 --json)

"$nacre" "${bake[@]}" -o "$work/whole.field" >"$work/out" 2>"$work/err" || fail "the bake failed"
capture=$(jq '.seconds.capture * 1000 | floor' "$work/out")

# Whether a first tile has been noted: the journal's lead alone is shorter than this.
tile_noted() {
    [ "$(stat -c %s "$work/cut.field.partial/tiles.journal" 2>/dev/null || echo 0)" -gt 48 ]
}

# Runs until capture has begun, and a random share of its length more; then ends it by a signal.
cut_short() {
    local signal=$1 threads=$2 code=0
    shift 2
    : >"$work/err" # the job truncates it too, but not before the first look below
    "$nacre" "${bake[@]}" --threads "$threads" -o "$work/cut.field" "$@" >"$work/out" 2>"$work/err" &
    local job=$!
    until grep -qE "going on|another bake" "$work/err" || tile_noted; do
        kill -0 $job 2>/dev/null || break
        sleep 0.02
    done
    sleep "$(printf '%d.%03d' 0 $((RANDOM % (capture / 4 + 1) % 1000)))"
    kill -"$signal" $job 2>/dev/null || true
    wait $job 2>/dev/null || code=$?
    return $code
}

resumed=0
for threads in 1 2 3 7; do
    for _ in 1 2 3 4 5; do
        cut_short KILL $threads || true
        [ ! -e "$work/cut.field" ] || break
    done
    if [ ! -e "$work/cut.field" ]; then
        "$nacre" "${bake[@]}" --threads $threads -o "$work/cut.field" >"$work/out" 2>"$work/err" ||
            fail "going on failed"
        resumed=$((resumed + $(jq .tiles.resumed "$work/out")))
    fi
    diff -r "$work/whole.field" "$work/cut.field" || fail "the field differs for $threads threads"
    [ ! -e "$work/cut.field.partial" ] || fail "something was left behind"
    rm -r "$work/cut.field"
done
[ $resumed -gt 0 ] || fail "no tile was ever taken over"

# An interrupt ends with 130, says what is kept, and leaves the earlier field.
cp -r "$work/whole.field" "$work/cut.field"
code=0
cut_short INT 2 || code=$?
if [ $code -ne 0 ]; then
    [ $code -eq 130 ] || fail "an interrupt ended with $code"
    grep -q "finished tiles are kept in $work/cut.field.partial" "$work/err" || fail "nothing was said"
    diff -r "$work/whole.field" "$work/cut.field" || fail "the earlier field has changed"
    "$nacre" "${bake[@]}" --fresh -o "$work/cut.field" >"$work/out" 2>"$work/err" || fail "--fresh failed"
    [ "$(jq .tiles.resumed "$work/out")" -eq 0 ] || fail "--fresh took tiles over"
    diff -r "$work/whole.field" "$work/cut.field" || fail "the fresh field differs"
fi

# Tiles of another bake are not taken, and it is said.
if ! cut_short KILL 2 && [ -e "$work/cut.field.partial/tiles.journal" ]; then
    "$nacre" "${bake[@]}" --seed 5 -o "$work/cut.field" >"$work/out" 2>"$work/err" || fail "the bake failed"
    grep -q "was of another bake" "$work/err" || fail "nothing was said of another bake"
    [ "$(jq .tiles.resumed "$work/out")" -eq 0 ] || fail "tiles of another bake were taken over"
fi
echo "all as it should be"
