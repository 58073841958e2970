#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The same bytes from any number of workers, twice in a row, with and without the processor's wide
# instructions as far as that is promised, and from two compilers.            [S-73, A-32, A-102]
#   check_same_bytes.sh BUILD [OTHER_BUILD [SCENE]]
set -euo pipefail
cd "$(dirname "$0")/.."
first=$(realpath "$1/apps/nacre")
other=${2:+$(realpath "$2/apps/nacre")}
scene=${3:-data/scenes/spheres.json} # without files beside it
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

jq '.presets.quick.irradiance += {"rays": 16, "bounces": 3, "spacing": 0.2}' "$scene" >"$work/scene.json"
scene=$work/scene.json

# make NAME NACRE THREADS: a field, pictures by several methods, and their error, under $work/NAME
make() {
    local out=$work/$1 nacre=$2
    mkdir -p "$out"
    "$nacre" bake "$scene" --preset quick --points 60 --cube 16 -q --threads "$3" -o "$out/field"
    for method in trace proxy cosine-n:4; do
        "$nacre" render "$scene" --preset quick --field "$out/field" --method $method -q --threads "$3" \
            --size 96x67 -o "$out/${method%:*}.exr"
    done
    "$nacre" compare "$out/trace.exr" "$out/cosine-n.exr" --json -q --threads "$3" |
        jq 'del(.reference, .image, .seconds)' >"$out/error.json"
}

# same NAME FILE...: as those of "one"
same() {
    local name=$1
    shift
    for file in "$@"; do
        diff -r "$work/one/$file" "$work/$name/$file" >/dev/null ||
            { echo "$file of $name is not that of one worker" >&2; failures=$((failures + 1)); }
    done
    rm -rf "${work:?}/$name"
}
everything=(field trace.exr proxy.exr cosine-n.exr error.json)

make one "$first" 1
for threads in 1 2 3 7 16 64; do
    make "$threads-threads" "$first" $threads
    same "$threads-threads" "${everything[@]}"
done
if [ -n "$other" ]; then
    make other-build "$other" 2
    same other-build "${everything[@]}"
fi
# Rays are traced by other code on each level; which points a texel gets does not depend on it.
for level in generic avx2 avx512; do
    NCR_CPU=$level make $level "$first" 2
    same $level field/charts.bin field/maps-0.png
done
[ $failures -eq 0 ] && echo "all the same"
exit $((failures > 0))
