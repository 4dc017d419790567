#!/bin/sh
# run.sh: has the model checker spin try every interleaving of the models of this folder; then breaks each model in several
# ways, each of which has to be found. Exit status 77, with a reason, where there is no spin. docs/measured/reliability.md: "Locks".
set -u
cd "$(dirname "$0")" || exit 1
for tool in spin "${CC:-cc}"; do
    command -v "$tool" >/dev/null 2>&1 || { echo "skipped: there is no $tool"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

# explore FLAGS MODEL DEFINITION...: builds and runs the checker; its report is left in $folder/report.
explore() {
    flags=$1 model=$2
    shift 2
    cp "$model.pml" "$folder/"
    # shellcheck disable=SC2086
    (cd "$folder" && rm -f pan* && spin "$@" -a "$model.pml" && "${CC:-cc}" -O2 -w -DCOLLAPSE -DMEMLIM=4096 $flags -o pan pan.c) \
        >"$folder/report" 2>&1 || return 1
    # shellcheck disable=SC2046
    (cd "$folder" && ./pan -m1000000 $([ "$flags" != -DNP ] || echo -l)) >"$folder/report" 2>&1
    grep -q 'errors:' "$folder/report" && ! grep -q 'search depth too small\|out of memory\|reached -DMEMLIM' "$folder/report"
}

states() { sed -n 's/^ *\([0-9]*\) states, stored.*/\1/p' "$folder/report"; }

# holds MODEL DEFINITION...: no assertion fails, no process waits for ever, and none runs for ever.
holds() {
    for search in -DSAFETY -DNP; do
        if explore $search "$@" && grep -q 'errors: 0' "$folder/report"; then
            echo "holds  $* $search: $(states) states"
        else
            echo "FAILS  $* $search"
            cat "$folder/report"
            failures=$((failures + 1))
        fi
    done
}

# finds MODEL BREAK DEFINITION...: the mistake is found.
finds() {
    model=$1 mistake=$2
    shift 2
    if explore -DSAFETY "$model" "-DBREAK=$mistake" "$@" && grep -q 'errors: [1-9]' "$folder/report"; then
        echo "finds  $model $mistake: $(sed -n '1s/^pan:[0-9]*: //p' "$folder/report")"
    else
        echo "MISSES $model $mistake"
        cat "$folder/report"
        failures=$((failures + 1))
    fi
}

holds gates -DMEMBERS=2
holds gates -DMEMBERS=3
finds gates looks_for_sleepers_first
finds gates sleeps_without_looking
finds gates arrived_reset_late

holds segments -DFAIL=false -DTHREADS=2
holds segments -DFAIL=true -DTHREADS=2
holds segments -DFAIL=false -DTHREADS=3 -DSEGMENTS=3 -DPOINTS=3 -DMEETS=1
finds segments racy_take -DFAIL=false
finds segments gives_back_early -DFAIL=false
finds segments keeps_at_end -DFAIL=false
finds segments forgets_deferred -DFAIL=false
finds segments failed_keeps_running -DFAIL=true

holds cavity -DTHREADS=2 -DPOINTS=1
finds cavity two_vertices
finds cavity gives_back_early
finds cavity takes_not_beyond
finds cavity forgets_undo

echo "model: $failures failures"
[ $failures = 0 ]
