#!/usr/bin/env bash
# How often bodies that are cracked half through wake, beside intact twins, as they tumble: both counts for eight first spins.
#   scenes/studies/wakes.sh build/release/shiver
set -euo pipefail
shiver=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

wakes()
{
    "$shiver" run "$root/scenes/studies/cracked_bars.yaml" --set "objects.bar.stretch_rate=[$1,0,0]" \
        --set "objects.bar.angular_velocity=[0,$2,8]" --set threads=1 --force --output "$folder/run.h5" >/dev/null 2>&1
    "$shiver" export csv "$folder/run.h5" --force --output "$folder/run" >/dev/null
    grep -c ',wake,' "$folder/run_events.csv" || true
}

for spin in 15 20 25 30 35 40 45 50; do echo "$(wakes 1e-9 $spin) $(wakes 82 $spin)"; done |
    awk '{ print "intact " $1 ", cracked " $2; whole += $1; cracked += $2 } END { print "ratio " cracked / whole }'
