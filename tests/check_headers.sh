#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Each public header stands alone, as C17 and as C++17, without a warning.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

for header in nacre.h {core,geometry,sampling,shading,io}/*.h; do
    case $header in *_internal.h) continue ;; esac
    echo "#include \"$header\"" | ${CC:-cc} -std=c17 -Wall -Wextra -Wpedantic -Wshadow \
        -Wstrict-prototypes -Werror -I. -fsyntax-only -x c -
    echo "#include \"$header\"" | ${CXX:-c++} -std=c++17 -Wall -Wextra -Wpedantic -Wshadow -Werror \
        -I. -fsyntax-only -x c++ -
done
