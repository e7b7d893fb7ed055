#!/usr/bin/env bash
# Builds the page anew, makes pages, reports and models of runs with the command itself, uses them in a browser and validates the models. SPRINGPOT names the command, BROWSER the browser.
# --tools: only gets what it takes.
set -euo pipefail
cd "$(dirname "$0")"

skip() {
    echo "pages in a browser: skipped, $1"
    exit 0
}

node -e 'process.exit(parseInt(process.versions.node) < 20 ? 1 : 0)' 2>/dev/null || skip "no Node.js 20 or later is here"
command -v npm >/dev/null || skip "no npm is here"
# BROWSER may name one that is no Chromium, as desktops do.
found=
for name in "${BROWSER:-}" chromium chromium-browser google-chrome google-chrome-stable; do
    [ -n "$name" ] && program=$(command -v "$name") || continue
    case $("$program" --version 2>/dev/null) in *Chrom*) found=$program && break ;; esac
done
[ -n "$found" ] || skip "no Chromium is here (BROWSER names one)"
BROWSER=$found
export BROWSER

# The tools come from the registry once; what is already there needs no network.
if ! cmp -s package-lock.json node_modules/.of-lock; then
    npm ci --prefer-offline --no-audit --no-fund --silent --fetch-retries 1 --fetch-timeout 20000 >/dev/null 2>&1 ||
        skip "the npm registry is out of reach, and what package-lock.json names is not in node_modules"
    cp package-lock.json node_modules/.of-lock
fi
[ "${1:-}" != --tools ] || exit 0

tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

node build.mjs "$tmp/assets" >/dev/null
for file in "$tmp/assets"/*; do
    cmp "$file" "../assets/$(basename "$file")" || { echo "../assets is not what src gives: npm run build" >&2; exit 1; }
done

repository=$(cd ../../.. && pwd)
springpot() {
    if [ -n "${SPRINGPOT:-}" ]; then "$SPRINGPOT" "$@"; else cargo run --quiet --manifest-path "$repository/Cargo.toml" -- "$@"; fi
}
page() { # NAME SCENARIO; what a run warns of is not about pages
    local out
    out=$tmp/pages/$(basename "$2" .toml)
    springpot run "$2" --out "$out" --view --no-figures --quiet 2>"$tmp/warnings" || { cat "$tmp/warnings" >&2; exit 1; }
    mv "$out/view.html" "$tmp/pages/$1.html"
    [ "$out" = "$tmp/pages/$1" ] || mv "$out" "$tmp/pages/$1"
}
report() { # NAME SCENARIO [BESIDE]; with the scenario's figures, and compared with a run that came before
    springpot run "$2" --out "$tmp/reports/$1" --quiet 2>"$tmp/warnings" || { cat "$tmp/warnings" >&2; exit 1; }
    springpot report "$tmp/reports/$1" >/dev/null
    if [ -n "${3:-}" ]; then springpot report "$tmp/reports/$1" "$tmp/reports/$3" >/dev/null; fi
}
model() { # NAME
    springpot export "$tmp/pages/$1" "$tmp/models/$1.glb" >/dev/null 2>&1 && springpot export "$tmp/pages/$1" "$tmp/models/$1.gltf" >/dev/null 2>&1
}
for name in falling_piezo piezo_order point_to_point torsional_coupling bumper panda_drop tendon_finger piezo_stack tool_damper; do
    page "$name" "$repository/scenarios/$name.toml"
done
page hostile "$(node test/hostile.mjs "$tmp/hostile")"
page humanoid "$(node test/humanoid.mjs "$tmp/humanoid")"
for name in panda_strut_and_strap point_to_point bumper piezo_stack; do
    report "$name" "$repository/scenarios/$name.toml"
done
report thermoviscoelastic_order "$repository/scenarios/thermoviscoelastic_order.toml" panda_strut_and_strap
report hostile "$tmp/hostile/$(ls "$tmp/hostile" | grep '\.toml$')" thermoviscoelastic_order
mkdir "$tmp/models"
for name in falling_piezo panda_drop tendon_finger torsional_coupling humanoid; do
    model "$name"
done

node --test --test-reporter=spec test/shape.test.mjs >"$tmp/tests" || { cat "$tmp/tests" >&2; exit 1; }
grep -E '^ℹ (tests|pass|fail)' "$tmp/tests"
REPORTS="$tmp/reports" node --test --test-reporter=spec test/report.test.mjs >"$tmp/tests" || { cat "$tmp/tests" >&2; exit 1; }
grep -E '^ℹ (tests|pass|fail)' "$tmp/tests"
MODELS="$tmp/models" node --test --test-reporter=spec test/gltf.test.mjs >"$tmp/tests" || { cat "$tmp/tests" >&2; exit 1; }
grep -E '^ℹ (tests|pass|fail)' "$tmp/tests"
PAGES="$tmp/pages" node --test --test-reporter=spec test/pages.test.mjs >"$tmp/tests" || { cat "$tmp/tests" >&2; exit 1; }
grep -E 'per frame|^ℹ (tests|pass|fail|skipped|duration)' "$tmp/tests"
echo "pages in a browser: all checks passed"
