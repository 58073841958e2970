#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The report of the shipped scene holds what the project promises (A-54): every light-field row is
# closer to the ray trace than the environment map, by the stated factors, and reconstruction is
# close to exact.   check_report.sh NACRE SOURCE_FOLDER PRESET
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

"$nacre" report data/scenes/gazebo.json --preset "$3" --experiments reconstruction,mirror --repeats 1 \
    --quiet --json -o "$work/r" >"$work/stdout.json"
cmp "$work/stdout.json" "$work/r/report.json"
test -s "$work/r/report.csv"
xmllint --html --noout "$work/r/report.html" 2>/dev/null

# must TEXT JQ_CONDITION
must() {
    if ! jq -e "$2" "$work/r/report.json" >/dev/null; then
        echo "does not hold: $1" >&2
        failures=$((failures + 1))
    fi
}
jq -r '.rows[] | "\(.experiment) \(.method) \(.cube) L* \(.rmse.L)"' "$work/r/report.json"

must "schema, floor and members" '.schema == "nacre.report/1" and .floor.rmse.L >= 0 and
    (.rows | all(has("rmse_clipped") and has("gradient_rmse") and has("max_jump") and has("flip") and
                 has("seconds") and has("bytes") and has("lookups") and has("rays") and has("placement")))'
must "nothing is not finite" '[.rows[] | .rmse[], .flip] | all(. != null)'
for cube in $(jq -r '[.rows[] | select(.method == "envmap") | .cube] | unique | .[]' "$work/r/report.json"); do
    at() { echo "(.rows[] | select(.experiment == \"$1\" and .method == \"$2\" and .cube == $cube) | .rmse.L)"; }
    env=$(at mirror envmap)
    must "every OSLF row below envmap at $cube" "$env as \$e | [.rows[] | select(.experiment == \"mirror\" and
        .cube == $cube and .method != \"envmap\" and .method != \"proxy\") | .rmse.L] | all(. < \$e)"
    must "distance <= 0.65 envmap at $cube" "$(at mirror distance) <= 0.65 * $env"
    must "cosine-n:4 <= 0.60 envmap at $cube" "$(at mirror cosine-n:4) <= 0.60 * $env"
    must "reconstruction <= 2.5 % of envmap at $cube" "$(at reconstruction nearest) <= 0.025 * $env"
done
must "reconstruction improves with the cube" '[.rows[] | select(.method == "nearest")] | sort_by(.cube) |
    map(.rmse.L) | . == (sort | reverse)'
finish
