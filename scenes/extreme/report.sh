#!/bin/sh
# Measures how long steps may be and runs the suite of extreme scenes, and writes docs/stability.md with its figures:
# report.sh PROGRAM
# Tables lie in build/extreme.
set -eu

program=$1
bench=$(dirname "$program")/bench/bench_parts
root=$(cd "$(dirname "$0")/../.." && pwd)
extreme=$root/scenes/extreme
results=$root/build/extreme
page=$root/docs/stability.md
mkdir -p "$results"
export OMP_NUM_THREADS=1

# cubes NX NY NZ EDGE: a body of cubes of six tets each around their diagonals, which no generator makes, as TetGen files.
cubes()
{
    awk -v nx="$1" -v ny="$2" -v nz="$3" -v edge="$4" -v base="$results/cubes_$1" 'BEGIN {
        split("012 120 201 021 210 102", paths, " ")
        printf "%d 3 0 0\n", (nx + 1) * (ny + 1) * (nz + 1) > (base ".node")
        printf "%d 4 0\n", 6 * nx * ny * nz > (base ".ele")
        for (z = 0; z <= nz; z++) for (y = 0; y <= ny; y++) for (x = 0; x <= nx; x++) {
            printf "%d %.17g %.17g %.17g\n", node++, edge * x, edge * y, edge * z > (base ".node")
            if (x == nx || y == ny || z == nz) continue
            for (p = 1; p <= 6; p++) {
                c[0] = x; c[1] = y; c[2] = z
                for (k = 0; k < 4; k++) {
                    t[k] = (c[2] * (ny + 1) + c[1]) * (nx + 1) + c[0]
                    if (k < 3) c[substr(paths[p], k + 1, 1)]++
                }
                if (p <= 3) printf "%d %d %d %d %d\n", tet++, t[0], t[1], t[2], t[3] > (base ".ele")
                else printf "%d %d %d %d %d\n", tet++, t[0], t[1], t[3], t[2] > (base ".ele")
            }
        }
    }'
}

# measure NAME OPTIONS…
measure()
{
    name=$1
    shift
    echo "stability: $name" >&2
    "$program" stability "$extreme/bar_map.yaml" "$@" --csv "$results/$name.csv" --svg "$results/$name" --force \
        --set threads=1 >"$results/$name.txt" 2>"$results/$name.log" </dev/null
}

all='--k 1,0.9,0.5,0.1 --iterations 1,2,4,10,20'
few='--k 1,0.5,0.1 --iterations 1,4,10 --at 1'
some='--k 1 --iterations 1,4,10 --at 1'
measure_all()
{
    cubes 3 3 6 0.02
    cubes 6 6 10 0.01
    coarse="objects.bar.mesh={tetgen: {file: $results/cubes_3}, jitter: 0.1}"
    fine="objects.bar.mesh={tetgen: {file: $results/cubes_6}, jitter: 0.1}"
    # shellcheck disable=SC2086 # lists of words on purpose
    {
        measure lattice $all
        measure lattice_element $few --set pbd.form=element
        measure lattice_fine $some --set objects.bar.mesh.box.edge=11.8mm
        measure cubes $few --set "$coarse"
        measure cubes_element $few --set "$coarse" --set pbd.form=element
        measure cubes_fine $some --set "$fine"
        measure nu_0 $few --set materials.glass.poissons_ratio=0
        measure nu_45 $few --set materials.glass.poissons_ratio=0.45
        measure moduli --k 1 --iterations 4 --at 1 --moduli 0.6,1e6,70e9,400e9
    }
}

# What the program says of limits, as Markdown: a line a setting.
limits()
{
    awk -F, 'NR > 1 {
        row = $1 "," $2 "," $3 "," $4
        if (row in seen) next
        seen[row] = 1
        setting = $1 == "none" ? "no bars | " : $4 " | " $2
        again = $10 == "" ? "" : sprintf("stable again at %.2f", $10)
        below = $9 == "" ? "" : sprintf("unstable at %.2f", $9)
        printf "| %s | %.2f | %s | %.2f | %s | %s | %s |\n", setting, $6, $7 == "" ? "–" : sprintf("%.2f", $7), $8, $11, $12,
            again below == "" ? "yes" : "**no**: " again (again != "" && below != "" ? ", " : "") below
    }' "$results/$1.csv"
}

# The limits of several measurements side by side; the settings are those of the first.
side_by_side()
{
    printf '| k, sweeps |'
    for name in "$@"; do printf ' %s |' "$(echo "$name" | tr _ ' ')"; done
    printf '\n|---|'
    for name in "$@"; do printf '%s' '---|'; done
    printf '\n'
    for name in "$@"; do awk -F, -v name="$name" 'NR > 1 { print name "," $1 "," $2 "," $4 "," $6 "," $8 }' "$results/$name.csv" | uniq; done |
        awk -F, -v names="$*" '
            { setting = $2 == "none" ? "no bars" : $4 ", " $3
              if (!(setting in known)) { known[setting] = 1; order[++count] = setting }
              value[setting, $1] = sprintf("%.1f (%.1f)", $5, $6) }
            END { n = split(names, name, " ")
                  for (i = 1; i <= count; i++) {
                      line = "| " order[i] " |"
                      for (k = 1; k <= n; k++) line = line " " value[order[i], name[k]] " |"
                      print line } }'
}

# figure K SWEEPS STEP COLUMN FORMAT: from the errors of the lattice; – where it has none.
figure()
{
    awk -F, -v k="$1" -v n="$2" -v step="$3" -v column="$4" -v format="$5" '
        $1 == "bars" && $4 == k && $2 == n && $15 == step && $column != "" { printf format, $column; found = 1; exit }
        END { if (!found) printf "–" }' "$results/lattice.csv"
}

# Errors of a measurement, a line a point; without those where nothing was measured.
points()
{
    echo '| k, sweeps | step | class | static stiffness | bars alone | frequency | displacement error | energy kept |'
    echo '|---|---|---|---|---|---|---|---|'
    awk -F, '
        function figure(text, format) { return text == "" ? "–" : sprintf(format, text) }
        NR > 1 && $14 != "overflow" && $14 != "growing" && !($14 == "refused" && $19 == "") {
            printf "| %s | %.2f | %s | %s | %s | %s | %s | %s |\n", $1 == "none" ? "no bars" : $4 ", " $2, $15, $14,
                figure($16, "%.3g"), figure($17, "%.3g"), figure($18, "%.3f"), figure($19, "%.2g"), figure($20, "%.2g") }' \
        "$results/$1.csv"
}

run_suite()
{
    echo "stability: the suite" >&2
    (cd "$root" && "$program" stability --suite scenes/extreme --markdown "$results/suite.md" --force) >"$results/suite.txt" </dev/null ||
        echo "stability: cases miss, see docs/stability.md" >&2
}

# Scenes that optional parts are taken from, smaller than they are: name | scene | overrides.
part_scenes()
{
    cat <<'END'
sphere drop|sphere_drop|rigid.engine=analytic;objects.ball.mesh.ball.edge=0.012;objects.ball.position.2=0.06;objects.ball.velocity=[0, 0, -6];duration=0.01;output.rate=1000
tile on floor|hybrid/tile_on_floor|objects.tile.mesh.box.edge=0.012;objects.tile.position.2=0.06;objects.tile.velocity=[0, 0, -3];duration=0.01;output.rate=1000
stack of boxes, which cannot break|rigid/stack_of_boxes|duration=0.2
END
}

measure_parts()
{
    part_scenes | while IFS='|' read -r name scene overrides; do
        echo "stability: parts of $name" >&2
        (
            IFS=';'
            # shellcheck disable=SC2086 # a list on purpose
            "$bench" "$root/scenes/$scene.yaml" $overrides threads=1 >"$results/parts_$(basename "$scene").csv" </dev/null
        )
    done
}

parts()
{
    part_scenes | while IFS='|' read -r name scene overrides; do
        printf '\n%s (`scenes/%s.yaml`, %s):\n\n' "$name" "$scene" "$(echo "$overrides" | sed 's/;/, /g; s/[^,]*=\([^,]*\)/\0/g')"
        echo '| variant | planned, kB | before the first crack, kB | of it adjacency, stress, cohesive, kB | bars, kB | peak, kB | run time, s | fracture time expected, s | steps | expected |'
        echo '|---|---|---|---|---|---|---|---|---|---|'
        awk -F, '
            NR == 1 { next }
            $3 == "" { text = $0; sub(/^[^"]*"/, "", text); sub(/"$/, "", text); printf "| %s | fails: %s | | | | | | | | |\n", $2, text; next }
            $3 == "adjacency" || $3 == "stress" || $3 == "cohesive" { crack[$2] += $5 }
            $3 == "bars" { bars[$2] = $5 }
            $3 == "all" { printf "| %s | %.0f | %.0f | %.0f | %.0f | %.0f | %.2f | %.2f | %d | %d |\n", $2, $4 / 1e3, $5 / 1e3,
                              crack[$2] / 1e3, bars[$2] / 1e3, $6 / 1e3, $7, $8, $9, $10 }' \
            "$results/parts_$(basename "$scene").csv"
    done
}

write_page()
{
    cat <<'END'
# Stability

Made by `scenes/extreme/report.sh` from runs; every figure in the tables comes from them. Three commands are behind it:

    shiver stability scenes/extreme/bar_map.yaml     how long a step is borne, and what is wrong with it
    shiver stability --suite scenes/extreme          extreme scenes, each with what is expected of it
    build/release/bench/bench_parts SCENE            what optional parts cost

## How long a step bars bear

`fracture.stabiliser: bars` lets fracture mode step beyond the stable step of central difference. What is stepped is what a scene
steps: internal forces of all tets, kick, prediction, sweeps of bars, velocities; no contact, no cohesion, no gravity, no damping.
The load: every component of a node's velocity is drawn from ±½ × 1e-6 bar speeds, and rigid motion is taken out.

- **stable**: for 10,000 steps kinetic and strain energy stay below 100 times their start, and a line through their logarithm over
  the last third rises by at most 5 %; or all but 1e-15 of the energy is gone before.
- **growing**: not so. **overflow**: numbers that are not finite come of it. **refused**: the program does not begin.

Steps are tried upwards by factors of 1.2 and then narrowed to 2 %, with a tenth of the steps; the limit itself, 0.9, 0.75, 0.5 and
0.25 of it, and three steps beyond it are tried with all of them. A limit is monotone where none of those below is unstable and
none beyond is stable again. Sixty stable steps are the most that is tried.

**The unit is the stable step that `shiver check` reports**: the smallest 2/ω_max of all tets alone, which is safe for any mesh
made of them, whatever cracks. The mesh as a whole bears more without any bars (first line).

Glass bar of 6 × 6 × 10 cm, lattice of 141 nodes, jitter 0.1, each edge once a sweep:

| k | sweeps | limit | fails at | limit over that without bars | class there | class at three times that | monotone |
|---|---|---|---|---|---|---|---|
END
    limits lattice
    printf '\n![largest stable step](stability_limit.svg)\n\n'
    cat <<'END'
Other meshes and forms; in brackets over the limit of the same mesh without bars. `cubes`: six tets a cube, 112 nodes; `fine`: 524 nodes
(lattice) and 539 (cubes); `element`: every edge once for every tet around it (`pbd.form: element`); `nu`: Poisson's ratio 0 and 0.45.

END
    side_by_side lattice lattice_element lattice_fine cubes cubes_element cubes_fine nu_0 nu_45
    cat <<'END'

Young's modulus changes the step by its root alone. The same bar, k = 1, 4 sweeps:

| Young's modulus, Pa | stable step, s | limit without bars | limit with bars |
|---|---|---|---|
END
    awk -F, 'NR > 1 && $1 == "none" && !seen[$3]++ { step[$3] = $5; plain[$3] = $6 }
        NR > 1 && $1 == "bars" && !done[$3]++ { printf "| %.3g | %.3g | %.2f | %.2f |\n", $3, step[$3], plain[$3], $6 }' "$results/moduli.csv"
    cat <<'END'

## What is stable is not therefore right

The bar is stretched along its longest axis. Everything is compared with the same bar without bars at a quarter of the stable step.

- **static stiffness**: stretch under a steady load without bars over that with them. Beside it what it would be **if every bar were
  alone**: a bar whose ends have the reduced mass m, and of whose error sweeps leave r = (1 − k)^n, acts as a spring of
  m (1 − r)/(r Δt²); springs along all edges beside the solid make it stiffer by 1 + Σ K h² (cos²θ − ν sin²θ)²/(E V), θ from the
  axis of the load. At k = 1 that is infinite; in a mesh bars fight each other. No figure: it did not settle.
- **frequency** of free vibration over that of the reference; **displacement error**: largest within its first period, over its
  largest displacement (with few steps in a period the largest may be missed); **energy kept** after that period.

![static stiffness](stability_stiffness.svg)

![displacement error](stability_error.svg)

END
    points lattice
    cat <<'END'

END
    printf 'At k = 1 with four sweeps the static stiffness is %s times the solid'"'"'s at one stable step, %s times at two and %s times at five; the\n' \
        "$(figure 1 4 1 16 %.3g)" "$(figure 1 4 2 16 %.3g)" "$(figure 1 4 5 16 %.3g)"
    printf 'displacement error is %s, %s and %s of the largest displacement. Weak bars follow the closed form: k = 0.1 with one sweep gives %s at one\n' \
        "$(figure 1 4 1 19 %.2f)" "$(figure 1 4 2 19 %.2f)" "$(figure 1 4 5 19 %.2f)" "$(figure 0.1 1 1 16 %.3g)"
    printf 'stable step, where it says %s; strong ones fall short of it, since they fight each other: k = 0.5 with ten sweeps gives %s, not %s.\n' \
        "$(figure 0.1 1 1 17 %.3g)" "$(figure 0.5 10 1 16 %.3g)" "$(figure 0.5 10 1 17 %.3g)"
    cat <<'END'
So a step that is stable is not one that is right: nowhere in this table do bars leave the vibration of a stiff body as it is. What they
serve is bodies far softer than their bars, which they make as stiff as the step says.

## The step a thousand times larger

The experiments with bars are said to allow steps a thousand times larger, 30 µs in place of 30 ns. Most of that is not the
bars': the stable step is proportional to 1/√E, so that 9 MPa in place of a concrete of about 31 GPa (an assumption; the value
behind the 30 ns is not given) make a factor of 59 by themselves, and 30 ns was about a sixth of what a tet of 1 mm altitude
bears. What is left to the bars is a factor of 1 to 6, which is within the table for k = 1 and four sweeps; a thousand stable
steps are far outside of it for any k and any number of sweeps tried here.

Bars add a stiffness of about ½ ρ (h/Δt)² that belongs to no material. Each run reports the share of bars in all work
(`bar_work_share`).

## Extreme scenes

Each scene of `scenes/extreme` has its cases in a file beside it (`NAME.case.yaml`, as in scenes/verification/README.md): what each
run must do, a line each. Figures, all with `run.` in front: `residual` is what the energy
ledger cannot account for, over its largest energy; `gain` the largest rise of kinetic, strain and potential energy above the start,
likewise; `kept` kinetic and strain energy at the end over the start; `momentum` and `angular` the largest change, over the largest
sums; `lowest` the least height of any corner, m; `swelling` and `edge_strain` changes of lengths; `told`: it ends with finite
numbers or says that it diverged; `squeezes` events of a body between two obstacles that leave it no room. Cases 1 to 36 are a list
of what engines of this kind are known to fail at. Below the tables are the cases that are facts about functions, and their tests.

END
    sed 's/^##/###/' "$results/suite.md"
    printf '\n| case | what | test |\n|---|---|---|\n'
    sed '/^#/d; s/^/| /; s/ | \([^|]*\) | \([^|]*\)$/ | `tests\/\1.c`, `\2` |/' "$extreme/covered.txt"
    cat <<'END'

## What optional parts cost

Bytes by Shiver's own counters, and run time of one thread on a shared machine, beside what `shiver plan` says. The plan is of the
time before the first crack, which it flies the scene to (`--trial`): what is held then agrees with it to 10 %, for a ball of 1,500
tets with every rigid engine and stabiliser and for bodies of a few tets (tests/stability/test_parts.c). The run time expected
here is the one of fracture mode without cracks, for the shortest time that a body stays awake; what cracks costs many times that,
and `shiver plan` tells it from its trial. Bullet's own memory is not counted. Peaks include the making of the mesh.
END
    parts
}

measure_all
run_suite
measure_parts
for figure in limit stiffness error; do cp "$results/lattice_$figure.svg" "$root/docs/stability_$figure.svg"; done
write_page >"$page.part"
mv "$page.part" "$page"
echo "stability: wrote docs/stability.md" >&2
