#!/bin/sh
# Writes python/requirements.lock: the exact version of every Python package, for use and
# for development. Run through `make lock`, on the oldest Python that is supported.
set -eu
cd "$(dirname "$0")/../python"

tools=$(mktemp -d)
trap 'rm -rf "$tools"' EXIT
python3 -m venv "$tools"
"$tools/bin/pip" install --quiet "pip-tools==7.6.2"

CUSTOM_COMPILE_COMMAND="make lock" "$tools/bin/pip-compile" --quiet --extra dev --strip-extras \
    --no-emit-options --no-emit-index-url --no-emit-find-links --no-emit-trusted-host \
    --annotation-style line --output-file requirements.lock "$@" pyproject.toml
