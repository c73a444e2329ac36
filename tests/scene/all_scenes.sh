#!/bin/sh
# Runs scenes to their ends, with nothing but their own settings: none may fail, and each ledger must close to 1e-3 of the largest
# energy. Unless named, all of the directory but glass, which takes hours, and those that have a report of their own. A line each:
# scene, seconds, pieces, residual.
# usage: sh tests/scene/all_scenes.sh PROGRAM SCENES [SCENE…]
program=$(realpath "$1")
cd "$2" || exit 2
shift 2
[ $# -gt 0 ] || set -- $(find . -name '*.yaml' ! -name '*.case.yaml' ! -path './glass/*' ! -path './verification/*' \
    ! -path './extreme/*' ! -path './rigid/*' ! -path './studies/*' ! -path './survive/*' ! -path './thesis/*' | sort)
[ $# -gt 0 ] || exit 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0
for scene; do
    "$program" run "$scene" -o "$work/run.h5" --force --checkpoint 0 >"$work/log" 2>&1
    status=$?
    residual=$(sed -n 's/.*ledger residual \([^ ]*\) of.*/\1/p' "$work/log" | tail -1)
    echo "$scene: $(sed -n 's/.* in \([0-9.]* s\) of run time.*/\1/p' "$work/log"), $(grep -m1 'fragments (' "$work/log" |
        sed 's/^ *//;s/,.*//'), residual $residual"
    # what is no number, or is not there, does not pass
    [ $status -eq 0 ] && echo "$residual" | awk '!/^-?[0-9.]+(e[-+][0-9]+)?$/ || $1 >= 1e-3 || $1 <= -1e-3 {exit 1}' && continue
    bad=1
    echo "  exit status $status: $(grep '^shiver:' "$work/log")"
done
exit $bad
