#!/usr/bin/env bash
# check_can_fail.sh COMPILER: check.sh says no to each kind of case that it must not let pass, and yes to a right one.
set -euo pipefail
here="$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
compiler="$1"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
failures=0

try() {  # try yes|no WHAT, case on standard input
    cat >"$work/case.cpp"
    local passed=yes
    bash "$here/check.sh" "$work/case.cpp" "$compiler" >"$work/said" 2>&1 || passed=no
    if [ "$passed" != "$1" ]; then
        echo "check.sh: $2: passed=$passed, must be $1"
        cat "$work/said"
        failures=$((failures + 1))
    fi
}

printf '// expect: wanted_name\nint x = wanted_name;\n' | try yes "fails as expected"
printf '// expect: wanted_name\nint x = other_name;\n' | try no "fails with another message"
printf '// expect: wanted_name\nint wanted_name = 1;\n' | try no "compiles though it must not"
printf '// expect: compiles\nint x = 1;\n' | try yes "compiles as expected"
printf '// expect: compiles\nint x = nothing;\n' | try no "does not compile though it must"
printf 'int x = nothing;\n' | try no "has no expectation"
{
    echo '// expect: wanted_name'
    for i in $(seq 1 30); do echo "int x$i = wanted_name$i;"; done
} | try no "says too much"
[ "$failures" -eq 0 ]
