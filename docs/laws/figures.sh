#!/bin/sh
# Remakes all figures of the laws: docs/laws/figures/*.svg from docs/laws/scenarios/*.toml. `springpot` must be found in PATH.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
for scenario in "$here"/scenarios/*.toml; do
    springpot run "$scenario" --out "$results/$(basename "$scenario" .toml)" --quiet
done
mkdir -p "$here/figures"
rm -f "$here"/figures/*.svg
cp "$results"/*/figures/*.svg "$here/figures/"
