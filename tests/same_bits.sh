#!/bin/sh
# Whether builds of the program give the same bits: each runs the scenes, and the checksums of all frames are compared, with one
# thread and with two.
# usage: same_bits.sh SCENE_FOLDER PROGRAM...
set -eu
scenes=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0
# Scene and what makes it short; both break, fly and meet each other.
while read -r scene settings; do
    first=
    for program in "$@"; do
        for threads in 1 2; do
            # shellcheck disable=SC2086 # a list of words on purpose
            "$program" run "$scenes/$scene" --quiet --force --output "$folder/run.h5" --set threads=$threads $settings
            sum=$("$program" info --json "$folder/run.h5" | sed 's/.*"checksum": "\([0-9a-f]*\)".*/\1/')
            echo "$sum  $scene  $program  threads $threads"
            [ -n "$first" ] || first=$sum
            [ "$sum" = "$first" ] || bad=1
        done
    done
done <<'EOF'
slab_on_stone.yaml --set duration=0.006
hybrid/two_balls.yaml --set duration=0.006
EOF
[ $bad = 0 ] || echo "the builds differ"
exit $bad
