#!/bin/sh
# Runs the studies of this folder and writes docs/error_vs_run_time.md: report.sh PROGRAM
# Results lie in build/studies, a folder each with report.html; runs that are there already and still fit are not made again.
# To try it on smaller runs: SHIVER_STUDY_SET_top (and so on) has words KEY=VALUE, changes of that study's scene; results then go to
# SHIVER_STUDY_RESULTS and the page to SHIVER_STUDY_PAGE.
set -eu

program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
results=${SHIVER_STUDY_RESULTS:-$root/build/studies}
page=${SHIVER_STUDY_PAGE:-$root/docs/error_vs_run_time.md}
figures=$(dirname "$page")
mkdir -p "$results" "$figures"

# study | scene | title | figure: which measure
studies()
{
    cat <<'END'
top|rigid/torque_free_top|Torque-free top, I = (1, 2, 3), 55 s|surface
bounce|rigid/bouncing_ball|Bouncing ball, restitution 0.8, 2.4 s|position
sphere_drop|sphere_drop|Plaster ball on a floor, 2 ms around the impact|dissipated
tile|studies/glass_tile|Glass tile on a floor, 1 ms around the impact|dissipated
beam|thesis/fig_6_6_slow_beam|The chapter's beam, 8 ms of slow loading|dissipated
END
}

run_all()
{
    studies | while IFS='|' read -r name scene title figure; do
        echo "studies: $title" >&2
        set --
        eval "changes=\${SHIVER_STUDY_SET_$name:-}"
        # shellcheck disable=SC2154 # set by eval
        for key in $changes; do set -- "$@" --set "$key"; done
        if ! "$program" study "$root/scenes/$scene.yaml" "$root/scenes/studies/$name.yaml" "$@" \
            --output "$results/$name" >"$results/$name.txt" 2>"$results/$name.log" </dev/null; then
            echo "studies: that failed, see build/studies/$name.log" >&2
            rm -f "$results/$name/table.md"
        fi
    done
}

section()
{
    studies | while IFS='|' read -r name scene title figure; do
        printf '\n## %s\n\n[scene](../scenes/%s.yaml), [study](../scenes/studies/%s.yaml)\n\n' "$title" "$scene" "$name"
        if [ ! -s "$results/$name/table.md" ]; then
            echo 'It failed: no result.'
            continue
        fi
        sed -n '1s/^errors from \(.*\); \* on the Pareto front.*/Errors from the \1./p' "$results/$name.txt"
        echo
        cat "$results/$name/table.md"
        sed "s|$root/||g" "$results/$name/error_$figure.svg" >"$figures/study_$name.svg"
        printf '\n![%s](study_%s.svg)\n' "$title" "$name"
    done
}

# Of a study's two tables, row by row: setting, run time, error of a measure; nothing of failed runs and of the reference.
# Settings are keyed by the columns before "reference".
errors_and_times()
{
    awk -F, -v wanted="error of $2" '
        FNR == 1 {
            column = keys = 0
            for (i = 1; i <= NF; i++) {
                name = $i; sub(/ \[.*/, "", name)
                if (name == "reference") keys = i - 1
                if (name == wanted || name == "median") column = i
                if (name == "scatter of " substr(wanted, 10)) scatter_column = i
            }
        }
        FNR > 1 {
            key = $1; for (i = 2; i <= keys; i++) key = key "," $i
            good = $(keys + 1) == "" && $(keys + 2) == "ok"
            if (FILENAME ~ /timings/) { time[key] = $column; next }
            if (good && $column != "") { order[++count] = key; error[key] = $column }
            if (scatter_column) scatter = $scatter_column
        }
        END { for (i = 1; i <= count; i++) print order[i] "|" time[order[i]] "|" error[order[i]] "|" scatter + 0 }
    ' "$results/$1/results.csv" "$results/$1/timings.csv"
}

# worth STUDY MEASURE TITLE: whether any run with bars beats the explicit run at the stable step.
worth()
{
    [ -s "$results/$1/table.md" ] || return 0
    {
        errors_and_times "$1" fragments | sed 's/^/fragments|/'
        errors_and_times "$1" dissipated | sed 's/^/dissipated|/'
        errors_and_times "$1" "$2" | sed 's/^/errors|/'
    } | awk -F'|' -v title="$3" -v measure="$2" '
        { kind = $1; sub(/^[a-z]*\|/, ""); $0 = $0 }
        kind == "fragments" { fragments[$1] = $3; next }
        kind == "dissipated" { dissipated[$1] = $3; next }
        $1 ~ /^none,1(,|$)/ { explicit_time = $2; explicit_error = $3; found = 1 }
        $1 ~ /^bars/ {
            bars++
            setting[bars] = $1; time[bars] = $2; error[bars] = $3
            if (best == "" || $3 < error[best]) best = bars
        }
        { scatter = $4 }
        function words(key, part) { split(key, part, ","); return part[2] " stable steps, " part[3] " sweeps" }
        END {
            if (!found) { printf "| %s | %s | no result | | | |\n", title, measure; exit }
            cheap = ""
            for (i = 1; i <= bars; i++)
                if (time[i] < explicit_time && error[i] <= explicit_error + scatter && (cheap == "" || time[i] < time[cheap])) cheap = i
            printf "| %s | %s | %.2g | %.3g in %.3g s | ", title, measure, scatter, explicit_error, explicit_time
            if (best == "") printf "none finished | "
            else printf "%.3g in %.3g s (%s) | ", error[best], time[best], words(setting[best])
            if (cheap == "") printf "no |\n"
            else printf "yes, %s: %.3g, %.1f times cheaper; but there the errors of fragments and of dissipated energy are %.3g and %.3g |\n", words(setting[cheap]), error[cheap], explicit_time / time[cheap], fragments[setting[cheap]], dissipated[setting[cheap]]
        }'
}

# conclusion STUDY TITLE: a sentence from the errors of dissipated energy.
conclusion()
{
    [ -s "$results/$1/table.md" ] || return 0
    errors_and_times "$1" dissipated | awk -F'|' -v title="$2" -v all="$(grep -c '^| bars' "$results/$1/table.md")" \
        -v failed="$(grep -c '^| bars.*failed:' "$results/$1/table.md")" '
        $1 ~ /^none,1(,|$)/ { explicit_time = $2; explicit_error = $3; scatter = $4 }
        $1 ~ /^bars/ && (bars++ == 0 || $3 < error) { time = $2; error = $3; split($1, part, ",") }
        END {
            printf "- %s: the explicit run at one stable step is off by %.2g of the dissipated energy (scatter %.2g) in %.2g s. ", title, explicit_error, scatter, explicit_time
            printf "Of %d runs with bars %d fail", all, failed
            if (bars == 0) { print "."; exit }
            printf "; the best of the others (%s stable steps, %s sweeps) is off by %.2g in %.2g s. ", part[2], part[3], error, time
            if (error <= explicit_error + scatter) print "There a larger step is worth its error."
            else if (error < 0.2) print "A larger step is worth its error to whom that is good enough."
            else print "No larger step is worth its error."
        }'
}

worth_all()
{
    cat <<'END'

## Is a step beyond the stable one worth its error?

Bars (`fracture.stabiliser: bars`, k = 1) let fracture mode step beyond the stable step. The question is whether any of the runs
with bars is cheaper than the explicit run at one stable step and as good: its error at most that of the explicit run plus the
scatter between seeds.

| study | measure | scatter | explicit at one stable step | best with bars | any as good, and cheaper? |
|---|---|---|---|---|---|
END
    for measure in dissipated fragments largest_mass masses centre_velocity impulse; do
        worth sphere_drop $measure 'plaster ball'
    done
    for measure in dissipated fragments largest_mass masses centre_velocity impulse; do worth tile $measure 'glass tile'; done
    for measure in dissipated fragments largest_mass masses; do worth beam $measure "the chapter's beam"; done
    printf '\nBy the dissipated energy, which says how much broke:\n\n'
    conclusion sphere_drop 'Plaster ball'
    conclusion tile 'Glass tile'
    conclusion beam "The chapter's beam (its 30 µs are 1.03 stable steps here)"
    cat <<'END'

How to read it. Bars add a stiffness of about ρ (h/Δt)²/2 that belongs to no material (docs/stability.md); `bar_share` tells how
much of the stiffness is theirs, `bars_taken` and `bars_given` what they did to the energy. An error of fragments or dissipated energy
near 1 means that a body stayed whole that should have broken, and its low run time is that of a body with few cracks. An error
far above 1 means that it broke where it should not have. A small error of one measure beside a large one of another is chance. An
error close to the scatter means that the setting cannot be told from another member of the ensemble. Where `failed_overlap` of
explicit runs is as large as its scatter and that of `dissipated` is small, chance decides which facets break, and not how much breaks.
END
}

write_page()
{
    cat <<'END'
# Error against run time

Made by `./bootstrap report` from the studies in `scenes/studies`: what accuracy a second of computing buys. Every figure comes from
those runs; the same folder `build/studies` holds for each a page (`report.html`) with all figures. docs/study.md has the formulas.

- Run time: median of repeats, one run at a time, without making the simulation; one thread.
- Bold: on the Pareto front of that measure. Nothing cheaper is as good, and differences below the scatter count as none.
- Scatter: median error of five runs of the reference against each other, with other seeds of strength or with bodies shifted by
  1 nm (beam). Errors are medians over the same five members, each run against the reference's run of the same member.
- `step` (×): multiples of the stable step that `shiver check` reports. Steps fill the time to the next frame evenly, so that the
  Courant number, which is the largest of those taken, lies a little below.
- Meshes are coarse, so that all of this takes about ten minutes on one core: 2,500 tets (ball), 3,072 (tile), 13,520 (beam). The
  cohesive zones of plaster (3 mm) and glass (0.1 mm) are not resolved. The figures say how steps and methods differ on one mesh, not
  how far any of them is from the real body.
END
    section
    worth_all
    printf '\nMade on: %s.\n' "$(sed -n 's/.*"processor": "\([^"]*\)".*/\1/p' "$results/bounce/study.json" 2>/dev/null | head -n 1)"
}

run_all
write_page >"$page.part"
mv "$page.part" "$page"
echo "studies: wrote ${page#"$root"/}" >&2
