#!/bin/sh
# Installs a build to a temporary prefix, builds programs against it through CMake and through pkg-config, and runs a third in Python.
# usage: run.sh BUILD_FOLDER SOURCE_FOLDER C_COMPILER
set -eu
build=$1 source=$2 compiler=$3
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake --install "$build" --prefix "$prefix" >"$prefix/install.log"
"$prefix/bin/shiver" --version

# From anywhere: scenes and cases, the manual page, completion.
(cd / && "$prefix/bin/shiver" verify fall --quiet && "$prefix/bin/shiver" verify fall >"$prefix/verify.log")
tail -n 1 "$prefix/verify.log"
for file in man/man1/shiver.1 bash-completion/completions/shiver zsh/site-functions/_shiver shiver/scenes/sphere_drop.yaml \
    doc/shiver/scene.md; do
    [ -s "$prefix/share/$file" ] || { echo "$file is not installed"; exit 1; }
done

# The library shows what its headers declare, and nothing else.
library=$(find "$prefix" -name 'libshiver.so')
nm -D --defined-only "$library" | sed 's/.* //; s/@.*//' | sort >"$prefix/shown"
cat "$prefix"/include/shiver/*.h | grep -oE '[ *]shv_[a-z0-9_]+\(' | tr -d ' *(' | sort -u >"$prefix/declared"
cmp "$prefix/shown" "$prefix/declared" || { diff "$prefix/shown" "$prefix/declared"; exit 1; }

cmake -S "$source/tests/install" -B "$prefix/by-cmake" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$compiler" >"$prefix/cmake.log"
cmake --build "$prefix/by-cmake" >>"$prefix/cmake.log" || { cat "$prefix/cmake.log"; exit 1; }
"$prefix/by-cmake/drop"
"$prefix/by-cmake/live"

PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name shiver.pc)")
LD_LIBRARY_PATH=$(dirname "$library")
export PKG_CONFIG_PATH LD_LIBRARY_PATH
# shellcheck disable=SC2046 # flags on purpose
"$compiler" -std=c17 "$source/tests/install/drop.c" $(pkg-config --cflags --libs shiver) -lm -o "$prefix/by-pkg-config"
"$prefix/by-pkg-config"

# Python finds the library beside its own prefix.
unset LD_LIBRARY_PATH
python=python3
[ -x /usr/bin/python3 ] && python=/usr/bin/python3 # whose NumPy is the distribution's
if "$python" -c 'import numpy' 2>/dev/null; then
    PYTHONPATH=$(dirname "$(find "$prefix" -name shiver.py)") "$python" "$source/tests/install/live.py"
else
    echo "the Python module is left out: no NumPy here"
fi
