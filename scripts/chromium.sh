#!/bin/sh
# Prints the path of a Chromium for the browser tests.
#
# In this order: PALPATE_CHROMIUM, CHROMIUM, one in PATH, Debian's own (installed here where we are root).
# There is no silent way around: without a browser the tests fail.
set -eu

find_chromium() {
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        command -v "$name" && return 0
    done
    return 1
}

given="${PALPATE_CHROMIUM:-${CHROMIUM:-}}"
if [ -n "$given" ]; then
    if [ ! -x "$given" ]; then
        echo "PALPATE_CHROMIUM or CHROMIUM is '$given', which is no program" >&2
        exit 1
    fi
    echo "$given"
    exit 0
fi
find_chromium && exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing Debian's chromium for the browser tests" >&2
    apt-get update -qq >&2
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >&2
    find_chromium && exit 0
fi
echo "missing: Chromium for the browser tests" >&2
echo "    get it: apt install chromium, or set PALPATE_CHROMIUM to an installed one" >&2
exit 1
