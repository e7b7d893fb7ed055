#!/usr/bin/env bash
# The command as an archive for this machine, or for TARGET: springpot-VERSION-TARGET.tar.gz (.zip on Windows) in OUT, dist/ unless said.
# Where cargo-auditable is installed the program carries the list of its crates.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${OUT:-dist}
target=${TARGET:-$(rustc -vV | sed -n 's/^host: //p')}
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
name=springpot-$version-$target
build=(build)
cargo auditable --version >/dev/null 2>&1 && build=(auditable build)
cargo "${build[@]}" --release --locked --package springpot-cli --target "$target"
ending=
case $target in *windows*) ending=.exe ;; esac
program=${CARGO_TARGET_DIR:-target}/$target/release/springpot$ending
folder=$(mktemp -d)
mkdir -p "$out" "$folder/$name/completions" "$folder/$name/man"
cp "$program" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE CITATION.cff "$folder/$name/"
cp crates/springpot-py/licenses/LICENSE-DejaVu.txt crates/springpot-py/licenses/LICENSE-three.txt "$folder/$name/"
cp -r scenarios "$folder/$name/"
# Only what runs here can say what it completes.
if "$program" --version; then
    for shell in bash zsh fish powershell; do
        "$program" completions "$shell" >"$folder/$name/completions/springpot.$shell"
    done
    "$program" man >"$folder/$name/man/springpot.1"
fi
out=$(cd "$out" && pwd)
if [ -n "$ending" ]; then
    (cd "$folder" && 7z a -bso0 "$out/$name.zip" "$name")
else
    tar -C "$folder" -czf "$out/$name.tar.gz" "$name"
fi
rm -rf "$folder"
ls -l "$out/$name".*
