#!/bin/sh
# Runs one program over what the exports write: run.sh SHIVER SOURCE_FOLDER tables|usd|paraview|blender|browser|many
# What it reads is compared with the run file, which h5py reads. Ends with 77 where a program is not installed. Debian's packages:
# python3-h5py; nodejs and npm, with three.js; paraview and python3-paraview; blender; chromium (`./bootstrap interop` installs
# what is missing and runs all).
set -eu
shiver=$1
source=$2
which=$3
skip()
{
    echo "skipped: $1"
    exit 77
}
# The first Python that has h5py: Debian's may stand behind another.
python=
for candidate in python3 /usr/bin/python3; do
    if [ -z "$python" ] && $candidate -c 'import h5py' 2>/dev/null; then python=$candidate; fi
done
judged=yes
case $which in browser | many) judged= ;; esac
[ -n "$python" ] || [ -z "$judged" ] || skip "no h5py: install Debian's package python3-h5py"
case $which in
tables) ;;
usd)
    [ -d "$source/src/view/web/node_modules/three" ] || skip "no three.js: run npm ci in src/view/web (with Debian's packages nodejs and npm)"
    ;;
paraview) command -v pvpython >/dev/null 2>&1 || skip "no pvpython: install Debian's package paraview" ;;
blender) command -v blender >/dev/null 2>&1 || skip "no blender: install Debian's package blender" ;;
browser | many)
    command -v chromium >/dev/null 2>&1 || skip "no chromium: install Debian's package chromium"
    [ -d "$source/src/view/web/node_modules/playwright-core" ] || skip "no playwright-core: run npm ci in src/view/web"
    ;;
esac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
scene=scene
[ "$which" != many ] || scene=many
"$shiver" run "$source/tests/interop/$scene.yaml" --output "$folder/run.h5" --quiet
[ -z "$judged" ] || $python "$source/tests/interop/judge.py" "$folder"
case $which in
tables)
    "$shiver" export csv "$folder/run.h5" >/dev/null
    $python "$source/tests/interop/csv_reads.py" "$folder"
    ;;
usd)
    "$shiver" export usd "$folder/run.h5" >/dev/null
    node "$source/tests/interop/usd_reads.mjs" "$folder" "$source"
    ;;
paraview)
    "$shiver" export xdmf "$folder/run.h5" >/dev/null
    "$shiver" export vtk "$folder/run.h5" >/dev/null
    pvpython --force-offscreen-rendering "$source/tests/interop/paraview_reads.py" "$folder"
    ;;
blender)
    "$shiver" export gltf "$folder/run.h5" >/dev/null
    # What Blender does after the script, and its own messages, do not matter: the script's last line does.
    blender --background --python-exit-code 1 --python "$source/tests/interop/blender_reads.py" -- "$folder" | tee "$folder/log"
    grep -q '^as in the run file:' "$folder/log"
    ;;
browser | many)
    "$shiver" view "$folder/run.h5" >/dev/null || [ $? -ne 2 ] || skip "this shiver was built without the page"
    if [ "$which" = many ]; then
        node "$source/tests/interop/browser_times.mjs" "$folder/run.html" "$source" 8
        exit
    fi
    "$shiver" export csv "$folder/run.h5" >/dev/null
    node "$source/tests/interop/browser_plays.mjs" "$folder" "$source"
    ;;
esac
