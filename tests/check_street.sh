#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The one-way street: a folder includes itself and the folders to its left, nothing else; library
# headers stay in their adapters; C++ stays in adapters.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

failed=0
left=""
for folder in core geometry sampling shading io apps; do
    left="$left $folder"
    allowed=$(echo $left | tr ' ' '|')
    if grep -nE '#include "' -r "$folder" --include='*.c' --include='*.h' --include='*.inc' \
        --include='*.cpp' --include='*.hpp' |
        grep -vE "#include \"($allowed)/" | grep -vE '^apps/[^:]*:[0-9]+:#include "nacre.h"'; then
        echo "^ $folder may include only: $left" >&2
        failed=1
    fi
done

# A library's own header appears in its adapter alone: <noun>_<library>.c, .cpp or _internal.h.
for pair in embree3/:_embree. opensubdiv/:_opensubdiv. OpenMesh/:_openmesh. CGAL/:_cgal. openexr.h:_openexr Imf:_openexr; do
    if grep -rlE "#include <(OpenEXR/)?${pair%%:*}" core geometry sampling shading io apps | grep -vF "${pair##*:}"; then
        echo "^ <${pair%%:*}...> belongs to files named *${pair##*:}*" >&2
        failed=1
    fi
done
exit $failed
