#!/bin/sh
# Runs every scene of this folder and writes docs/thesis_experiments.md: report.sh PROGRAM
# Results and logs lie in build/thesis; a finished run newer than its scene and the program is not made again.
set -eu

program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
results=$root/build/thesis
page=$root/docs/thesis_experiments.md
mkdir -p "$results"

# result | figure | scene | what the chapter shows | changes of the scene
experiments()
{
    cat <<'END'
bunny_drop|6.3|fig_6_3_bunny_drop|falls rigidly, breaks into several pieces at the floor, pieces fly on rigidly|rigid.dust=keep
beam|6.6|fig_6_6_mixed_mode_beam|stable at 30 µs; a crack leaves the notch at 30°|
slow_beam|6.6 at 0.2 m/s|fig_6_6_slow_beam|(not in the chapter)|
slower_beam|6.6 at 0.04 m/s|fig_6_6_slow_beam|(not in the chapter)|imposed_velocities.load.velocity=[0,0,-0.04] duration=0.03
sphere_k1|6.7 (a), 6.8 (a)|fig_6_7a_hollow_sphere|does not deform|
sphere_k01|6.7 (b)|fig_6_7b_hollow_sphere|deforms|
sphere_k001|6.7 (c)|fig_6_7c_hollow_sphere|deforms extremely|
sphere_5e4|6.8 (b)|fig_6_8b_hollow_sphere|deforms at the longer step|
plate_undamped|6.9|fig_6_9_plate_undamped|deforms completely|
plate_undamped_1e4|6.9 at 0.1 ms|fig_6_9_plate_undamped|(not in the chapter)|rigid.time_step=1e-4
plate_damped|6.10|fig_6_10_plate_damped|bounces as a rigid body|
plate_damped_1e3|6.10 at 1 ms|fig_6_10_plate_damped|(not in the chapter)|rigid.time_step=1e-3
plate_damped_1e4|6.10 at 0.1 ms|fig_6_10_plate_damped|(not in the chapter)|rigid.time_step=1e-4
sphere_strong|6.11 (a)|fig_6_11a_sphere_strong|breaks|
sphere_weak|6.11 (b)|fig_6_11b_sphere_weak|breaks even more|
sphere_brittle|6.12|fig_6_12_hollow_sphere_brittle|breaks in half|
bunny_hit|6.13|fig_6_13_bunny_hit|breaks into many pieces|rigid.dust=keep
glass_plate|6.14|fig_6_14_glass_plate|breaks|
END
}

# The animated cases once more under Bullet, in which fragments collide; columns as above. Without "_bullet" a result's name is
# that of the run with PBD, in which they do not: there splinters are pieces like all others.
under_bullet()
{
    cat <<'END'
bunny_drop_bullet|6.3|fig_6_3_bunny_drop||rigid.engine=bullet
sphere_k1_bullet|6.7 (a)|fig_6_7a_hollow_sphere||rigid.engine=bullet
plate_undamped_bullet|6.9|fig_6_9_plate_undamped||rigid.engine=bullet
sphere_strong_bullet|6.11 (a)|fig_6_11a_sphere_strong||rigid.engine=bullet
sphere_weak_bullet|6.11 (b)|fig_6_11b_sphere_weak||rigid.engine=bullet
sphere_brittle_bullet|6.12|fig_6_12_hollow_sphere_brittle||rigid.engine=bullet
bunny_hit_bullet|6.13|fig_6_13_bunny_hit||rigid.engine=bullet
glass_plate_bullet|6.14|fig_6_14_glass_plate||rigid.engine=bullet
END
}

status() { sed -n 's/.*"status": "\([^"]*\)".*/\1/p' "$results/$1.json" 2>/dev/null; }

# The scenes named in $only (all unless it is set), one after the other; a failed run is reported, not fatal.
run_all()
{
    { experiments && under_bullet; } | while IFS='|' read -r name figure scene shown change; do
        file=$root/scenes/thesis/$scene.yaml
        result=$results/$name.json
        case " ${only:-$name} " in *" $name "*) ;; *) continue ;; esac
        if [ "$(status "$name")" = finished ] && [ -z "$(find "$file" "$program" -newer "$result")" ]; then continue; fi
        echo "thesis: $figure, $scene${change:+ with $change}" >&2
        set --
        for key in $change; do set -- "$@" --set "$key"; done
        if ! "$program" run "$file" "$@" --json --force --output "$results/$name.h5" \
            >"$result.part" 2>"$results/$name.log" </dev/null; then
            echo "thesis: that run failed, see build/thesis/$name.log" >&2
        fi
        # A run that never began leaves no summary.
        [ -s "$result.part" ] || printf '{"status": "not run"}\n' >"$result.part"
        mv "$result.part" "$result"
    done
}

# number NAME KEY [FORMAT [FACTOR]]: from a result, – where it has none.
number()
{
    sed -n 's/.*"'"$2"'": \([^,}]*\).*/\1/p' "$results/$1.json" 2>/dev/null |
        awk -v format="${3:-%.3g}" -v factor="${4:-1}" '
            $1 ~ /^[-+0-9.]/ { printf format, $1 * factor; found = 1 }
            END { if (!found) printf "–" }'
}

# How a run ended; of one that did not finish, why: the last line that the program said.
ending()
{
    if [ "$(status "$1")" = finished ]; then
        printf 'finished, %s s' "$(number "$1" time)"
    elif [ "$(status "$1")" = 'not run' ] || [ -z "$(status "$1")" ]; then
        printf 'no result'
    else
        printf '%s at %s s: %s' "$(status "$1")" "$(number "$1" time)" \
            "$(tail -n 1 "$results/$1.log" 2>/dev/null | sed "s|$root/||g; s/^shiver: //" | tr '|' '/')"
    fi
}

crack()
{
    if [ "$(number "$1" crack_origin_x)" = – ]; then
        printf '–'
    else
        printf '(%s, %s, %s) mm, %s°' "$(number "$1" crack_origin_x %.1f 1000)" "$(number "$1" crack_origin_y %.1f 1000)" \
            "$(number "$1" crack_origin_z %.1f 1000)" "$(number "$1" crack_angle %.0f)"
    fi
}

table()
{
    echo '| figure | the chapter shows | run | fragments | largest, share of mass | facets inserted | edge strain in flight | largest since the impact | at the end | crack from, angle to the vertical | Courant number | share of bars in all work | run time, s |'
    echo '|---|---|---|---|---|---|---|---|---|---|---|---|---|'
    experiments | while IFS='|' read -r name figure scene shown change; do
        printf '| [%s](../scenes/thesis/%s.yaml) | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n' \
            "$figure" "$scene" "$shown" "$(ending "$name")" "$(number "$name" fragments %d)" \
            "$(number "$name" largest_mass_fraction)" "$(number "$name" inserted %d)" \
            "$(number "$name" edge_strain_flight)" "$(number "$name" edge_strain_after_impact)" \
            "$(number "$name" edge_strain_end)" "$(crack "$name")" \
            "$(number "$name" courant)" "$(number "$name" bar_work_share)" "$(number "$name" wall_seconds %.0f)"
    done
}

# Residual of the energy ledger, of the largest energy.
balance()
{
    largest=$(number "$1" largest_energy %.17g)
    [ "$largest" = – ] && printf '–' || number "$1" residual %.1e "$(awk -v l="$largest" 'BEGIN { print (l > 0 ? 1 / l : 0) }')"
}

bullet_table()
{
    echo '| figure | PBD: fragments | largest, share of mass | run time, s | Bullet: run | fragments | largest, share of mass | balance off by | run time, s |'
    echo '|---|---|---|---|---|---|---|---|---|'
    under_bullet | while IFS='|' read -r name figure scene shown change; do
        printf '| [%s](../scenes/thesis/%s.yaml) | %s | %s | %s | %s | %s | %s | %s | %s |\n' "$figure" "$scene" \
            "$(number "${name%_bullet}" fragments %d)" "$(number "${name%_bullet}" largest_mass_fraction)" \
            "$(number "${name%_bullet}" wall_seconds %.0f)" "$(ending "$name")" "$(number "$name" fragments %d)" \
            "$(number "$name" largest_mass_fraction)" "$(balance "$name")" "$(number "$name" wall_seconds %.0f)"
    done
}

# claim TEXT CONDITION VALUE…: an awk condition on a, b, c, which are the values.
claim()
{
    text=$1
    condition=$2
    shift 2
    verdict=$(printf '%s %s %s\n' "${1:-0}" "${2:-0}" "${3:-0}" | awk '
        /–/ { print "no result"; exit }
        { a = $1 + 0; b = $2 + 0; c = $3 + 0; print ('"$condition"') ? "holds" : "does not hold" }')
    values=$(printf ', %s' "$@")
    printf '| %s | %s | %s |\n' "$text" "${values#, }" "$verdict"
}

claims()
{
    echo '| claim of the chapter, at its own parameters | numbers | |'
    echo '|---|---|---|'
    claim '6.3: the falling bunny keeps its shape (edge strain in flight below 0.1 %)' 'a < 1e-3' \
        "$(number bunny_drop edge_strain_flight)"
    claim '6.3: the bunny breaks (fragments)' 'a > 1' "$(number bunny_drop fragments %d)"
    claim '6.6: 25 m/s at 30 µs runs to its end (simulated ms, Courant number)' 'a > 8.99' "$(number beam time %.3g 1000)" \
        "$(number beam courant)"
    claim '6.6: the crack leaves the tip of the notch, 50.8 mm left of midspan and 19.05 mm above the lower face (x, z in mm)' \
        '(a + 50.8)^2 + (b + 19.05)^2 < 25' "$(number beam crack_origin_x %.1f 1000)" "$(number beam crack_origin_z %.1f 1000)"
    claim '6.6: the crack runs at 30° (within 10°)' 'a > 20 && a < 40' "$(number beam crack_angle)"
    claim '6.6 at 0.2 m/s: the crack leaves the tip of the notch (x, z in mm)' '(a + 50.8)^2 + (b + 19.05)^2 < 25' \
        "$(number slow_beam crack_origin_x %.1f 1000)" "$(number slow_beam crack_origin_z %.1f 1000)"
    claim '6.6 at 0.2 m/s: the crack runs at 30° (within 10°)' 'a > 20 && a < 40' "$(number slow_beam crack_angle)"
    claim '6.6 at 0.04 m/s: the crack leaves the tip of the notch (x, z in mm)' '(a + 50.8)^2 + (b + 19.05)^2 < 25' \
        "$(number slower_beam crack_origin_x %.1f 1000)" "$(number slower_beam crack_origin_z %.1f 1000)"
    claim '6.6 at 0.04 m/s: the crack runs at 30° (within 10°)' 'a > 20 && a < 40' "$(number slower_beam crack_angle)"
    claim '6.7: with k = 1 the sphere does not deform (edge strain at the end below 1 %)' 'a < 0.01' \
        "$(number sphere_k1 edge_strain_end)"
    claim '6.7: the smaller k (1, 0.1, 0.01), the more it deforms (edge strain after impact)' 'a < b && b < c' \
        "$(number sphere_k1 edge_strain_after_impact)" "$(number sphere_k01 edge_strain_after_impact)" \
        "$(number sphere_k001 edge_strain_after_impact)"
    claim '6.8: it deforms more at 5e-4 s than at 1e-4 s (edge strain after impact)' 'a < b' \
        "$(number sphere_k1 edge_strain_after_impact)" "$(number sphere_5e4 edge_strain_after_impact)"
    claim '6.9, 6.10: the plate deforms more without damping at 1 ms than with it at 2 ms (edge strain since the impact)' \
        'a > b' "$(number plate_undamped edge_strain_after_impact)" "$(number plate_damped edge_strain_after_impact)"
    claim '6.9, 6.10: the same, both at 1 ms' 'a > b' \
        "$(number plate_undamped edge_strain_after_impact)" "$(number plate_damped_1e3 edge_strain_after_impact)"
    claim '6.9, 6.10: the same, both at 0.1 ms' 'a > b' \
        "$(number plate_undamped_1e4 edge_strain_after_impact)" "$(number plate_damped_1e4 edge_strain_after_impact)"
    claim '6.10: at 2, 1 and 0.1 ms the edge strain of the damped plate falls' 'a > b && b > c' \
        "$(number plate_damped edge_strain_after_impact)" "$(number plate_damped_1e3 edge_strain_after_impact)" \
        "$(number plate_damped_1e4 edge_strain_after_impact)"
    claim '6.11: the weaker sphere breaks more (fragments of 5 mPa, of 0.5 µPa)' 'b > a && a > 1' \
        "$(number sphere_strong fragments %d)" "$(number sphere_weak fragments %d)"
    claim '6.12: the sphere breaks in half (largest share of mass within 0.4 to 0.6)' 'a >= 0.4 && a <= 0.6' \
        "$(number sphere_brittle largest_mass_fraction)"
    claim '6.13: the bunny breaks into many pieces (more than 10 fragments)' 'a > 10' "$(number bunny_hit fragments %d)"
    claim '6.14: the glass plate breaks (fragments)' 'a > 1' "$(number glass_plate fragments %d)"
}

write_page()
{
    cat <<'END'
# The chapter's experiments

Made by `./bootstrap thesis` from runs of the scenes in `scenes/thesis`, each of which says what the chapter prints, what it
does not, and what was chosen. Everything but the column on the chapter comes from the runs.

- Edge strain: largest |length / rest length − 1| of any edge in any frame; in flight until the first contact; since then, with
  the times of impact, when corners are pushed in by up to velocity × time step; and in the last frame.
- Crack: where the first facet opened, in coordinates of the scene at the start, and the angle between the vertical and the
  plane that fits the crack best, its facets weighted by area and damage. Branches of one crack count together.
- Courant number: largest step of fracture mode, at the ends of frames, over the stable step. Where it lies far below 1, bars and not the material
  make the body stiff.
- Share of bars: Σ |work of bars| over Σ (|work of bars| + |work of elastic forces|), step by step. A body whose bars do
  most of that work has the stiffness of its bars; in rigid mode there is nothing else.

END
    table
    printf '\nThe beam at 0.2 m/s, 10 and 20 ms after the start; colours are fragments:\n\n![notched beam](thesis_beam.svg)\n'
    printf '\n## The same under Bullet\n\n'
    bullet_table
    cat <<'END'

Under Bullet fragments meet one another. In 6.3 and 6.13 splinters below 1 cm and 5 mm fly as particles, which meet obstacles alone
(`rigid.dust`); the runs with PBD, where fragments do not meet at all, keep them (`rigid.dust=keep`).
END
    if bullet_table | grep -qE 'interrupted|no result'; then
        printf '\nInterrupted runs and those without a result were stopped after some minutes or not begun: tens of thousands of splinters that touch are slow.\n'
    fi
    printf '\n## What holds\n\n'
    claims
    cat <<'END'

Where claims do not hold, the parameters say why. Strengths lie at strains of 5e-5 to 1e-3, and in the animated cases the steps
of fracture mode are so far below the stable step that bars are stiffer than the material by many orders: a fall of 0.2 m
at 2 m/s sends a strain of 2 m/s over the bars' wave speed, about a percent, through the whole body, which opens nearly every
facet. Tractions hardly fall with opening there (final openings of metres to kilometres), so that cracks do not relieve their
neighbours. The beam at 25 m/s is struck at 0.4 of its own wave speed: it is crushed under the load before a wave has
reached the notch. Loaded slowly its crack leaves the notch and leans towards the load, less than the chapter's.
END
    printf '\nRun times: wall time on %s processors, with whatever else they did meanwhile.\n' "$(getconf _NPROCESSORS_ONLN)"
}

# Half way and at the end.
draw_beam()
{
    [ "$(status slow_beam)" = finished ] || return 0
    "$program" export svg "$results/slow_beam.h5" --output "$results/beam" --time 0.01,0.02 --force >/dev/null
    cp "$results/beam.svg" "$root/docs/thesis_beam.svg"
}

run_all
draw_beam
write_page >"$page.part"
mv "$page.part" "$page"
echo "thesis: wrote docs/thesis_experiments.md" >&2
