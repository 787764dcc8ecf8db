#!/bin/sh
# Checks what Palpate is built with, and says how to get what is missing.
set -u
missing=0

lacks() {
    echo "missing: $1" >&2
    echo "    get it: $2" >&2
    missing=1
}

# true where version $1 is at least $2, both as major.minor
at_least() {
    [ "$(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1)" = "$2" ]
}

python=$(command -v "${PYTHON:-python3}")
if [ -z "$python" ] || ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    lacks "Python 3.11 or newer (found: $("${python:-false}" --version 2>/dev/null || echo none))" \
        "apt install python3 python3-venv (Debian 12 or newer), or set PYTHON to another one"
elif ! "$python" -c 'import venv, ensurepip' 2>/dev/null; then
    lacks "Python's venv module" "apt install python3-venv"
fi

# the linker that Rust calls
command -v cc >/dev/null || lacks "a C compiler (cc)" "apt install gcc libc6-dev"

rust=$(cargo --version 2>/dev/null | cut -d ' ' -f 2)
if [ -z "$rust" ] || ! at_least "$rust" 1.90; then
    lacks "Rust 1.90 or newer (found: ${rust:-none})" \
        "apt install rustup && rustup default stable (Debian 13), or www.rust-lang.org/tools/install"
else
    rustfmt --version >/dev/null 2>&1 || lacks "rustfmt" "rustup component add rustfmt"
    cargo clippy --version >/dev/null 2>&1 || lacks "clippy" "rustup component add clippy"
fi

node=$(node --version 2>/dev/null | tr -d v)
if [ -z "$node" ] || ! at_least "$node" 20.19; then
    lacks "Node.js 20.19 or newer (found: ${node:-none})" \
        "apt install nodejs npm (Debian 13 or newer), or nodejs.org/en/download"
fi
command -v npm >/dev/null || lacks "npm" "apt install npm, or with Node.js from nodejs.org/en/download"

if [ "$missing" = 1 ]; then
    exit 1
fi
[ "${1:-}" = --quiet ] || echo "prerequisites: python $("$python" -c 'import platform; print(platform.python_version())')," \
    "rust $rust, node $node: all there"
