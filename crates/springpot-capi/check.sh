#!/usr/bin/env bash
# What needs more than Rust: the header against cbindgen, FMUs in FMPy. What is not at hand is said, not checked.
# --write renews the header; --tools only gets what FMUs take.
set -euo pipefail
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-$PWD/../../target}
mkdir -p "$target"

# The header is made of the two files that C sees.
header() {
    if ! command -v cbindgen >/dev/null; then
        echo "cbindgen is not installed (cargo install cbindgen): the header is not compared"
        return
    fi
    made=$(mktemp -d)
    trap 'rm -rf "$made"' EXIT
    sed '/^\/\/!/d' src/status.rs src/c.rs >"$made/c.rs"
    cbindgen --quiet --config cbindgen.toml --output "$made/springpot.h" "$made/c.rs"
    if [ "${1:-}" = --write ]; then
        cp "$made/springpot.h" include/springpot.h
    fi
    diff -u include/springpot.h "$made/springpot.h" || { echo "include/springpot.h is not what cbindgen makes: run $0 --write"; exit 1; }
}

[ "${1:-}" = --tools ] || header "$@"

python=$(command -v python3 || true)
venv=$target/fmu-venv
if [ -z "$python" ]; then
    echo "no python3: FMUs are not checked"
    exit 0
fi
if ! "$venv/bin/python" -c "import fmpy, pytest" 2>/dev/null; then
    if ! { "$python" -m venv "$venv" && "$venv/bin/pip" install --quiet "fmpy==0.3.*" "pytest>=8" numpy; } >"$target/fmu-venv.log" 2>&1; then
        echo "FMPy cannot be installed ($target/fmu-venv.log): FMUs are not checked"
        exit 0
    fi
fi
[ "${1:-}" != --tools ] || exit 0

# SPRINGPOT names a command that is built already, beside its library.
if [ -z "${SPRINGPOT:-}" ]; then
    cargo build --quiet -p springpot-capi -p springpot-cli
    cargo build --quiet -p springpot-capi --example own_laws
fi
SPRINGPOT="${SPRINGPOT:-$target/debug/springpot}" "$venv/bin/python" -m pytest --quiet -p no:cacheprovider tests/fmu.py
