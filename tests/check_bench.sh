#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The bench: every row runs and agrees with its rivals, and prints what scripts rely on. How fast is
# nobody's business here.   check_bench.sh NACRE SOURCE_FOLDER
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

"$nacre" bench bezier-flaot 2>"$work/err" && fail "an unknown row passes"
grep -q "did you mean bezier-float" "$work/err" || fail "no row is offered: $(cat "$work/err")"
"$nacre" bench --list | grep -q "^mirror-half " || fail "--list lacks a row"

# One row by name.
"$nacre" bench bezier-float --turns 9 --json >"$work/one.json" 2>/dev/null
jq -e '.schema == "nacre.bench/1" and (.results | length == 1)' "$work/one.json" >/dev/null ||
    fail "not one result: $(cat "$work/one.json")"
jq -e '.results[0] | .name == "bezier-float" and .unit == "points/s" and .rate > 0 and
       .error < 1e-4 and .ratio.limit > 0 and .quartiles.limit[0] <= .ratio.limit and
       .ratio.limit <= .quartiles.limit[1]' "$work/one.json" >/dev/null ||
    fail "members are missing or absurd: $(cat "$work/one.json")"

# Every row, on a small scene. Ties between triangles may turn out otherwise in another tree. A peer of
# ggx-chain takes half a minute: that row goes without.
mapfile -t others < <("$nacre" bench --list | cut -d' ' -f1 | grep -v '^ggx-chain$')
"$nacre" bench "${others[@]}" --peers --turns 1 --scene data/scenes/spheres.json --json >"$work/others.json" 2>/dev/null
"$nacre" bench ggx-chain --turns 1 --json >"$work/chain.json" 2>/dev/null
jq -e '.results[0].parts | length == 8 and all(.[]; .error < 1e-4 and .errors.sampled > 100 * .error)' \
    "$work/chain.json" >/dev/null || fail "a level of the chain is off: $(cat "$work/chain.json")"
jq -s '{results: [.[].results[]]}' "$work/others.json" "$work/chain.json" >"$work/all.json"
rows=$("$nacre" bench --list | wc -l)
jq -e --argjson rows "$rows" '(.results | length == $rows) and
       all(.results[]; has("name") and has("unit") and has("ratio") and has("error_of") and
           .rate > 0 and .error >= 0 and .error < 1e-3)' "$work/all.json" >/dev/null ||
    fail "a row is missing or disagrees: $(jq -c '.results[] | [.name, .rate, .error]' "$work/all.json")"
echo "$rows rows agree with their rivals"
finish
