#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# nacre env: what it writes says how it lies, other tools read it the way it says, and what it is not
# told it does not guess.   check_env.sh NACRE SOURCE_FOLDER
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"

# same A B LIMIT: the root mean square of the difference of the values is at most LIMIT
same() {
    "$nacre" compare "$1" "$2" --json -q >"$work/compare.json"
    jq -e ".rmse | .R <= $3 and .G <= $3 and .B <= $3" "$work/compare.json" >/dev/null ||
        fail "$1 and $2 differ: $(jq -c .rmse "$work/compare.json")"
}

# Refusals.
expect 2 "IN is missing" env
expect 2 "-o OUT is missing" env a.exr
expect 2 "takes no IN" env a.exr --chart -o "$work/a.png"
expect 2 "did you mean latlong" env --chart --to latlon -o "$work/a.png"
expect 2 "did you mean vcross" env --chart --convention vcros -o "$work/a.png"
expect 2 "says nothing of cube maps, but of latlong" env --chart --convention usd -o "$work/a.png"
expect 2 "--up x: expected y or z" env --chart --up x -o "$work/a.png"
expect 3 "none.exr" env "$work/none.exr" -o "$work/a.png"
expect 2 "extension must be" env --chart -o "$work/a.tiff"
expect 2 "only .ktx2 holds levels" env --chart --mips -o "$work/a.exr"
expect 2 "exclude each other" env --chart --half --rgb9e5 -o "$work/a.ktx2"

# A chart goes through every exact cube convention and back without changing a bit.
expect 0 "cube map of size 64" env --chart --size 64 -o "$work/chart.exr"
for convention in opengl ktx strip hstrip hcross vcross oiio; do
    expect 0 "convention $convention" env "$work/chart.exr" --convention $convention -o "$work/c.exr"
    expect 0 "changed by 0 %" env "$work/c.exr" -o "$work/back.exr"
    same "$work/chart.exr" "$work/back.exr" 0
    expect 0 "cube map by the convention $convention" info "$work/c.exr"
done
expect 0 "sixfiles" env "$work/chart.exr" --convention sixfiles -o "$work/face-%.exr"
expect 0 "sixfiles" env "$work/face-%.exr" --from sixfiles -o "$work/back.exr"
same "$work/chart.exr" "$work/back.exr" 0

# A world with y up, and the same world with z up again.
expect 0 "" env "$work/chart.exr" --up y -o "$work/up.exr"
expect 0 "\+x, \+z, -y of a world with z up" info "$work/up.exr"
expect 0 "" env "$work/up.exr" -o "$work/back.exr"
same "$work/chart.exr" "$work/back.exr" 0

# Every kind, in every format, says what it is.
for kind in cube octahedral latlong sphere paraboloid; do
    for format in exr hdr png ktx2; do
        expect 0 "$kind map of size 48" env "$work/chart.exr" --to $kind --size 48 -o "$work/k.$format"
        expect 0 "$kind map by the convention nacre" info "$work/k.$format" --json
        jq -e ".map.kind == \"$kind\"" "$work/out" >/dev/null || fail "$kind $format: no map in --json"
    done
done
expect 0 "" env "$work/chart.exr" --to latlong -o "$work/l.exr" --json
jq -e '.schema == "nacre.env/2" and .negative == 0 and .nonfinite == 0 and .out.size == 128 and
       (.energy_out[0] / .energy_in[0] - 1 | fabs) < 0.01' "$work/out" >/dev/null ||
    fail "env --json: $(cat "$work/out")"

# KTX 2: cubes with levels, whose storing error is stated.
for store in half float rgb9e5; do
    expect 0 "7 levels" env "$work/chart.exr" --mips --up y --$store -o "$work/cube.ktx2" --json
    jq -e ".levels == 7 and .stored.clamped == 0 and
           .stored.worst <= {half: 4.9e-4, float: 0, rgb9e5: 0.00196}.$store" "$work/out" >/dev/null ||
        fail "env --$store: $(cat "$work/out")"
    expect 0 "its x, y, z are \+x, \+z, -y of a world with z up" info "$work/cube.ktx2"
    expect 0 "" env "$work/cube.ktx2" -o "$work/back.exr"
    same "$work/chart.exr" "$work/back.exr" 0.002
    if command -v file >/dev/null; then
        file "$work/cube.ktx2" | grep -q "KTX2 texture, 64 x 64, 6 faces, 7 mipmaps" ||
            fail "file(1): $(file "$work/cube.ktx2")"
    fi
done

# A light of glTF: levels of six faces, nine coefficients of irradiance, the loss by packing told.
for light in light.glb light.gltf; do
    expect 0 "3 levels of GGX" env "$work/chart.exr" -o "$work/$light" --json
    jq -e '.levels == 3 and .out.convention == "gltf" and .packed.clamped == 0 and .packed.rms < 0.01 and
           .energy_in[0] > 0' "$work/out" >/dev/null || fail "env -o $light: $(cat "$work/out")"
    cp "$work/out" "$work/said"
    expect 0 "light of glTF" info "$work/$light" --json
    jq -e --slurpfile said "$work/said" '.kind == "gltf light" and .levels == 3 and .size == 64 and
        (.mean[0] * 12.566370614 / $said[0].energy_in[0] - 1 | fabs < 1e-3)' "$work/out" >/dev/null ||
        fail "info $light: $(cat "$work/out")"
done
jq -e '.extensions.EXT_lights_image_based.lights[0] | .specularImageSize == 64 and
       (.specularImages | length == 3 and all(length == 6)) and
       (.irradianceCoefficients | length == 9 and all(length == 3))' "$work/light.gltf" >/dev/null ||
    fail "light.gltf: $(head -c 400 "$work/light.gltf")"
# c00 = pi Y00 int L: the integral over the sphere is what --json said
jq -e --slurpfile said "$work/said" '.extensions.EXT_lights_image_based.lights[0].irradianceCoefficients[0] as $c |
       [range(3)] | all($c[.] / ($said[0].energy_in[.] * 0.886226925) - 1 | fabs < 1e-3)' "$work/light.gltf" \
    >/dev/null || fail "light.gltf: the first coefficient is not the mean"
expect 2 "its own layout" env "$work/chart.exr" --up y -o "$work/a.glb"
expect 2 "a power of two, at least 32" env "$work/chart.exr" --size 48 -o "$work/a.glb"

# An image that says nothing is read as told, or not at all.
cp "$work/l.exr" "$work/mute.exr"
if command -v oiiotool >/dev/null; then
    oiiotool "$work/l.exr" --eraseattrib "ImageDescription" --eraseattrib "comments" -o "$work/mute.exr"
    expect 2 "does not say how it lies.*--from" env "$work/mute.exr" -o "$work/a.exr"
    expect 0 "convention oiio" env "$work/mute.exr" --from oiio -o "$work/a.exr"
    expect 0 "latlong map of size 128 by the convention nacre" env "$work/mute.exr" --from latlong -o "$work/a.exr"
    expect 2 "several kinds|KIND:nacre" env "$work/mute.exr" --from nacre -o "$work/a.exr"
    expect 4 "no paraboloid map|no cube map|should be as" env "$work/mute.exr" --from hcross -o "$work/a.exr"

    # What OpenImageIO finds at a place of the chart: the colour of a face, or the bar along its top.
    shows() { # FILE X Y +x|-x|+y|-y|+z|-z|bar
        oiiotool "$1" --cut "2x2+$2+$3" --printstats | awk -v want="$4" '
            /Stats Avg/ {
                r = $3; g = $4; b = $5
                most = r > g ? (r > b ? r : b) : g > b ? g : b
                axis = r == most ? "x" : g == most ? "y" : "z"
                seen = (r < g ? r : g) > 0.5 ? "bar" : (most > 0.35 ? "+" : "-") axis
            }
            END { if (seen != want) { print seen; exit 1 } }' >"$work/seen" ||
            fail "$1 shows $(cat "$work/seen") at $2 $3, not $4"
    }
    while read -r kind x y want; do
        for format in exr hdr; do
            [ -e "$work/$kind.$format" ] ||
                "$nacre" env --chart --to "$kind" --size 256 -q -o "$work/$kind.$format"
            shows "$work/$kind.$format" "$x" "$y" "$want"
        done
    done <<EOF
cube 33 33 +x
cube 17 125 bar
cube 33 289 -x
cube 233 381 bar
cube 33 545 +y
cube 125 745 bar
cube 33 801 -y
cube 125 785 bar
cube 33 1057 +z
cube 125 1041 bar
cube 33 1313 -z
cube 125 1297 bar
latlong 1 89 +x
latlong 125 89 +y
latlong 253 89 -x
latlong 381 89 -y
latlong 125 69 bar
latlong 1 43 +z
latlong 1 212 -z
sphere 125 61 +y
sphere 193 125 +x
sphere 61 125 -x
sphere 125 193 -y
sphere 125 83 bar
paraboloid 125 49 +y
paraboloid 205 125 +x
paraboloid 49 125 -x
paraboloid 125 205 -y
paraboloid 125 80 bar
paraboloid 381 80 bar
octahedral 125 41 +y
octahedral 213 125 +x
octahedral 41 125 -x
octahedral 125 213 -y
octahedral 125 68 bar
EOF
    # The same texels in both formats, as OpenImageIO reads them: half a step of RGBE apart at most.
    for kind in cube latlong sphere paraboloid octahedral; do
        oiiotool "$work/$kind.exr" "$work/$kind.hdr" --fail 0.004 --diff >"$work/diff" ||
            fail "$kind: EXR and HDR differ: $(cat "$work/diff")"
    done

    # OpenImageIO sees the attribute, the size and the pixels.
    expect 0 "" env "$work/chart.exr" --to latlong --convention openexr -o "$work/o.exr"
    oiiotool --info -v "$work/o.exr" >"$work/info"
    grep -qi "latlong" "$work/info" || fail "oiiotool sees no lat-long: $(cat "$work/info")"
    grep -q "256 x  128, 3 channel, float" "$work/info" || fail "oiiotool: $(head -1 "$work/info")"
    oiiotool "$work/chart.exr" -o "$work/oiio.exr"
    same "$work/chart.exr" "$work/oiio.exr" 0
else
    echo "oiiotool is not installed: what OpenImageIO makes of the files was not checked"
fi
if command -v exrenvmap >/dev/null; then
    # The OpenEXR library turns its lat-long into a cube: ours must be that cube.
    exrenvmap -c -w 64 "$work/o.exr" "$work/lib.exr"
    expect 0 "cube map by the convention openexr" info "$work/lib.exr"
    expect 0 "" env "$work/lib.exr" -o "$work/back.exr"
    same "$work/chart.exr" "$work/back.exr" 0.12
else
    echo "exrenvmap is not installed: what the OpenEXR library makes of the files was not checked"
fi

finish
