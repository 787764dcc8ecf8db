#!/bin/sh
# Prints the folder of the real scans that tests read, or fails where it is absent and
# PALPATE_NO_DATA=1 does not say to do without. The same rule stands in conftest.py.
set -eu

if [ "${PALPATE_NO_DATA:-}" = 1 ]; then
    echo "PALPATE_NO_DATA=1: tests on real scans will be left out"
    exit 0
fi
folder="${PALPATE_DATA:-$(dirname "$0")/../../shared/data}"
if [ ! -d "$folder" ]; then
    echo "missing: real scans in $folder" >&2
    echo "    set PALPATE_DATA to their folder, or PALPATE_NO_DATA=1 to leave those tests out" >&2
    exit 1
fi
cd "$folder" && pwd
