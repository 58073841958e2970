#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a host does: install nacre into a prefix, build a program of its own by pkg-config and by
# CMake, run both.   check_external.sh BUILD_FOLDER
set -euo pipefail
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/external" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" >/dev/null
libdir=$(dirname "$(find "$work/prefix" -name libnacre.a)")
sed -i "s|^prefix=.*|prefix=$work/prefix|; s|^libdir=.*|libdir=$libdir|;
        s|^includedir=.*|includedir=$work/prefix/include/nacre|" "$libdir/pkgconfig/nacre.pc"

export PKG_CONFIG_PATH=$libdir/pkgconfig LD_LIBRARY_PATH=$libdir
${CC:-cc} ${CFLAGS:-} -std=c17 -Wall -Wextra -Wpedantic -Werror "$source/host.c" -o "$work/host" \
    $(pkg-config --cflags --libs nacre) -lm -pthread
"$work/host" "$work/by-pkg-config.exr"

cmake -S "$source" -B "$work/cmake" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/cmake" >/dev/null
"$work/cmake/host" "$work/by-cmake.exr"

cmp "$work/by-pkg-config.exr" "$work/by-cmake.exr"
"$work/prefix/bin/nacre" --version
