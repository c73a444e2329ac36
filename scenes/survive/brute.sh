#!/usr/bin/env bash
# The share of 100 specimens, all of them others, that break from each of four heights: what `shiver survive` must agree with.
#   scenes/survive/brute.sh build/release/shiver
set -euo pipefail
shiver=$1
scene=$(cd "$(dirname "$0")" && pwd)/small_tile.yaml
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
seed=5000
for height in 0.8 1.1 1.5 2.1; do
    speed=$(awk -v h="$height" 'BEGIN { printf "%.15g", sqrt(2 * 9.80665 * h) }')
    broken=0
    for _ in $(seq 100); do
        largest=$("$shiver" run "$scene" --set threads=1 --set "seed=$seed" --set "objects.tile.velocity=[0, 0, -$speed]" --force \
            --output "$folder/run.h5" --quiet --json | sed 's/.*"largest_mass_fraction": \([^,}]*\).*/\1/')
        broken=$((broken + $(awk -v l="$largest" 'BEGIN { print l < 0.9 ? 1 : 0 }')))
        seed=$((seed + 1))
    done
    echo "from $height m: $broken of 100 break"
done
