#!/bin/sh
# Prints the path of a Firefox for the test of Mesa's llvmpipe, and sees to it that it has a display to draw on.
#
# In this order: PALPATE_FIREFOX, one in PATH, Debian's own (installed here where we are root).
# Headless Firefox has no WebGL where the CPU draws, so that it gets a screen of Xvfb.
# There is no silent way around: without a browser the test fails.
set -eu

find_firefox() {
    command -v Xvfb >/dev/null || return 1
    if [ -n "${PALPATE_FIREFOX:-}" ]; then
        command -v "$PALPATE_FIREFOX"
        return
    fi
    command -v firefox || command -v firefox-esr
}

find_firefox && exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing Debian's firefox-esr and xvfb for the browser tests" >&2
    apt-get update -qq >&2
    DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends firefox-esr xvfb libgl1 libgl1-mesa-dri >&2
    find_firefox && exit 0
fi
echo "missing: Firefox and Xvfb for the browser tests" >&2
echo "    get them: apt install firefox-esr xvfb libgl1-mesa-dri, or set PALPATE_FIREFOX to an installed one" >&2
exit 1
