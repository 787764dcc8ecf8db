# Sourced at the head of a step of the Makefile: prints its name, shows its commands, and notes how
# long they took. `make test` and `make check` print what was noted (scripts/stages.sh).
# shellcheck shell=bash

# appends the name, seconds on the clock, seconds of all cores and exit code
_note_stage() {
    mkdir -p "$STAGES"
    times >"$STAGES/.times.$$"
    awk -v OFS='\t' -v name="$STAGE" -v wall="$SECONDS" -v code="$1" '
        { for (i = 1; i <= 2; ++i) { split($i, part, /[ms]/); cores += 60 * part[1] + part[2] } }
        END { print name, wall, int(cores + 0.5), code }' "$STAGES/.times.$$" >>"$STAGES/stages.tsv"
    rm "$STAGES/.times.$$"
}

STAGE=$1
STAGES=$PWD/target
SECONDS=0
trap 'exit 130' INT TERM
trap '{ code=$?; set +x; } 2>/dev/null; _note_stage $code' EXIT
# two steps may run at a time, and each uses both cores if it can
unset MAKEFLAGS
printf '\n\033[1m== %s\033[0m\n' "$STAGE"
PS4='$ '
set -x
