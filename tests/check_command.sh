#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The command's manners: exit codes, sentences, JSON members, nothing written on failure, and the
# path bake -> render -> compare -> info on a small scene.   check_command.sh NACRE SOURCE_FOLDER
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

# member FILE PATH...: the JSON file has these members (dots descend)
member() {
    local file=$1
    shift
    for path in "$@"; do
        jq -e "getpath(\"$path\" | split(\".\")) != null" "$file" >/dev/null ||
            fail "$file: no $path"
    done
}

scene=data/scenes/spheres.json

# Usage.
expect 2 "unknown verb bakee; did you mean bake" bakee
expect 2 "unknown option --pionts; did you mean --points" bake $scene -o "$work/f" --pionts 3
expect 2 "SCENE is missing" bake
expect 2 "-o FIELD is missing" bake $scene
expect 2 "one word too many" info a b
expect 2 "no check is called tise; did you mean ties" check tise
expect 2 "--points x: expected a whole number" bake $scene -o "$work/f" --points x
expect 2 "--size 3: expected a size" render $scene --method trace -o "$work/a.png" --size 3
expect 2 "did you mean .cosine-" render $scene --method cosine-m:4 -o "$work/a.png"
expect 2 "did you mean reflect" render $scene --method trace --term reflct -o "$work/a.png"
expect 2 "exclude each other" bake $scene -o "$work/f" --half --float
expect 2 "--object|no such object" bake $scene -o "$work/f" --object nothing
expect 2 "camera" render $scene --method trace --camera nowhere -o "$work/a.png"
expect 2 "preset" bake $scene -o "$work/f" --preset quik
for verb in bake render compare report env info check; do
    "$nacre" $verb --help | grep -q "^example:" || fail "$verb --help"
done

# Files.
expect 3 "no/such" bake no/such.json -o "$work/f"
expect 3 "no/such" compare no/such.png no/other.png
expect 3 "no such" info no/such.exr
echo '{ "nacre": 1, ' >"$work/broken.json"
expect 4 "broken.json:[0-9]+:[0-9]+" bake "$work/broken.json" -o "$work/f"
echo '{ "nacre": 1, "objets": [] }' >"$work/member.json"
expect 4 "objets.*objects" bake "$work/member.json" -o "$work/f"
echo 'nacre patches 1
points 1
0 0 nan
' >"$work/bad.patches"
expect 4 "bad.patches:3" info "$work/bad.patches"
echo 'not an image' >"$work/a.exr"
expect 4 "a.exr" info "$work/a.exr"
expect 3 "" render $scene --preset quick --method trace -o "$work/no/such/folder/a.png"
expect 5 "--memory" bake $scene --preset quick -o "$work/f" --memory 1000
[ ! -e "$work/f" ] && [ ! -e "$work/f.partial" ] || fail "a failed bake left something"

# The path, in light that costs little, on small images.
jq '.presets.quick += {"irradiance": {"rays": 4, "bounces": 1, "spacing": 0.5}, "size": [82, 57]}' $scene \
    >"$work/scene.json"
scene=$work/scene.json

expect 0 "points" bake $scene --preset quick -o "$work/s.field" --json
cp "$work/out" "$work/bake.json"
member "$work/bake.json" schema object points patches texels texels_short_of_four texels_uncovered bytes \
    seconds.place seconds.maps seconds.plan seconds.capture seconds.write seconds.total rays omitted coverage
expect 0 "field of object" info "$work/s.field" --verify
for method in trace envmap proxy distance angle average cosine-r:4 cosine-n:4 abs-r:4; do
    expect 0 "pixels" render $scene --preset quick --field "$work/s.field" --method $method \
        --term reflect --object-only -o "$work/${method%:*}.exr" --mask "$work/mask.png" --json
done
cp "$work/out" "$work/render.json"
member "$work/render.json" schema method term pixels shaded seconds.gbuffer seconds.shade seconds.total \
    lookups rays fallbacks trapped missed_distances
for method in nearest average4; do
    expect 0 "pixels" render $scene --preset quick --field "$work/s.field" --method $method \
        --term recon --object-only -o "$work/$method.exr"
done
expect 0 "RMSE" compare "$work/trace.exr" "$work/cosine-n.exr" --mask "$work/mask.png" --json
cp "$work/out" "$work/compare.json"
member "$work/compare.json" schema pixels nonfinite rmse.R rmse.G rmse.B rmse.L rmse.a rmse.b \
    rmse_clipped.R gradient_rmse max_jump max_abs flip
expect 0 "RMSE  L\* 0.0000" compare "$work/trace.exr" "$work/trace.exr" --max-rmse 0.001
expect 1 "RMSE" compare "$work/trace.exr" "$work/envmap.exr" --mask "$work/mask.png" --max-rmse 0.001
expect 2 "field" render $scene --preset quick --method angle -o "$work/a.png"

# Distant light: the sky, a map, a probe.
for method in mirror fresnel:1.5 "prefiltered --lobe phong:20" "fresnel:2 --lobe ggx:0.3" "mirror --env probe"; do
    expect 0 "pixels" render $scene --preset quick --method $method --object-only -o "$work/far.exr"
done
expect 0 "pixels" render $scene --preset quick --method lambert --term recon --object-only -o "$work/far.exr"
expect 0 "" env --chart -o "$work/chart.exr" --size 32
expect 0 "pixels" render $scene --preset quick --method mirror --env "$work/chart.exr" --object-only -o "$work/far.png"
expect 0 "pixels" render $scene --preset quick --method trace --env "$work/chart.exr" -o "$work/lit.exr"
expect 1 "RMSE" compare "$work/trace.exr" "$work/lit.exr" --max-rmse 5
expect 0 "pixels" render $scene --preset quick --method prefiltered --lobe phong:50 --filter two-radii --object-only \
    -o "$work/far.exr"
expect 2 "did you mean hierarchical" render $scene --preset quick --method prefiltered --lobe phong:5 --filter hierachical \
    -o "$work/a.png"
for method in lobe-average:1e6 lobe-angle:1.5 lobe-sum:1.5; do
    expect 0 "pixels" render $scene --preset quick --method $method --lobe ggx:0.3 --term reflect --object-only \
        -o "$work/far.exr"
done
expect 2 "needs a lobe of GGX" render $scene --preset quick --method lobe-sum:2 --lobe lambert -o "$work/a.png"
for method in npr-outline:3 npr-window; do
    expect 0 "pixels" render $scene --preset quick --method $method --object-only -o "$work/far.png"
done
expect 2 "not in \[0.5, 16\]" render $scene --preset quick --method npr-outline:99 -o "$work/a.png"
expect 2 "only Phong" render $scene --preset quick --method prefiltered --lobe ggx:0.2 --filter two-radii -o "$work/a.png"
expect 2 "needs a lobe" render $scene --preset quick --method prefiltered -o "$work/a.png"
expect 2 "did you mean phong" render $scene --preset quick --method prefiltered --lobe fong:3 -o "$work/a.png"
expect 2 "expected ggx:NUMBER" render $scene --preset quick --method prefiltered --lobe ggx -o "$work/a.png"
expect 2 "does not read distant" render $scene --preset quick --method distance --env "$work/chart.exr" -o "$work/a.png"
expect 3 "" render $scene --preset quick --method mirror --env "$work/none.exr" -o "$work/a.png"

# What a plan leaves out is not missed by what it was made for.
expect 2 "did you mean .nearest" bake $scene -o "$work/f" --for neerest
expect 2 "did you mean tiles" bake $scene -o "$work/f" --for nearest --force tile
expect 2 "none of the methods reads a field" bake $scene -o "$work/f" --for envmap
expect 2 "camera" bake $scene -o "$work/f" --camera mian
expect 0 "left out  tiles" bake $scene --preset quick --for cosine-n:4,nearest --camera main --explain --json
jq -e '.tiles.captured == 0 and .omitted[0].part == "tiles" and .omitted[0].bound == 0' "$work/out" >/dev/null ||
    failures=$((failures + 1))
expect 0 "left out  tiles" bake $scene --preset quick --for cosine-n:4,nearest --camera main --explain --json \
    -o "$work/p.field"
cp "$work/out" "$work/plan.json"
jq -e '.tiles.omitted * 6 * 32 * 32 / 6 == .omitted[0].saved_rays and .tiles.omitted * 2 > .tiles.captured' \
    "$work/plan.json" >/dev/null || failures=$((failures + 1))
jq -e --argjson whole "$(jq .rays "$work/bake.json")" --argjson light 0 \
    '$whole - .rays >= .omitted[0].saved_rays' "$work/plan.json" >/dev/null || failures=$((failures + 1))
for field in s p; do
    expect 0 "pixels" render $scene --preset quick --field "$work/$field.field" --method cosine-n:4 --json \
        --object-only -o "$work/of-$field.exr"
    jq -e '.trapped == 0' "$work/out" >/dev/null || failures=$((failures + 1))
done
cmp "$work/of-s.exr" "$work/of-p.exr" || failures=$((failures + 1))
expect 0 "left out" info "$work/p.field" --verify
expect 0 "plan: for nearest" bake $scene --preset quick --for nearest --camera main --explain -o "$work/n.field"
expect 0 "look-ups met tiles" render $scene --preset quick --field "$work/n.field" --method angle --term reflect \
    --object-only -o "$work/trap.exr"
expect 0 "kept      tiles   forced" bake $scene --preset quick --for nearest --camera main --force tiles \
    --explain -o "$work/q.field"
cmp "$work/s.field/radiance.exr" "$work/q.field/radiance.exr" || failures=$((failures + 1))

# A convex object needs no rays to find which points its texels see; the maps are the same.
expect 0 "left out  sight" bake $scene --preset quick --for cosine-n:4,nearest --camera main --explain --json \
    -o "$work/c.field"
cp "$work/out" "$work/convex.json"
jq -e '[.omitted[].part] == ["tiles", "depth", "sight"] and all(.omitted[]; .refuted == 0 and .bound == 0) and
    (.omitted[2] | .saved_rays * 10 > .of_rays)' "$work/convex.json" >/dev/null || failures=$((failures + 1))
jq -e '(.coverage | length) == .patches and .texels == ([.coverage[].texels] | add) and
    .texels_short_of_four == ([.coverage[].short_of_four] | add) and
    all(.coverage[]; has("buried") and has("uncovered") and has("violating_free_space"))' "$work/convex.json" \
    >/dev/null || failures=$((failures + 1))
expect 0 "kept      sight   forced" bake $scene --preset quick --force all --explain --json -o "$work/a.field"
jq -e --slurpfile thin "$work/convex.json" '.omitted == [] and .coverage == $thin[0].coverage' "$work/out" \
    >/dev/null || failures=$((failures + 1))
for field in c a; do
    expect 0 "pixels" render $scene --preset quick --field "$work/$field.field" --method cosine-n:4 --json \
        -o "$work/of-$field.exr"
    jq -e '.trapped == 0' "$work/out" >/dev/null || failures=$((failures + 1))
done
cmp "$work/of-c.exr" "$work/of-a.exr" || failures=$((failures + 1))
expect 0 "kept      sight   the object is not convex" bake data/scenes/room.json --preset quick --explain

# A field larger than the memory allowed gives the same bytes.
expect 0 "light from the file" render $scene --preset quick --field "$work/s.field" --method cosine-n:4 \
    --memory 1000000 --object-only --json -o "$work/streamed.exr"
cp "$work/out" "$work/streamed.json"
member "$work/streamed.json" cache.bytes cache.faces cache.hits cache.misses cache.bytes_read
expect 0 "pixels" render $scene --preset quick --field "$work/s.field" --method cosine-n:4 \
    --object-only -o "$work/whole.exr"
cmp "$work/streamed.exr" "$work/whole.exr" || failures=$((failures + 1))
jq -e '.cache.bytes <= 1000000 and .cache.misses > 0' "$work/streamed.json" >/dev/null || failures=$((failures + 1))
expect 5 "bytes of memory are too few" render $scene --preset quick --field "$work/s.field" \
    --method cosine-n:4 --memory 1000 -o "$work/a.png"

# Checks.
expect 0 "0 failed" check cielab weights --json
member "$work/out" schema measured failed rows
expect 0 "curvature" check curvature --scene $scene --threads 2

# A report holds every table and figure that the thesis has of this, in rows that belong together.
expect 0 "report.html" report $scene --preset quick --repeats 1 -o "$work/all.report"
for part in "Table 6.1" "Table 6.2" "Figure 3.2" "Figures 3.3 to 3.5" "Figures 4.1 to 4.3" "Figure 4.4" "Figure 4.5" \
    "Figure 4.6" "Figure 6.1" "Figure 6.3" "occlusion test" "Registration" "recursion"; do
    grep -q "$part" "$work/all.report/report.html" || fail "the report lacks $part"
done
jq -e '[.rows[].experiment] | unique == (["epsilon", "horizon", "mirror", "occlusion", "reconstruction", "recursion",
    "registration"] | unique)' "$work/all.report/report.json" >/dev/null || failures=$((failures + 1))
jq -e '[.rows[] | select(.experiment == "occlusion") | .method] | length == 6 and
    (map(select(endswith("on"))) | length == 3)' "$work/all.report/report.json" >/dev/null || failures=$((failures + 1))

# Nor does a report with little memory differ in anything but its times.
for memory in 1000000000 1500000; do
    expect 0 "report.html" report $scene --preset quick --repeats 1 --experiments reconstruction --memory $memory \
        -o "$work/report.$memory"
    jq '[.rows[] | del(.seconds)]' "$work/report.$memory/report.json" >"$work/rows.$memory"
done
cmp "$work/rows.1000000000" "$work/rows.1500000" || failures=$((failures + 1))
grep -q "light on disk" "$work/report.1500000/report.html" || failures=$((failures + 1))
[ ! -e "$work/report.1500000/light-32.field" ] || failures=$((failures + 1))

# A damaged field is noticed.
cp -r "$work/s.field" "$work/t.field"
printf 'x' | dd of="$work/t.field/charts.bin" bs=1 seek=9 conv=notrunc status=none
expect 4 "charts.bin" info "$work/t.field" --verify
truncate -s -100 "$work/t.field/radiance.exr"
expect 4 "t.field" info "$work/t.field"

finish
