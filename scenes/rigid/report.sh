#!/bin/sh
# Compares the rigid engines on every scene of this folder and writes docs/rigid_comparison.md: report.sh PROGRAM
# Tables, frames and plots lie in build/rigid.
set -eu

program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
results=$root/build/rigid
page=$root/docs/rigid_comparison.md
mkdir -p "$results"

# name | scene | title | changes of the scene | other options of the command
comparisons()
{
    cat <<'END'
free_fall|free_fall|Free fall, tumbling||
top|torque_free_top|Torque-free top, I = (1, 2, 3), 55 s||
top_exact|torque_free_top|The same with nodes that turn along circles (`pbd.exact_rotation`)|pbd.exact_rotation=true|--engines pbd
top_plain|torque_free_top|The same in plain Bullet, with exact flight|bullet_plain.exact_flight=true|--engines bullet_plain
bounce|bouncing_ball|Bouncing ball, restitution 0.8||
bounce_plain|bouncing_ball|The same in plain Bullet, with exact flight and sharp impacts|bullet_plain.exact_flight=true bullet_plain.sharp_impacts=true|--engines bullet_plain
slide|block_on_incline|Block on an incline of 30°, friction 0.3: slides||
stick|block_on_incline|The same with friction 0.6: sticks|obstacles.slope.friction=0.6|
rolling|rolling_ball|Ball rolling down a slope of 30°||
slip|slip_to_roll|Ball that slips until it rolls||
stack|stack_of_boxes|Stack of ten boxes||
stack_plain|stack_of_boxes|The same in plain Bullet, as thick-skinned as it comes, with overlaps kept|bullet_plain.margin=0.04 bullet_plain.keep_overlaps=true|--engines bullet_plain
ratio|mass_ratio|A block on one of a millionth of its mass||
ratio_thousand|mass_ratio|The same, a thousandth|materials.neutronium.density=1e5|--engines bullet,bullet_plain
pile|pile|Pile of 200 fragments||--engines bullet,bullet_plain --steps 1e-2,2e-3,1e-3
END
}

# Every comparison anew: run times are results, too.
run_all()
{
    comparisons | while IFS='|' read -r name scene title change options; do
        echo "compare: $title" >&2
        set --
        for key in $change; do set -- "$@" --set "$key"; done
        # shellcheck disable=SC2086 # a list of words on purpose
        if ! "$program" compare "$root/scenes/rigid/$scene.yaml" "$@" $options --set threads=1 --force \
            --output "$results/$name" >"$results/$name.txt" 2>"$results/$name.log" </dev/null; then
            echo "compare: that failed, see build/rigid/$name.log" >&2
        fi
    done
}

# The program's own table.
table()
{
    sed -n 's/; \* on the Pareto front.*//; 1s/^errors from/Errors from/p' "$results/$1.txt" | sed 's/$/. Bold: nothing cheaper is as good./'
    echo
    cat "$results/$1/table.md"
    echo
}

section()
{
    comparisons | while IFS='|' read -r name scene title change options; do
        [ "$name" = "$1" ] || continue
        printf '## %s\n\n[scene](../scenes/rigid/%s.yaml)%s\n\n' "$title" "$scene" "${change:+, \`$change\`}"
        if [ -s "$results/$name.txt" ]; then table "$name"; else echo 'It failed: no result.'; fi
    done
}

# figure NAME ENGINE STEP HEAD: from the column of results.csv or timings.csv with that head; – where it has none.
figure()
{
    for file in results timings; do
        awk -F, -v engine="$2" -v step="$3" -v head="$4" '
            NR == 1 { for (i = 1; i <= NF; i++) if ($i == head) column = i; next }
            column && $1 == engine && $2 + 0 == step + 0 && $4 == "ok" && $column != "" { printf "%.3g\n", $column }' \
            "$results/$1/$file.csv" 2>/dev/null
    done | grep . || printf '–\n'
}

# Likewise of events: "missed" where it has none because one was missed, or one was too many.
event_figure()
{
    value=$(figure "$@")
    missed=$(figure "$1" "$2" "$3" 'error of missed_events')
    case $value,$missed in –,0 | –,–) ;; –,*) value=missed ;; esac
    echo "$value"
}

# claim TEXT CONDITION VALUE…: an awk condition on v[1], v[2], …, which are the values.
claim()
{
    text=$1
    condition=$2
    shift 2
    verdict=$(printf '%s\n' "$@" | awk '
        /–/ { unknown = 1 }
        /missed/ { missed = 1 }
        { v[NR] = $1 + 0 }
        END { if (missed) print "**does not hold**"; else if (unknown) print "no result"; else if ('"$condition"') print "holds"; else print "**does not hold**" }')
    values=$(printf ', %s' "$@")
    printf '| %s | %s | %s |\n' "$text" "${values#, }" "$verdict"
}

# of NAME ENGINE COLUMN: at the three steps.
of() { for step in 0.01 0.001 0.0001; do figure "$1" "$2" "$step" "$3"; done; }
of_events() { for step in 0.01 0.001 0.0001; do event_figure "$1" "$2" "$step" "$3"; done; }

claims()
{
    three='v[1] < limit && v[2] < limit && v[3] < limit'
    below() { printf '%s' "$three" | sed "s/limit/$1/g"; }
    echo '| claim | figures at 10, 1 and 0.1 ms | |'
    echo '|---|---|---|'
    for engine in bullet bullet_plain pbd analytic; do
        # shellcheck disable=SC2046 # lists of words on purpose
        {
            claim "$engine: free fall keeps to −½gt² (energy within 1e-10)" "$(below 1e-10)" $(of free_fall $engine 'error of energy')
            claim "$engine: the top loses less than 1e-6 of its energy at 1 ms" 'v[1] < 1e-6' "$(figure top $engine 0.001 'error of energy')"
            claim "$engine: the top keeps its angular momentum within 1e-8 at 1 ms" 'v[1] < 1e-8' "$(figure top $engine 0.001 'error of angular_momentum')"
            claim "$engine: the top flips within 1 ms of 10.917, 30.470 and 50.023 s (step 1 ms)" 'v[1] < 1e-3' "$(event_figure top $engine 0.001 'error of event_time [s]')"
            claim "$engine: the bouncing ball's four impacts are found (how many are missing)" 'v[1] == 0 && v[2] == 0 && v[3] == 0' $(of bounce $engine 'error of missed_events')
            claim "$engine: and within 4.5 ms (1 % of the first)" "$(below 4.5e-3)" $(of_events bounce $engine 'error of event_time [s]')
            claim "$engine: its apices are within 1 %" "$(below 0.01)" $(of_events bounce $engine 'error of apex')
            claim "$engine: the block slides 1.178 m within 1 %" "$(below 0.01178)" $(of slide $engine 'error of position [m]')
            claim "$engine: the block sticks (within 0.1 mm)" "$(below 1e-4)" $(of stick $engine 'error of position [m]')
            claim "$engine: the ball rolls 1.752 m within 1 %" "$(below 0.01752)" $(of rolling $engine 'error of position [m]')
            claim "$engine: the slipping ball is within 1 % of its 1.51 m" "$(below 0.0151)" $(of slip $engine 'error of position [m]')
        }
    done
    # shellcheck disable=SC2046 # lists of words on purpose
    {
        claim 'bullet: the stack stands (within 1 mm)' "$(below 1e-3)" $(of stack bullet 'error of position [m]')
        claim 'bullet: a thousandfold mass stands on a light block (within 1 mm)' "$(below 1e-3)" $(of ratio_thousand bullet 'error of position [m]')
        claim 'bullet: a millionfold mass stands on a light block (within 1 mm)' "$(below 1e-3)" $(of ratio bullet 'error of position [m]')
        claim 'bullet: the energy of the pile never rises by more than 0.1 % (steps 10, 2, 1 ms)' "$(below 1e-3)" \
            "$(figure pile bullet 0.01 'error of energy_gain')" "$(figure pile bullet 0.002 'error of energy_gain')" "$(figure pile bullet 0.001 'error of energy_gain')"
        claim 'bullet: the pile takes at most 1.3 times the time of plain Bullet (steps 10, 2, 1 ms; ratios)' "$(below 1.3)" \
            $(for step in 0.01 0.002 0.001; do echo "$(figure pile bullet $step 'median [s]') $(figure pile bullet_plain $step 'median [s]')" |
                awk '{ if ($2 > 0) printf "%.2f ", $1 / $2; else printf "– " }'; done)
    }
}

write_page()
{
    cat <<'END'
# Rigid engines compared

Made by `./bootstrap compare` from runs of the scenes in `scenes/rigid`: each under the engines `bullet`, `bullet_plain`, `pbd` and
`analytic` ([what they are](rigid_engines.md)) at rigid steps of 10, 1 and 0.1 ms, where nothing else is said. Every figure comes from those runs.

- Errors are the largest over the run, from the motion in closed form that the scene's `reference` names. Without one they are
  taken from the finest run.
- Energy: error of kinetic and potential energy, over the largest of the exact motion (at rest: weight times radius). Gain:
  largest rise of the energy above an earlier value, over the same; where nothing drives a body there should be none.
- Angular momentum: error of a body's own, over its largest.
- Missed events: how many impacts of the bounce or flips of the top are missing or too many; their times and the apices between
  them are compared where none is. Surface: how far a point of the body can be at most from where it should be: the error of
  position plus the radius times the error of orientation.
- A measure that has no meaning in a scene has no column there.
- Run time: without set-up, with what a frame every 10 ms costs; one thread of a shared machine.
- A free obstacle (the rolling and slipping balls) is moved by one and the same code under `pbd` and `analytic`.
- Fragments see each other under `bullet` and `bullet_plain`: under the others the boxes of a stack fall through each other.
- `bullet_plain` has Bullet's own thresholds, in units of 5 cm where bodies meet, and hulls without a skin (the scenes'
  `bullet_plain`).

END
    comparisons | while IFS='|' read -r name rest; do section "$name"; done
    printf 'A pile is chaotic: runs part after the first impacts, so errors of position say only how large the pile is.\n'
    printf '\n## Error against run time\n\nThe top; largest error of a point of its surface:\n\n![top](rigid_top.svg)\n'
    printf '\n## What holds\n\n'
    claims
}

run_all
[ ! -s "$results/top/error_surface.svg" ] || cp "$results/top/error_surface.svg" "$root/docs/rigid_top.svg"
write_page >"$page.part"
mv "$page.part" "$page"
echo "compare: wrote docs/rigid_comparison.md" >&2
