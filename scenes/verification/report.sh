#!/bin/sh
# Runs all verification cases with all their runs and writes docs/verification.md, and draws docs/concrete_beam.svg:
# report.sh PROGRAM. The tables as HTML lie in build/verification.
set -eu

program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
results=$root/build/verification
page=$root/docs/verification.md
mkdir -p "$results"

cd "$root"
# The crack on its way, and at the end.
draw_beam()
{
    "$program" run scenes/verification/concrete_beam.yaml --set output.nodes=true --output "$results/beam.h5" --force --quiet \
        --set 'objects.beam.mesh={gmsh: {file: meshes/concrete_beam.msh, scale: 0.001}}'
    "$program" export svg "$results/beam.h5" --output "$results/beam" --time 0.00085,0.0016 --force >/dev/null
    cp "$results/beam.svg" docs/concrete_beam.svg
}

draw_beam
status=0
"$program" verify --full --force --markdown "$results/tables.md" --html "$results/verification.html" >"$results/verify.txt" ||
    status=$?
[ -s "$results/tables.md" ] || exit "$status"
processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)

{
    cat <<'END'
# Verification

Scenes whose outcome is known from a closed form or from the literature, run and compared. This page is made by
`./bootstrap report`, which calls `scenes/verification/report.sh`; the numbers come from

```
shiver verify --full
```

A quantity passes when its error is within the tolerance: what is asked of the program, or what the method should reach on such a
mesh. Errors and tolerances are shares of the reference in percent, or absolute in the unit where the
reference is zero. "shown" is not judged: mostly a coarse mesh of a series whose finest one is. A miss is explained below its table;
`shiver verify` fails on one that is not. How a case is written is told in scenes/verification/README.md; what
was read of the sources, in [sources](sources.md).

END
    printf 'Run on %s, one thread a run. ' "${processor:-an unknown processor}"
    cat "$results/tables.md"
} >"$page.part"
mv "$page.part" "$page"
[ "$status" -eq 0 ] || echo "verification: something misses without an explanation, see docs/verification.md" >&2
