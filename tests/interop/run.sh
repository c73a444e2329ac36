#!/bin/sh
# Runs one program over what the exports write: run.sh SHIVER SOURCE_FOLDER paraview|blender|browser
# Ends with 77 where that program is not installed. Debian's packages: paraview and python3-paraview; blender; chromium with
# nodejs and npm (`./bootstrap interop` installs what is missing and runs all).
set -eu
shiver=$1
source=$2
which=$3
skip()
{
    echo "skipped: $1"
    exit 77
}
case $which in
paraview) command -v pvpython >/dev/null 2>&1 || skip "no pvpython: install Debian's package paraview" ;;
blender) command -v blender >/dev/null 2>&1 || skip "no blender: install Debian's package blender" ;;
browser)
    command -v chromium >/dev/null 2>&1 || skip "no chromium: install Debian's package chromium"
    [ -d "$source/src/view/web/node_modules/playwright-core" ] || skip "no playwright-core: run npm ci in src/view/web"
    ;;
esac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$shiver" run "$source/tests/interop/scene.yaml" --output "$folder/run.h5" --quiet
"$shiver" export csv "$folder/run.h5" >/dev/null
case $which in
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
browser)
    "$shiver" view "$folder/run.h5" >/dev/null || [ $? -ne 2 ] || skip "this shiver was built without the page"
    node "$source/tests/interop/browser_plays.mjs" "$folder" "$source"
    ;;
esac
