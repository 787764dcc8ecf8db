#!/bin/bash
# Prints how long the steps took that scripts/stage.sh noted since `stages.sh --begin`.
set -eu
cd "$(dirname "$0")/.."
noted=target/stages.tsv

if [ "${1:-}" = --begin ]; then
    mkdir -p target
    printf 'begin\t%s\n' "$(date +%s)" >$noted
    exit 0
fi

awk -F '\t' -v now="$(date +%s)" '
    function clock(seconds) { return sprintf("%d:%02d", seconds / 60, seconds % 60) }
    BEGIN { printf "\n\033[1m== %-30s %9s %12s\033[0m\n", "step", "min:s", "of all cores" }
    $1 == "begin" { began = $2; next }
    { printf "   %-30s %9s %12s%s\n", $1, clock($2), clock($3), $4 == 0 ? "" : "   failed"; cores += $3 }
    END { printf "   %-30s %9s %12s\n", "the whole, steps side by side", clock(now - began), clock(cores) }
' $noted
