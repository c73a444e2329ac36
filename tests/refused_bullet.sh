#!/bin/sh
# Bullet of an untested version, or in single precision, is refused at configure time, in words.
# usage: refused_bullet.sh SOURCE_FOLDER CMAKE
set -eu
source=$1
cmake=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# refused NAME VERSION FLAGS TEXT
refused()
{
    mkdir -p "$work/$1"
    printf 'Name: bullet\nDescription: a stand-in\nVersion: %s\nCflags: %s\nLibs: -lLinearMath-float64\n' "$2" "$3" \
        >"$work/$1/bullet-float64.pc"
    if PKG_CONFIG_PATH="$work/$1" "$cmake" -G Ninja -S "$source" -B "$work/$1/build" -DSHIVER_TESTS=OFF -DSHIVER_BENCH=OFF \
        >"$work/$1/log" 2>&1; then
        echo "Bullet $2 with '$3' was not refused"
        exit 1
    fi
    tr -s ' \n' '  ' <"$work/$1/log" | grep -q "$4" || { cat "$work/$1/log"; exit 1; }
}

refused untested 3.25 -DBT_USE_DOUBLE_PRECISION 'has not been tested with Bullet 3.25, only with 3.24'
refused single 3.24 '' 'needs Bullet in double precision'
