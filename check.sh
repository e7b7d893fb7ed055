#!/usr/bin/env bash
# Everything that must hold before a change is kept: format, lints, documentation, tests, and every scenario run.
set -euo pipefail
cd "$(dirname "$0")"

step() { printf '\n== %s\n' "$1"; }

step "format"
cargo fmt --all --check

step "lints"
cargo clippy --workspace --all-targets --quiet -- -D warnings

step "the engine without URDF files"
cargo clippy --package springpot --no-default-features --quiet -- -D warnings

# Nothing is downloaded here: what is not at hand is said, not checked.
msrv=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
step "Rust $msrv, the oldest that is promised"
oldest=$(rustup toolchain list 2>/dev/null | grep -oE "^${msrv//./\\.}(\.[0-9]+)?-[^ ]+" | head -n 1 || true)
if [ -n "$oldest" ]; then
    cargo "+$oldest" check --workspace --quiet --target-dir target/oldest
else
    echo "not installed; clippy's incompatible_msrv has looked at the calls to std"
fi

step "licences, versions and sources of the crates"
if ! cargo deny --version >/dev/null 2>&1; then
    echo "cargo-deny is not installed: not checked"
elif ! cargo metadata --offline --locked --format-version 1 >/dev/null 2>&1; then
    echo "not all crates are downloaded (cargo fetch): not checked"
else
    cargo deny --offline --log-level warn check licenses bans sources
fi

step "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

# Its commands, links and programs are among the tests.
step "the book"
if mdbook --version >/dev/null 2>&1; then
    book=$(mktemp -d)
    said=$(mdbook build docs -d "$book" 2>&1) || { echo "$said"; exit 1; }
    rm -rf "$book"
    if grep -E 'WARN|ERROR' <<<"$said"; then
        exit 1
    fi
else
    echo "mdbook is not installed: not built"
fi

step "tests"
cargo test --workspace --quiet

step "pages in a browser"
crates/springpot-report/web/check.sh

step "engines in C and FMUs"
crates/springpot-capi/check.sh

step "Python"
crates/springpot-py/check.sh

step "scenarios"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for scenario in scenarios/*.toml; do
    echo "$scenario"
    cargo run --quiet -- run "$scenario" --out "$out/$(basename "$scenario" .toml)"
done

printf '\nall checks passed\n'
