#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What docs/command.md claims of each rule of a plan: at the setting stated there, on a shipped scene,
# it saves a tenth of all rays that a bake traces, or of all bytes that it writes; --force brings them
# back; and nothing that is left out is missed.   check_savings.sh NACRE SOURCE_FOLDER        [Z-02 Z-03 Z-06 Z-07]
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

# bake FORCED arguments...: rays traced and bytes written, of light, shadows, views and maps
bake() {
    "$nacre" bake data/scenes/spheres.json --preset quick --json --quiet --force "$1" -o "$work/field" "${@:2}" \
        >"$work/bake.json"
    jq -r '"\(.rays) \(.bytes)"' "$work/bake.json"
}

# claim RULE rays|bytes FORCED arguments...: with these parts and the rule's forced, and without the latter
claim() {
    local rule=$1 what=$2 forced=$3 whole thin full rest
    shift 3
    full=$(bake "$forced,$rule" "$@")
    rest=$(bake "$forced" "$@")
    case $what in
    rays) whole=${full% *} thin=${rest% *} ;;
    bytes) whole=${full#* } thin=${rest#* } ;;
    esac
    awk -v rule="$rule" -v what="$what" -v whole="$whole" -v thin="$thin" 'BEGIN {
        printf "%-7s %.1f %% of %d %s\n", rule, 100 * (whole - thin) / whole, whole, what
        exit thin > 0.9 * whole }' || failures=$((failures + 1))
    # The plan says so itself, names what would tell of a mistake, and nothing does.
    jq -e --arg rule "$rule" --arg what "$what" '.omitted | length == 1 and (.[0] | .part == $rule and
        .bound == 0 and .refuted == 0 and (if $what == "rays" then .ray_share else .byte_share end) >= 0.1 and
        (.counter | IN("trapped", "missed_distances", "refuted")))' "$work/bake.json" >/dev/null ||
        fail "$rule: $(jq -c .omitted "$work/bake.json")"
    "$nacre" render data/scenes/spheres.json --preset quick --field "$work/field" --method cosine-n:4 --json --quiet \
        --size 96x64 -o "$work/image.exr" "${looks[@]}" | jq -e '.trapped == 0 and .missed_distances == 0' >/dev/null ||
        failures=$((failures + 1))
}

looks=()
claim tiles rays mirror,depth,sight --for cosine-n:4,nearest --camera main
claim depth bytes tiles,mirror,sight
claim sight rays tiles,mirror,depth --map 256
looks=(--object ball)
claim mirror rays depth,sight --object ball --for cosine-n:4,nearest
finish
