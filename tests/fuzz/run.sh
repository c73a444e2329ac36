#!/bin/sh
# Runs fuzzers, each for so many seconds of processor time; what they find is kept beside the build and ends with a failure.
# libraries.sh: with HDF5 and libfyaml instrumented, too.
# usage: run.sh SECONDS [READER …]
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$root/build/fuzz
seconds=$1
shift
[ $# -gt 0 ] || set -- scene set gmsh stl ply obj tetgen study case formula run_file

# What the scenes of the source tree give, beside the kept corpus.
seeds()
{
    case $1 in
    scene) find "$root/scenes" -name '*.yaml' ! -name '*.case.yaml' ! -path '*/studies/*' ;;
    case) find "$root/scenes" -name '*.case.yaml' ;;
    study) find "$root/scenes/studies" -name '*.yaml' ;;
    esac
}

# How many bytes: whole run files, and all of the others' seeds.
longest()
{
    case $1 in run_file) echo 1000000 ;; *) echo 20000 ;; esac
}

words()
{
    case $1 in scene | set | study | case) echo "-dict=$root/tests/fuzz/yaml.dict" ;; esac
}

bad=0
for reader in "$@"; do
    work=$folder/corpus/$reader
    mkdir -p "$work" "$folder/found"
    seeds "$reader" | while read -r file; do cp "$file" "$work/seed-$(basename "$(dirname "$file")")-$(basename "$file")"; done
    if [ "$reader" = run_file ] && [ -x "$root/build/release/shiver" ]; then
        for scene in scenes/extreme/24_parts.yaml tests/fuzz/run.yaml; do
            "$root/build/release/shiver" run "$root/$scene" --quiet --force --output "$work/seed-$(basename "$scene" .yaml).h5"
        done
    fi
    kept=$root/tests/fuzz/corpus/$reader
    [ -d "$kept" ] || kept=
    echo "== $reader"
    if ! LSAN_OPTIONS=suppressions=$root/tests/fuzz/leaks.txt:print_suppressions=0 \
        ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1 "$folder/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" \
        -timeout=20 -rss_limit_mb=2048 -max_len="$(longest "$reader")" $(words "$reader") -close_fd_mask=0 -print_final_stats=1 -verbosity=0 \
        -artifact_prefix="$folder/found/$reader-" "$work" ${kept:+"$kept"} >"$folder/$reader.log" 2>&1; then
        echo "fuzz: $reader found something, see $folder/$reader.log" >&2
        tail -n 30 "$folder/$reader.log" >&2
        bad=1
    else
        grep 'number_of_executed_units' "$folder/$reader.log" || true
    fi
done
exit $bad
