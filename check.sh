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

step "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

step "tests"
cargo test --workspace --quiet

step "scenarios"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for scenario in scenarios/*.toml; do
    echo "$scenario"
    cargo run --quiet -- run "$scenario" --out "$out/$(basename "$scenario" .toml)"
done

printf '\nall checks passed\n'
