#!/bin/sh
# A fused multiply-add rounds once where a product and a sum round twice: compilers that choose it differ in their bits. They
# are allowed where they are written out: by wide_fma and fma, in the files named here.
# usage: fused_operations.sh BUILD_FOLDER
set -eu
cd "$1"
command -v objdump >/dev/null || { echo "objdump is missing (Debian: binutils)"; exit 1; }
allowed=' solid/force.c solid/stress.c solid/energy.c solid/smoothing.c solid/step.c pbd/bar_sweep.c base/deterministic.c base/linear.c '
bad=0 looked=0 written_out=0
for object in CMakeFiles/shv_*.dir/src/*/*.o CMakeFiles/shv_bullet_bridge.dir/bullet_bridge/*.o; do
    looked=$((looked + 1))
    name=${object#CMakeFiles/shv_*.dir/}
    name=${name#src/}
    name=${name%.o}
    code=$(objdump -d --no-show-raw-insn "$object")
    alternating=$(printf '%s' "$code" | grep -cE 'vfm(addsub|subadd)[0-9]') || true
    fused=$(printf '%s' "$code" | grep -cE 'vfn?m(add|sub)[0-9]') || true
    case $allowed in
    *" $name "*) written_out=$((written_out + fused)) ;;
    *) [ "$fused" = 0 ] || { echo "$name: $fused fused operations that nobody wrote"; bad=1; } ;;
    esac
    [ "$alternating" = 0 ] || { echo "$name: $alternating fused products with alternating sums"; bad=1; }
done
[ "$looked" -gt 100 ] || { echo "only $looked object files were found"; exit 1; }
echo "$looked object files, $written_out fused operations, all of them written out"
exit $bad
