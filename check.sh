#!/usr/bin/env bash
# Everything that must hold before a change is kept: format, lints, documentation, tests, and every scenario run.
#   ./check.sh              all of it
#   ./check.sh STEP ...     some of it: format lints engine oldest crates documentation book tests pages engines python scenarios
#   ./check.sh quick        while working: format, and lints and tests of the crates that differ from main (BASE names another commit)
set -euo pipefail
cd "$(dirname "$0")"
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
command=$target/suite/springpot

# What is built is built once: all steps take the profile suite, and the command and the C library that the tests have built.
build() { cargo test --workspace --profile suite --no-run --quiet; }

# What steps take from PyPI and npm comes while the tests are built; they say themselves what they cannot have.
tools() {
    for script in crates/springpot-{report/web,capi,py}/check.sh; do
        "$script" --tools >/dev/null 2>&1 || true
    done
}

format() { cargo fmt --all --check; }

lints() { cargo clippy --workspace --all-targets --quiet -- -D warnings; }

# Without URDF files.
engine() { cargo clippy --package springpot --no-default-features --quiet -- -D warnings; }

# The oldest Rust that is promised. Nothing is downloaded here: what is not at hand is said, not checked.
oldest() {
    local msrv oldest
    msrv=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
    oldest=$(rustup toolchain list 2>/dev/null | grep -oE "^${msrv//./\\.}(\.[0-9]+)?-[^ ]+" | head -n 1 || true)
    if [ -n "$oldest" ]; then
        cargo "+$oldest" check --workspace --quiet --target-dir "$target/oldest"
    else
        echo "Rust $msrv is not installed; clippy's incompatible_msrv has looked at the calls to std"
    fi
}

# Licences, versions, sources of the crates, and what is known against them.
crates() {
    if ! cargo deny --version >/dev/null 2>&1; then
        echo "cargo-deny is not installed: not checked"
        return
    elif ! cargo metadata --offline --locked --format-version 1 >/dev/null 2>&1; then
        echo "not all crates are downloaded (cargo fetch): not checked"
        return
    fi
    cargo deny --offline --log-level warn check licenses bans sources
    if compgen -G "${CARGO_HOME:-$HOME/.cargo}/advisory-dbs/*" >/dev/null; then
        cargo deny --offline --log-level warn check advisories
    else
        echo "no advisories are downloaded (cargo deny fetch): not checked"
    fi
}

documentation() { RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet; }

# Its commands, links and programs are among the tests.
book() {
    if ! mdbook --version >/dev/null 2>&1; then
        echo "mdbook is not installed: not built"
        return
    fi
    local book said
    book=$(mktemp -d)
    said=$(mdbook build docs -d "$book" 2>&1) || { echo "$said"; return 1; }
    rm -rf "$book"
    ! grep -E 'WARN|ERROR' <<<"$said"
}

tests() { cargo test --workspace --profile suite --quiet; }

pages() { build && SPRINGPOT=$command crates/springpot-report/web/check.sh; }

engines() { build && SPRINGPOT=$command crates/springpot-capi/check.sh; }

python() { crates/springpot-py/check.sh; }

scenarios() {
    build
    local out
    out=$(mktemp -d)
    for scenario in scenarios/*.toml; do
        echo "$scenario"
        "$command" run "$scenario" --out "$out/$(basename "$scenario" .toml)" || { rm -rf "$out"; return 1; }
    done
    rm -rf "$out"
}

quick() {
    local base packages=()
    base=$(git merge-base HEAD "${BASE:-main}")
    format
    while read -r crate; do
        [ -d "crates/$crate" ] && packages+=(--package "$crate")
    done < <({ git diff --name-only "$base"; git ls-files --others --exclude-standard; } | sed -n 's|^crates/\([^/]*\)/.*|\1|p' | sort -u)
    if [ "${#packages[@]}" -eq 0 ]; then
        echo "no crate differs from $base"
        return
    fi
    echo "${packages[@]}"
    cargo clippy "${packages[@]}" --all-targets --quiet -- -D warnings
    cargo test "${packages[@]}" --quiet
}

# What shares no build with the tests, what waits for a browser most of the time, and what else stands on the build of the tests.
without=(lints engine oldest crates documentation book)
waiting=(pages engines)
rest=(python scenarios)
known="quick format ${without[*]} tests ${waiting[*]} ${rest[*]}"
for step in "$@"; do
    case " $known " in
    *" $step "*) ;;
    *) echo "no step $step: there are $known" >&2 && exit 2 ;;
    esac
done

steps() {
    local TIMEFORMAT step
    for step in "$@"; do
        printf '\n== %s\n' "$step"
        TIMEFORMAT="$step: %0R s, %0U s of work"
        time "$step"
    done
}

# Steps beside those that follow; what they say comes in one piece, when they are joined.
declare -A lanes
beside() {
    (steps "${@:2}") >"$said/$1" 2>&1 &
    lanes[$1]=$!
}
join() {
    local ended=0
    wait "${lanes[$1]}" || ended=$?
    cat "$said/$1"
    return "$ended"
}

if [ "$#" -gt 0 ]; then
    steps "$@"
else
    said=$(mktemp -d)
    trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$said"' EXIT
    steps format
    tools &
    fetching=$!
    beside without "${without[@]}"
    steps tests
    wait "$fetching"
    beside waiting "${waiting[@]}"
    steps "${rest[@]}"
    join without
    join waiting
fi

printf '\nall checks passed\n'
