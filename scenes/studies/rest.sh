#!/usr/bin/env bash
# Does going to rest change what breaks? Each scene runs for eight seeds of strength as it is, and without ever leaving fracture
# mode; printed is the mean difference of the pairs, with its standard error.
#   scenes/studies/rest.sh build/release/shiver
set -euo pipefail
shiver=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Largest share of the mass, pieces of more than ten tets, failed area in m².
figures()
{
    "$shiver" run "$@" --set threads=1 --force --output "$folder/run.h5" --json >"$folder/run.json" 2>/dev/null
    local area
    area=$(sed 's/.*"failed_area": \([^,}]*\).*/\1/' "$folder/run.json")
    "$shiver" info --fragments "$folder/run.h5" | awk -v area="$area" '
        $1 == "id" { listed = 1; next }
        listed && $(NF - 2) == "nan" { mass = $NF; all += mass; if (mass > most) most = mass; many += $(NF - 1) > 10 }
        END { printf "%.6f %d %.8g", most / all, many, area }'
}

pairs()
{
    local scene=$1
    shift
    for seed in 1 2 3 4 5 6 7 8; do
        echo "$(figures "$root/$scene" "$@" --set "seed=$seed") $(figures "$root/$scene" "$@" --set "seed=$seed" \
            --set fracture.longest=1e3 --set fracture.quiet_checks=1000000000)"
    done | awk -v scene="$scene" '
        { for (i = 1; i <= 3; i++) { d = $i - $(i + 3); sum[i] += d; square[i] += d * d; mean[i] += $(i + 3) / 8 } }
        END {
            for (i = 1; i <= 3; i++) { m[i] = sum[i] / NR; e[i] = sqrt((square[i] / NR - m[i] * m[i]) / (NR - 1)) }
            printf "| %s | %.3f | %+.4f ± %.4f | %.1f | %+.2f ± %.2f | %.4g | %+.2g ± %.2g |\n", scene, mean[1], m[1], e[1],
                mean[2], m[2], e[2], mean[3], m[3], e[3] }'
}

echo "| scene | largest share, awake | difference | pieces of more than 10 tets, awake | difference | failed area, awake, m² | difference |"
echo "|---|---|---|---|---|---|---|"
pairs scenes/slab_on_stone.yaml --set duration=0.045
pairs scenes/sphere_drop.yaml --set objects.ball.position='[0, 0, 0.0501]' --set objects.ball.velocity='[0, 0, -5]' \
    --set objects.ball.mesh.ball.edge=0.014 --set duration=0.003
pairs scenes/hybrid/bar.yaml --set objects.bar.position='[0, 0, 0.1165]' --set objects.bar.velocity='[0, 0, -1.5]' --set duration=0.006
pairs scenes/hybrid/two_balls.yaml --set objects.left.mesh.ball.edge=0.012 --set objects.right.mesh.ball.edge=0.012 --set duration=0.012
pairs scenes/hybrid/tile_on_brick.yaml --set duration=0.1
