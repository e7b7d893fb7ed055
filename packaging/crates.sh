#!/usr/bin/env bash
# Packs every crate that is published, in the order in which crates.io takes them; --publish publishes them.
set -euo pipefail
cd "$(dirname "$0")/.."
crates=(springpot springpot-report springpot-scenario springpot-run springpot-capi springpot-cli)
chosen=()
for crate in "${crates[@]}"; do
    chosen+=(--package "$crate")
done
if [ "${1:-}" = --publish ]; then
    cargo publish --locked "${chosen[@]}"
else
    # What stands on a crate of this tree is built from the packed one.
    cargo package --locked "${chosen[@]}" "$@"
fi
