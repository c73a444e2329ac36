#!/bin/sh
# Each module may include only the modules named for it here; the public headers are everybody's.
# usage: include_directions.sh SOURCE_FOLDER
set -eu
cd "$1"
allowed()
{
    case $1 in
    base) echo base ;;
    mesh) echo base mesh ;;
    model) echo base mesh model ;;
    solid) echo base mesh model solid ;;
    cohesive) echo base mesh model cohesive ;;
    shape) echo base mesh model shape ;;
    fragment) echo base mesh model cohesive fragment ;;
    convex) echo base mesh model fragment convex ;;
    conditions) echo base mesh model conditions ;;
    contact) echo base mesh model solid cohesive shape bullet_bridge contact ;;
    rigid) echo base mesh model cohesive shape bullet_bridge fragment convex rigid ;;
    pbd) echo base mesh model solid cohesive shape fragment rigid pbd ;;
    probes) echo base mesh model solid cohesive shape fragment conditions contact pbd probes ;;
    coupling) echo base mesh model solid cohesive shape fragment conditions contact rigid pbd probes coupling ;;
    sim) echo base mesh model solid cohesive shape bullet_bridge fragment convex conditions contact rigid pbd probes coupling sim ;;
    scene) echo base scene ;;
    record) echo base record ;;
    export) echo base record export ;;
    view) echo base convex export view ;;
    evaluate) echo base shape scene record export evaluate ;;
    stability) echo base mesh model solid scene coupling export evaluate stability ;;
    survive) echo base scene export evaluate survive ;;
    cli) echo base mesh cli ;;
    *) echo "unknown" ;;
    esac
}
bad=0
for folder in src/*/; do
    module=$(basename "$folder")
    may=" $(allowed "$module") "
    case $may in *unknown*) echo "src/$module is not in tests/include_directions.sh"; bad=1; continue ;; esac
    for file in "$folder"*.[ch]; do
        for included in $(sed -n 's/^#include "\([^"]*\)\/[^"]*".*/\1/p' "$file" | sort -u); do
            [ "$included" = shiver ] && continue
            case $may in *" $included "*) ;; *) echo "$file includes $included/, which $module may not know"; bad=1 ;; esac
        done
    done
done
for file in include/shiver/*.h; do
    grep -nE '#include "(base|mesh|model|solid|cohesive|shape|fragment|convex|conditions|contact|rigid|pbd|probes|coupling|sim|scene|record|export|view|evaluate|stability|survive|cli)/' "$file" && bad=1
done
exit $bad
