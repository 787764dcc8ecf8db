#!/bin/sh
# Prints the path of a Chromium for the browser tests, and sees to it that Mesa can draw for it.
#
# In this order: PALPATE_CHROMIUM, CHROMIUM, one in PATH, Debian's own (installed here where we are root).
# Chromium draws by its own software GL; what that lacks (16-bit textures) is tested on Mesa's.
# There is no silent way around: without a browser the tests fail.
set -eu

find_chromium() {
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        command -v "$name" && return 0
    done
    return 1
}

install() {
    if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
        return 1
    fi
    echo "installing Debian's $* for the browser tests" >&2
    apt-get update -qq >&2
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >&2
}

# EGL and the drivers that draw on the CPU
if ! PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null | grep -q libEGL_mesa && ! install libegl1 libgles2 libgl1-mesa-dri; then
    echo "missing: Mesa's EGL, for tests of 16-bit textures" >&2
    echo "    get it: apt install libegl1 libgles2 libgl1-mesa-dri" >&2
fi

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
install chromium && find_chromium && exit 0
echo "missing: Chromium for the browser tests" >&2
echo "    get it: apt install chromium, or set PALPATE_CHROMIUM to an installed one" >&2
exit 1
