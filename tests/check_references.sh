#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every source that a file says it follows stands in REFERENCES.md, and every reference there is
# followed by some file. The five documents nacre implements are cited by a letter.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

listed=$(grep -oE '\*\*[A-Za-z0-9-]+\*\*' REFERENCES.md | tr -d '*' | sort -u)
# "This file follows:" lists hold lines of the form:   [Key]  Author, Title, year
cited=$(grep -rhoE '^ \*   ?\[[A-Za-z][A-Za-z0-9-]*\]  ' core geometry sampling shading io apps tests \
    --include='*.c' --include='*.h' --include='*.inc' --include='*.cpp' |
    grep -oE '[A-Za-z][A-Za-z0-9-]*' | sort -u)

failed=0
for key in $(comm -13 <(echo "$listed") <(echo "$cited")); do
    echo "[$key] is followed, but not in REFERENCES.md" >&2
    failed=1
done
for key in $(comm -23 <(echo "$listed") <(echo "$cited")); do
    case $key in
    T | C | H | M | L) ;;
    *)
        grep -rqE "\[$key[] .]" core geometry sampling shading io apps tests docs && continue
        echo "[$key] is in REFERENCES.md, but nothing follows it" >&2
        failed=1
        ;;
    esac
done
exit $failed
