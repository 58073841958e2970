#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every file that the command reads, missing, empty, cut, renamed, not finite, oversized, of another
# version: an exit code, a sentence with the file's name, and nothing written.
#   check_bad_input.sh NACRE SOURCE_FOLDER
. "$(dirname "$0")/prelude.sh"
begin "$1" "$2"
asked=0
mkdir "$work/good" "$work/bad" "$work/out"
good=$work/good bad=$work/bad

# refuse CODES NAME command...: one of these exit codes, stderr that names the file, no output
refuse() {
    local codes=$1 name=$2 got=0
    shift 2
    asked=$((asked + 1))
    timeout 60 "$nacre" "$@" >"$work/stdout" 2>"$work/stderr" </dev/null || got=$?
    if [[ " $codes " != *" $got "* ]] || ! grep -qF -- "$name" "$work/stderr" ||
        [ -s "$work/stdout" ] || [ -n "$(ls -A "$work/out")" ]; then
        echo "nacre $*: exit $got (expected $codes), stderr (expected $name):" >&2
        cat "$work/stderr" >&2
        ls -A "$work/out" >&2
        rm -rf "$work/out"/*
        failures=$((failures + 1))
    fi
}

# put FILE OFFSET BYTES: overwrite, printf escapes allowed
put() { printf "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none; }
# offset FILE TEXT: of the first byte after it
offset() { echo $(($(grep -abo -m1 -- "$2" "$1" | head -1 | cut -d: -f1) + ${#2})); }

# --- files as they should be ---
scene=tests/data/small.json
cp tests/data/small.* "$good"
"$nacre" bake $scene --preset quick -q -o "$good/s.field"
for kind in exr hdr png ktx2; do
    "$nacre" env --chart --to latlong --size 16 -q -o "$good/i.$kind" 2>"$work/stderr" || true
done
[ -f "$good/i.ktx2" ] || "$nacre" env --chart --size 16 -q -o "$good/i.ktx2"

# use FILE CODES: every verb that reads a file of its kind
use() {
    local file=$1 codes=$2 name
    name=$(basename "$file")
    case $name in
    *.json)
        refuse "$codes" "$name" bake "$file" -q -o "$work/out/f"
        refuse "$codes" "$name" render "$file" --method trace -q -o "$work/out/a.png"
        refuse "$codes" "$name" info "$file"
        ;;
    *.patches)
        sed "s|small.patches|$name|" "$good/small.json" >"$bad/of.json"
        refuse "$codes" "$name" bake "$bad/of.json" -q -o "$work/out/f"
        refuse "$codes" "$name" info "$file"
        ;;
    *)
        refuse "$codes" "$name" compare "$file" "$file"
        refuse "$codes" "$name" env "$file" --from latlong -q -o "$work/out/a.exr"
        refuse "$codes" "$name" render "$good/small.json" --method mirror --env "$file" -q -o "$work/out/a.png"
        refuse "$codes" "$name" prefilter "$file" --from latlong -q -o "$work/out/a.exr"
        refuse "$codes" "$name" rsibr "$file" --brdf mirror --from latlong --size 8 -q -o "$work/out/m"
        refuse "$codes" "$name" rsibr "$file" --import-ball --circle 8,8,7 -q -o "$work/out/a.exr"
        refuse "$codes" "$name" info "$file"
        ;;
    esac
}

# --- missing, empty, cut, renamed ---
for name in small.json small.patches i.exr i.hdr i.png i.ktx2; do
    kind=${name##*.} size=$(stat -c %s "$good/$name")
    use "$bad/missing.$kind" "3"
    : >"$bad/empty.$kind"
    use "$bad/empty.$kind" "4"
    head -c $((size / 2)) "$good/$name" >"$bad/cut.$kind"
    use "$bad/cut.$kind" "4"
    mkdir "$bad/folder.$kind"
    use "$bad/folder.$kind" "3 4"
    case $kind in json) other=i.png ;; *) other=small.json ;; esac
    cp "$good/$other" "$bad/renamed.$kind"
    use "$bad/renamed.$kind" "4"
done

# --- not finite ---
sed -E '0,/"fov_deg": *[0-9.]+/s//"fov_deg": NaN/' "$good/small.json" >"$bad/nan.json"
use "$bad/nan.json" "4"
sed -E '0,/"fov_deg": *[0-9.]+/s//"fov_deg": 1e999/' "$good/small.json" >"$bad/infinite.json"
use "$bad/infinite.json" "4"
sed -E '4s/^[^ ]+/nan/' "$good/small.patches" >"$bad/nan.patches"
use "$bad/nan.patches" "4"

# In an image they are counted, told, and read as zero.
"$nacre" env --chart --size 16 --float -q -o "$bad/nan.ktx2"
put "$bad/nan.ktx2" $(($(stat -c %s "$bad/nan.ktx2") - 16)) '\0\0\300\177'
told=$("$nacre" info "$bad/nan.ktx2" 2>&1; "$nacre" env "$bad/nan.ktx2" -o "$bad/nan.exr" 2>&1)
[[ $told == *"1 not finite"* && $told == *"1 were not finite and are now 0"* ]] ||
    fail "NaN in an image: $told"

# --- oversized, another version ---
sed -E 's/^points .*/points 99999999999/' "$good/small.patches" >"$bad/huge.patches"
use "$bad/huge.patches" "4 5"
sed -E 's/^nacre patches 1/nacre patches 2/' "$good/small.patches" >"$bad/version.patches"
use "$bad/version.patches" "4"
sed -E '0,/"(nacre|version|format)[^:]*": *[0-9]+/s//"nacre": 99/' "$good/small.json" >"$bad/version.json"
cmp -s "$good/small.json" "$bad/version.json" || use "$bad/version.json" "4"
# (exit 2: a map that does not say how it lies is not even begun)
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n' >"$bad/huge.hdr"
use "$bad/huge.hdr" "2 4 5"
printf '#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 2\n0123456789abcdef' >"$bad/version.hdr"
use "$bad/version.hdr" "2 4 5"
cp "$good/i.exr" "$bad/huge.exr"
put "$bad/huge.exr" $(($(offset "$bad/huge.exr" dataWindow) + 15)) '\377\377\0\0\377\377\0\0'
use "$bad/huge.exr" "4 5"
cp "$good/i.exr" "$bad/version.exr"
put "$bad/version.exr" 4 '\011'
use "$bad/version.exr" "4 5"
cp "$good/i.png" "$bad/huge.png"
put "$bad/huge.png" 16 '\0\377\377\377\0\377\377\377'
use "$bad/huge.png" "4 5"
cp "$good/i.ktx2" "$bad/huge.ktx2"
put "$bad/huge.ktx2" 20 '\377\377\377\0\377\377\377\0'
use "$bad/huge.ktx2" "4 5"
cp "$good/i.ktx2" "$bad/version.ktx2"
put "$bad/version.ktx2" 5 '11'
use "$bad/version.ktx2" "4"

# --- a field and a folder of radiance maps: each of their files, and the whole ---
"$nacre" rsibr "$good/i.exr" --brdf phong:20 --size 8 -q -o "$good/s.maps"
renew() { rm -rf "$bad/h.$1" && cp -r "$good/s.$1" "$bad/h.$1"; }

# harm PART CODES: the field in $bad/h.field is refused by the file's name
harm() {
    refuse "$2" "$1" info "$bad/h.field" --verify
    refuse "$2" "$1" render $scene --field "$bad/h.field" --method cosine-n:4 -q -o "$work/out/a.png"
    renew field
}

# harm_maps PART CODES: and so are the radiance maps in $bad/h.maps
harm_maps() {
    refuse "$2" h.maps info "$bad/h.maps"
    refuse "$2" "$1" render $scene --method rsibr --maps "$bad/h.maps" -q -o "$work/out/a.png"
    renew maps
}

# harm_parts FOLDER HOW: each file gone, empty, cut, another's
harm_parts() {
    local at=$bad/h.$1 how=$2 part
    renew "$1"
    for part in $(ls "$good/s.$1"); do
        rm "$at/$part"
        $how "$part" "3"
        : >"$at/$part"
        $how "$part" "4"
        truncate -s -3 "$at/$part"
        $how "$part" "4"
        cp "$good/i.hdr" "$at/$part"
        $how "$part" "4"
    done
}
harm_parts field harm
harm_parts maps harm_maps
for part in $(ls "$good/s.field"); do
    truncate -s 5G "$bad/h.field/$part"
    harm "$part" "4 5"
done
sed -i -E 's/("version": *)[0-9]+/\199/' "$bad/h.field/field.json"
harm field.json 4
sed -i -E 's/("epsilon": *)[0-9.e-]+/\1NaN/' "$bad/h.field/field.json"
harm field.json 4
sed -i -E 's/("cube": *)[0-9]+/\1999999999/' "$bad/h.field/field.json"
harm field.json "4 5"
put "$bad/h.field/points.ply" $(offset "$bad/h.field/points.ply" 'end_header.') '\0\0\0\0\0\0\370\177'
harm points.ply 4
put "$bad/h.field/radiance.exr" $(($(stat -c %s "$bad/h.field/radiance.exr") - 8)) '\0\176\0\176\0\176\0\176'
harm radiance.exr 4
sheet=$(cd "$good/s.maps" && ls maps-*.exr)
sed -i 's|nacre.rsibr/1|nacre.rsibr/9|' "$bad/h.maps/rsibr.json"
harm_maps rsibr.json 4
sed -i -E '0,/("size": *)[0-9]+/s//\1999999999/' "$bad/h.maps/rsibr.json"
harm_maps rsibr.json "4 5"
sed -i -E '0,/("exponent": *)[0-9.]+/s//\1NaN/' "$bad/h.maps/rsibr.json"
harm_maps rsibr.json 4
"$nacre" env --chart --to latlong --size 16 -q -o "$bad/h.maps/$sheet" # sound, but not these maps
harm_maps "$sheet" 4
refuse 3 rsibr.json render $scene --method rsibr --maps "$bad/gone.maps" -q -o "$work/out/a.png"
refuse 3 gone.field info "$bad/gone.field"
refuse 3 gone.field render $scene --field "$bad/gone.field" --method cosine-n:4 -q -o "$work/out/a.png"

[ $failures = 0 ] || { echo "$failures of $asked failed" >&2; exit 1; }
echo "$asked bad files refused"
