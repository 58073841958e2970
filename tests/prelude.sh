# SPDX-License-Identifier: MIT
# prelude.sh - what the tests of the command share; sourced by them, not run.
#     . "$(dirname "$0")/prelude.sh"
#     begin NACRE [SOURCE_FOLDER]
#     ...
#     finish
set -euo pipefail
failures=0

# Sets `nacre`, and `work`, a folder that goes at the end; goes to the source folder.
begin() {
    nacre=$(realpath "$1")
    [ $# -lt 2 ] || cd "$2"
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
}

fail() {
    echo "$*" >&2
    failures=$((failures + 1))
}

# expect CODE PATTERN arguments...: exit code, and a pattern that stderr must hold. Leaves what was
# written in $work/out and $work/err.
expect() {
    local code=$1 pattern=$2 got=0
    shift 2
    "$nacre" "$@" >"$work/out" 2>"$work/err" </dev/null || got=$?
    if [ $got -ne "$code" ] || ! grep -qE -- "$pattern" "$work/err"; then
        fail "nacre $*: exit $got (expected $code), stderr (expected /$pattern/): $(cat "$work/err")"
    fi
}

# holds CONDITION [FILE]: true of that JSON, or of what the last command printed
holds() {
    jq -e "$1" "${2:-$work/out}" >/dev/null || fail "not so: $1"
}

finish() {
    [ $failures -eq 0 ] || { echo "$failures failures" >&2; exit 1; }
    echo "all as it should be"
}
