#!/bin/sh
# Whether builds of the program give the same bits: each runs the scenes, and the checksums of all frames are compared, with one
# thread and with two. With -a: all scenes of hybrid/, by each program with one thread and by the first with 2, 4 and 8, too.
# usage: same_bits.sh [-a] SCENE_FOLDER PROGRAM...
set -eu
all=
if [ "$1" = -a ]; then
    all=yes
    shift
fi
scenes=$1
shift
first_program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0

# Scene and what makes it short; both break, fly and meet each other.
some()
{
    cat <<'EOF'
slab_on_stone.yaml --set duration=0.006
hybrid/two_balls.yaml --set duration=0.006
EOF
}

# The whole folder, each until little after the first cracks.
every()
{
    cat <<'EOF'
hybrid/ball_on_plate.yaml --set duration=0.0012
hybrid/bar.yaml --set duration=0.146
hybrid/bar_on_point.yaml --set duration=0.0015
hybrid/pane.yaml --set duration=0.0022
hybrid/second_generation.yaml --set duration=0.0715
hybrid/spinning_disc.yaml --set duration=0.0002
hybrid/stack_of_plates.yaml --set duration=0.219
hybrid/tile_on_brick.yaml --set duration=0.083
hybrid/tile_on_floor.yaml --set duration=0.2585
hybrid/two_balls.yaml --set duration=0.0055
hybrid/wall_and_ball.yaml --set duration=0.0415
EOF
}

threads_of()
{
    if [ -z "$all" ]; then
        echo 1 2
    elif [ "$1" = "$first_program" ]; then
        echo 1 2 4 8
    else
        echo 1
    fi
}

if [ -n "$all" ]; then every; else some; fi >"$folder/list"
while read -r scene settings; do
    first=
    for program in "$@"; do
        for threads in $(threads_of "$program"); do
            # shellcheck disable=SC2086 # a list of words on purpose
            "$program" run "$scenes/$scene" --quiet --force --output "$folder/run.h5" --set threads="$threads" $settings
            about=$("$program" info --json "$folder/run.h5")
            sum=$(echo "$about" | sed 's/.*"checksum": "\([0-9a-f]*\)".*/\1/')
            cracks=$(echo "$about" | sed 's/.*"inserted": \([0-9]*\).*/\1/')
            echo "$sum  $scene  $program  threads $threads, $cracks facets cracked"
            [ -n "$first" ] || first=$sum
            [ "$sum" = "$first" ] || bad=1
        done
    done
done <"$folder/list"
[ $bad = 0 ] || echo "the builds differ"
exit $bad
