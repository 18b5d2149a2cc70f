#!/usr/bin/env bash
# Installs or takes in the library as a user would, builds the user's program and runs it.
set -euo pipefail
kind="$1" cmake="$2" generator="$3" compiler="$4" source_dir="$5" build_dir="$6" work="$7" with_io="$8" with_compiled="$9"
here="$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
unset DESTDIR CXXFLAGS CMAKE_PREFIX_PATH

rm -rf "$work"
mkdir -p "$work"
place=()
if [ "$kind" = package ]; then
    "$cmake" --install "$build_dir" --prefix "$work/prefix" >/dev/null
    # What is installed may be moved, so it must not point back to where it was made; an archive tells debuggers only.
    mv "$work/prefix" "$work/moved"
    if grep -rlF --exclude="*.a" -e "$source_dir" -e "$work/prefix" "$work/moved"; then
        echo "the installed files above name the folder they were made in"
        exit 1
    fi
    place=(-D CMAKE_PREFIX_PATH="$work/moved")
else
    place=(-D ABRADE_SOURCE="$source_dir")
fi
"$cmake" -S "$here/$kind" -B "$work/build" -G "$generator" -D CMAKE_CXX_COMPILER="$compiler" \
    -D CMAKE_BUILD_TYPE=Debug -D WITH_IO="$with_io" -D WITH_COMPILED="$with_compiled" "${place[@]}"
"$cmake" --build "$work/build"
"$work/build/consumer"

if [ "$kind" = package ]; then
    said="$(OMP_NUM_THREADS=1 "$work/build/own_law")"
    grep -Eq '^restitution 0\.(599|600)' <<<"$said" || { printf 'own_law said:\n%s\n' "$said"; exit 1; }
    said="$(OMP_NUM_THREADS=1 "$work/build/flow_queries")"
    grep -Eq '^discharge (1\.9|2\.0)' <<<"$said" || { printf 'flow_queries said:\n%s\n' "$said"; exit 1; }

    # A component that is not there is refused by name.
    mkdir "$work/wrong"
    printf 'cmake_minimum_required(VERSION 3.25)\nproject(wrong CXX)\nfind_package(abrade REQUIRED COMPONENTS oi)\n' \
        >"$work/wrong/CMakeLists.txt"
    if "$cmake" -S "$work/wrong" -B "$work/wrong/build" -G "$generator" -D CMAKE_CXX_COMPILER="$compiler" \
        "${place[@]}" >"$work/wrong/log" 2>&1 || ! grep -q "abrade has no component 'oi'" "$work/wrong/log"; then
        cat "$work/wrong/log"
        echo "an unknown component must be refused by name"
        exit 1
    fi
    [ "$with_compiled" = 0 ] || exit 0  # the package's programs have linked it
    sed -i 's/COMPONENTS oi/COMPONENTS compiled/' "$work/wrong/CMakeLists.txt"
    if "$cmake" -S "$work/wrong" -B "$work/wrong/build" >"$work/wrong/log" 2>&1 ||
        ! grep -q "installed without its component 'compiled'" "$work/wrong/log"; then
        cat "$work/wrong/log"
        echo "a component that was not installed must be refused by name"
        exit 1
    fi
fi
