#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# nacre rsibr: maps are written, described, and rendered with; what makes no sense is refused.
#   check_rsibr.sh NACRE SOURCE_FOLDER
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

scene=data/scenes/trio.json
view="--size 117x45 --object-only"

# Refusals.
"$nacre" env --chart --to latlong --size 4 -o "$work/small.exr" -q
expect 2 "MAP is missing" rsibr
expect 2 "-o FOLDER is missing" rsibr $scene
expect 2 "--brdf NAME is missing" rsibr $scene -o "$work/m"
expect 2 'did you mean "lambert"' rsibr $scene -o "$work/m" --brdf lamber
expect 2 "an exponent from 0 to 1e\+06" rsibr $scene -o "$work/m" --brdf phong
expect 2 "13 views: 12, 42, 162 or 642" rsibr "$work/small.exr" -o "$work/m" --brdf mirror --views 13
expect 2 "1 texels" rsibr "$work/small.exr" -o "$work/m" --brdf mirror --size 1
expect 3 "none.exr" rsibr "$work/none.exr" -o "$work/m" --brdf mirror
expect 2 "needs --maps FOLDER" render $scene --method rsibr -o "$work/a.exr"
expect 2 '"mirror" reads no radiance maps' render $scene --method mirror --maps "$work/m" -o "$work/a.exr"
expect 3 "rsibr.json" render $scene --method rsibr --maps "$work/none" -o "$work/a.exr"

# A mirror of twelve eyes is the sky along the mirror direction, up to its texels.
expect 0 "1 maps of 96 x 96 texels for each of 12 eyes" rsibr $scene --brdf mirror:1.5 --size 96 -o "$work/m"
expect 0 "radiance maps for 12 eyes, 96 x 96 texels each, albedo divided out" info "$work/m"
expect 0 "" render $scene --method rsibr --maps "$work/m" $view --term reflect -o "$work/a.exr"
expect 0 "" render $scene --method fresnel:1.5 $view --term reflect -o "$work/b.exr"
"$nacre" compare "$work/b.exr" "$work/a.exr" --json -q >"$work/compare.json"
jq -e '.rmse.L < 4' "$work/compare.json" >/dev/null ||
    fail "rsibr and fresnel differ: $(cat "$work/compare.json")"

# Paint shows all of a surface: a full image has nothing under it, and is its reflection.
expect 0 "3 maps" rsibr $scene --brdf car-paint --size 24 -o "$work/p"
expect 0 "coated .*by normal" info "$work/p"
expect 0 "" render $scene --method rsibr --maps "$work/p" $view --term reflect -o "$work/a.exr"
expect 0 "" render $scene --method rsibr --maps "$work/p" $view -o "$work/b.exr"
cmp -s "$work/a.exr" "$work/b.exr" || fail "full and reflect of rsibr differ"
expect 2 "shows all of a surface" render $scene --method rsibr --maps "$work/p" --recon lambert \
    $view -o "$work/b.exr"
expect 2 "does not reconstruct" render $scene --method rsibr --maps "$work/p" --term recon -o "$work/b.exr"

# A ball of it toward a new eye, warped by pixel and by a disc of triangles, which errs less with more rings.
expect 2 "pixel or disc:RINGS" rsibr "$work/m" --draw 1,2,3 --warp disc:0 -o "$work/d.exr"
expect 2 "expected a direction" rsibr "$work/m" --draw 0,0,0 -o "$work/d.exr"
expect 2 "goes with --draw" rsibr "$work/m" --brdf mirror --warp pixel -o "$work/d.exr"
expect 0 "every pixel warped by itself" rsibr "$work/m" --draw 0.36,-0.48,0.8 --size 80 -o "$work/c.exr"
for rings in 8 32; do
    expect 0 "a disc of $rings rings, off from warping every pixel" rsibr "$work/m" \
        --draw 0.36,-0.48,0.8 --warp disc:$rings --size 80 -o "$work/d.exr" --json
    mv "$work/out" "$work/disc-$rings.json"
done
jq -se '.[0].inner_error.rms > 4 * .[1].inner_error.rms and .[1].inner_error.rms > 0' \
    "$work/disc-8.json" "$work/disc-32.json" >/dev/null ||
    fail "discs: $(cat "$work/disc-8.json" "$work/disc-32.json")"

# Brushed metal has maps by direction of its tangent; where there is none is counted.
expect 2 "roughness along and across" rsibr $scene -o "$work/b" --brdf ggx:0.01,0.5
expect 2 "knows no tangents" rsibr "$work/small.exr" -o "$work/b" --brdf ggx:0.5,0.6 --single
expect 2 "1 directions" rsibr "$work/small.exr" -o "$work/b" --brdf ggx:0.5,0.6 --turns 1
expect 0 "5 maps of 16 x 16" rsibr "$work/small.exr" --brdf ggx:0.5,0.6 --turns 5 --size 16 -o "$work/b"
expect 0 "brushed .*by mirror" info "$work/b"
expect 0 "" render $scene --method rsibr --maps "$work/b" $view -o "$work/a.exr"

# A map file, and a second set over the first.
"$nacre" env --chart --to latlong --size 32 -o "$work/chart.exr" -q
expect 0 "2 maps of 16 x 16" rsibr "$work/chart.exr" --brdf cook-torrance:0.3 --size 16 -o "$work/p"
expect 0 "radiance maps for 12 eyes, 16 x 16" info "$work/p"
[ "$(ls "$work/p" | wc -l)" -eq 3 ] || fail "left over: $(ls "$work/p")"

# A sphere map is a picture of a mirror ball from far away along +z; what it shows comes back.
"$nacre" env --chart --to sphere --size 100 -o "$work/ball.exr" -q
expect 0 "0.0 degrees about the far side" rsibr "$work/ball.exr" --import-ball --circle 50,50,50 \
    --view 0,0,1 --to sphere --size 100 -o "$work/back.exr"
"$nacre" compare "$work/ball.exr" "$work/back.exr" --json -q >"$work/compare.json"
jq -e '.rmse.R < 0.1' "$work/compare.json" >/dev/null || fail "ball: $(cat "$work/compare.json")"
expect 5 "no outline|no ball" rsibr "$work/chart.exr" --import-ball -o "$work/back.exr"
expect 2 "three numbers" rsibr "$work/ball.exr" --import-ball --circle 1,2 -o "$work/back.exr"
expect 2 "of no material" rsibr "$work/ball.exr" --import-ball --brdf mirror -o "$work/back.exr"
expect 2 "0.5 radii" rsibr "$work/ball.exr" --import-ball --circle 50,50,49 --distance 0.5 -o "$work/back.exr"

finish
