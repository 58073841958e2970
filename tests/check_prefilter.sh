#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# nacre prefilter: tolerances kept or refused, files that read back, what is said of lights, ringing
# and energy.   check_prefilter.sh NACRE
. "$(dirname "$0")/prelude.sh"
begin "$1"

map=$work/map.exr
"$nacre" env --chart --to latlong --size 64 -o "$map" -q

# Words.
expect 2 "MAP is missing" prefilter -o "$work/a.exr"
expect 2 "-o OUT is missing" prefilter "$map"
expect 2 "did you mean lambert" prefilter "$map" --lobe lambret -o "$work/a.exr"
expect 2 "expected phong:NUMBER" prefilter "$map" --lobe phong -o "$work/a.exr"
expect 2 "exclude each other" prefilter "$map" --float --rgb9e5 -o "$work/a.ktx2"
expect 2 "expected phong:NUMBER" prefilter "$map" --lobe phong:-1 -o "$work/a.exr"
expect 2 "expected ggx:NUMBER" prefilter "$map" --lobe ggx:9 -o "$work/a.exr"
expect 2 "takes no number" prefilter "$map" --lobe lambert:1 -o "$work/a.exr"
expect 2 "depends on the eye" prefilter "$map" --lobe cook-torrance:.3 -o "$work/a.exr"
expect 2 "--eta goes with --view" prefilter "$map" --eta 1.5 -o "$work/a.exr"
expect 2 "expected a direction" prefilter "$map" --view 0,0,0 -o "$work/a.exr"
expect 2 "expected none, hann or lanczos" prefilter "$map" --window hamm -o "$work/a.exr"
expect 2 "levels go into one .ktx2 file" prefilter "$map" --lobe chain -o "$work/a.exr"
expect 2 "go with --lobe chain" prefilter "$map" --levels 4 -o "$work/a.exr"
expect 2 "did you mean cube" prefilter "$map" --kind cub -o "$work/a.exr"
expect 3 "No such" prefilter "$work/no.exr" -o "$work/a.exr"
expect 3 "" prefilter "$map" -o "$work/no/such/folder/a.exr"
[ ! -e "$work/a.exr" ] || fail "a refused prefilter left a file"

# Every lobe into every kind keeps its tolerance, and the bound is one.
kinds=(cube octahedral latlong sphere paraboloid)
k=0
for lobe in lambert phong:0 phong:20.5 ggx:0.3 ggx:1 beckmann:0.4; do
    expect 0 "largest error" prefilter "$map" --lobe $lobe --kind ${kinds[$((k++ % 5))]} --json -o "$work/a.exr"
    holds '.schema == "nacre.prefilter/1" and .met'
    holds '.levels[0].error <= 1e-3 * .in.mean'
    holds '.levels[0].error <= .levels[0].bound + .levels[0].texel_error * .in.mean'
    holds '.probes.count >= 16 and .seconds.analyse >= 0 and .levels[0].size >= 8'
done
expect 0 "" prefilter "$map" --lobe phong:30 --tolerance 1e-5 --probes 40 --seed 7 --json -o "$work/fine.exr"
holds '.levels[0].error <= 1e-5 * .in.mean and .probes.count == 40 and .probes.seed == 7'
expect 0 "cube map by the convention nacre" info "$work/fine.exr"

# What a tolerance cannot have is said, and the exit code says it.
expect 5 "above the tolerance" prefilter "$map" --order 2 --lobe phong:50 --json -o "$work/a.exr"
holds '.met == false and .levels[0].met == false'
expect 5 "sharper than the texels" prefilter "$map" --lobe phong:1000000 -o "$work/a.exr"

expect 0 "summed" prefilter "$map" --lobe phong:0 --size 8 --tolerance 1e-4 --json -o "$work/a.exr"
holds '.met and .levels[0].order == null'

# A map of one light in the dark: peeled, and its energy told; else it rings.
sun=$work/sun.hdr
{
    printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n'
    for ((k = 0; k < 32 * 64; k++)); do
        if [ $k -eq 850 ]; then printf '\xc8\xc8\xc8\x92'; else printf '\x40\x40\x40\x80'; fi
    done
} >"$sun"
expect 0 "1 light of" prefilter "$sun" --from latlong --lobe phong:40 --json -o "$work/a.exr"
holds '(.lights | length) == 1 and .lights[0].solid_angle > 0 and .moved[0] > 0'
holds '(.moved[0] - .lights[0].power[0] | fabs) <= 1e-6 * .moved[0]'
lit=$(jq .levels[0].order "$work/out")
expect 0 "left out" prefilter "$sun" --from latlong --lobe phong:40 --lights-apart --json -o "$work/dark.exr"
expect 0 "" prefilter "$sun" --from latlong --lobe phong:40 --no-peel --json -o "$work/a.exr"
holds "(.lights | length) == 0 and .levels[0].order > $lit"

# Ringing: counted, or removed and its energy told; less of it with a window.
expect 5 "values are below 0" prefilter "$sun" --from latlong --no-peel --order 4 --lobe phong:200 --json -o "$work/a.exr"
holds '.levels[0].negative > 0 and .levels[0].added == 0'
expect 5 "are now 0, which adds" prefilter "$sun" --from latlong --no-peel --order 4 --lobe phong:200 --positive --json -o "$work/a.exr"
holds '.levels[0].negative == 0 and .levels[0].clamped > 0 and .levels[0].added > 0'
expect 0 "" prefilter "$sun" --from latlong --harmonics --json
plain=$(jq .harmonics.ringing "$work/out")
holds '(.harmonics.irradiance | length) == 9 and .harmonics.window == "none" and .harmonics.bound > 0'
expect 0 "" prefilter "$sun" --from latlong --harmonics --window lanczos --json
holds ".harmonics.ringing < $plain"

# A chain: one file with levels, or a file for each.
expect 0 "mirror" prefilter "$map" --lobe chain --levels 5 --size 32 --json -o "$work/chain.ktx2"
holds '[.levels[].size] == [32, 16, 8, 4, 2] and .levels[0].lobe == "mirror" and .levels[4].parameter == 1'
expect 0 "5 levels" info "$work/chain.ktx2"
expect 0 "" prefilter "$map" --lobe chain --levels 3 --same-size --size 8 -o "$work/level-#.hdr"
for k in 0 1 2; do
    expect 0 "image 8x48" info "$work/level-$k.hdr"
done

# The table that goes with a chain: in an even room scale and bias are the albedo, and the third makes it 1.
expect 0 "single scattering" prefilter --split-sum ggx --size 16 --json -o "$work/table.exr"
holds '.split_sum.size == 16 and .split_sum.least_albedo > 0.3 and .split_sum.least_albedo < 0.7'
read -r scale bias lost < <(oiiotool "$work/table.exr" --crop 1x1+8+12 --printstats | sed -n 's/.*Stats Avg: *\(.*\) (float).*/\1/p') ||
    true
awk -v s="$scale" -v b="$bias" -v l="$lost" 'BEGIN { e = (s + b) * (1 + l) - 1; exit !(s > 0 && b > 0 && e * e < 1e-10) }' ||
    { echo "the table does not give back all light: $scale $bias $lost" >&2; failures=$((failures + 1)); }
expect 2 "expected ggx or beckmann" prefilter --split-sum phong -o "$work/t.exr"
expect 2 "takes no MAP" prefilter "$map" --split-sum ggx -o "$work/t.exr"

# One eye.
expect 0 "rms over rms" prefilter "$map" --view 0,-1,0.3 --lobe cook-torrance:0.3 --eta 1.5 --json -o "$work/a.exr"
holds '.levels[0].nrmse <= 1e-3 and .met'
expect 0 "rms over rms" prefilter "$map" --view 0,-1,0.3 --lobe ggx:0.5 --kind sphere -o "$work/a.exr"

# The same bytes for any number of workers.
for threads in 1 3; do
    "$nacre" prefilter "$map" --lobe ggx:0.2 --threads $threads -q -o "$work/w$threads.exr"
done
cmp "$work/w1.exr" "$work/w3.exr" || failures=$((failures + 1))

finish
