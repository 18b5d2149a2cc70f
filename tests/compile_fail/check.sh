#!/usr/bin/env bash
# check.sh CASE.cpp COMPILER [FLAG...]: does CASE.cpp fail to compile as its first line expects?
set -euo pipefail
source_file="$1" compiler="$2"
shift 2
line_limit=20

expected="$(sed -n '1s|^// expect: *||p' "$source_file")"
if [ -z "$expected" ]; then
    echo "$source_file: the first line must be '// expect: REGEX' or '// expect: compiles'"
    exit 1
fi

compiled=yes
said="$(LC_ALL=C "$compiler" -std=c++20 -fsyntax-only "$@" "$source_file" 2>&1)" || compiled=no
lines="$(printf '%s\n' "$said" | wc -l)"

complain() {
    printf '%s\n--- %s said, in %s lines:\n%s\n' "$1" "$compiler" "$lines" "$said"
    exit 1
}
if [ "$expected" = compiles ]; then
    [ "$compiled" = yes ] || complain "must compile, but does not"
    exit 0
fi
[ "$compiled" = no ] || complain "must not compile, but does"
# No pipe here: grep -q ends at the first match, and a writer cut off by that would count as a failure.
grep -Eq -- "$expected" <<<"$said" || complain "the message does not match: $expected"
[ "$lines" -lt "$line_limit" ] || complain "the message has $lines lines, must be under $line_limit"
