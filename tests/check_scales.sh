#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A scene file with every length multiplied, or moved, gives the same picture: the same bytes for a
# power of two, and 1e-5 for the rest.   check_scales.sh NACRE SOURCE_FOLDER      [S-01, A-44, A-56]
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

# Every length of the scene by $f, then everything moved by $m along all axes. Patterns repeat every
# 0.5, so a move by a multiple of 1 leaves them where they are on the floor.
rescale='
def grow: if type == "number" then . * $f elif type == "array" then map(grow) else . end;
def move: map(. * $f + $m);
.materials |= map_values(if has("period") then .period |= grow else . end)
| .objects |= map(
    .shape |= (if has("revolve") then .revolve |= grow else . end
               | if has("quad") then .quad |= map_values(grow) else . end)
    | .place = ((.place // {}) | .translate = ((.translate // [0, 0, 0]) | move)))
| .cameras |= map(.eye |= move | .target |= move)
| .presets.quick += {"epsilon": ($f * 0.0625), "points": 80, "cube": 16, "map": 16, "size": [96, 64]}
| .presets.quick.irradiance += {"spacing": ($f * 0.25), "rays": 16, "bounces": 2}'

# jq writes 2^100 as an integer, which is more than the reader takes for one.
make_real() { sed -E 's/(^|[^.0-9e])([0-9]{18,})(,?)$/\1\2.0\3/'; }

# picture NAME FACTOR MOVE: renders NAME-field.exr and NAME-trace.exr
picture() {
    jq --argjson f "$2" --argjson m "$3" "$rescale" data/scenes/spheres.json | make_real >"$work/$1.json"
    "$nacre" bake "$work/$1.json" --preset quick --float -q -o "$work/$1.field"
    "$nacre" render "$work/$1.json" --preset quick --field "$work/$1.field" --method cosine-n:4 \
        -q -o "$work/$1-field.exr"
    "$nacre" render "$work/$1.json" --preset quick --method trace -q -o "$work/$1-trace.exr"
}

same_bytes() {
    cmp "$work/plain-$2.exr" "$work/$1-$2.exr" || failures=$((failures + 1))
}

# The root mean square of the difference, over the largest channel.
nearly_same() {
    local rmse
    rmse=$("$nacre" compare "$work/plain-$2.exr" "$work/$1-$2.exr" --json -q |
        jq '[.rmse.R, .rmse.G, .rmse.B] | max')
    echo "$1 $2: RMSE $rmse"
    jq -ne "$rmse <= 1e-5" >/dev/null || fail "^ above 1e-5"
}

two_to_100=1267650600228229401496703205376
two_to_minus_100=7.8886090522101180541e-31
picture plain 1 0
picture large $two_to_100 0
picture small $two_to_minus_100 0
picture huge 1e30 0
picture tiny 1e-30 0
picture away 1 1e6
for image in field trace; do
    same_bytes large $image
    same_bytes small $image
    for name in huge tiny away; do
        nearly_same $name $image
    done
done
finish
