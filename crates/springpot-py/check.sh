#!/usr/bin/env bash
# Installs the package into a virtual environment of its own and runs all that must hold of it: tests with doctests and types, examples.
# --tools: only gets what they take.
set -euo pipefail
cd "$(dirname "$0")"

skip() {
    echo "springpot-py: skipped, $1"
    exit 0
}

python=
for candidate in "${PYTHON:-python3}" python3.14 python3.13 python3.12 python3.11 python3.10; do
    if "$candidate" -c 'import sys, venv; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
        python=$candidate
        break
    fi
done
[ -n "$python" ] || skip "no Python 3.10 or later is here"

target=${CARGO_TARGET_DIR:-../../target}
mkdir -p "$target"
venv=$(cd "$target" && pwd)/springpot-py
[ -d "$venv" ] || "$python" -m venv "$venv" 2>/dev/null || skip "$python makes no virtual environments (python3-venv)"
bin=$venv/bin
[ -d "$bin" ] || bin=$venv/Scripts
# The build backend calls maturin by its name.
export PATH="$bin:$PATH"
pip() { "$bin/python" -m pip --disable-pip-version-check --quiet "$@"; }

# The tools come from PyPI once; what is already there needs no network.
if ! "$bin/python" -c 'import distributed, matplotlib, maturin, mypy, numpy, pandas, polars, pytest, scipy' 2>/dev/null; then
    pip install --timeout 10 --retries 1 'distributed>=2024.1' 'matplotlib>=3.8' 'maturin>=1.9,<2' 'mypy>=1.11' 'numpy>=1.26' 'pandas>=2' \
        'polars>=1' 'pytest>=8' 'scipy>=1.11' 2>/dev/null ||
        skip "PyPI is out of reach, and what the tests need is not all in $venv"
fi
# Other engines are extras: where they cannot be had, their tests are skipped.
if ! "$bin/python" -c 'import mujoco, pinocchio' 2>/dev/null; then
    pip install --timeout 10 --retries 1 'mujoco>=3.2' 'pin>=3.9' 2>/dev/null || echo "springpot-py: MuJoCo or Pinocchio cannot be had, their tests are skipped"
fi
# So are readers of recordings.
if ! "$bin/python" -c 'import mcap, mcap_ros2' 2>/dev/null; then
    pip install --timeout 10 --retries 1 'mcap>=1.2' 'mcap-ros2-support>=0.5' 2>/dev/null || echo "springpot-py: mcap cannot be had, its tests are skipped"
fi
[ "${1:-}" != --tools ] || exit 0
if [ -n "${WHEEL:-}" ]; then
    pip install --force-reinstall --no-deps "$WHEEL"
else
    # The profile of the tests in Rust, which have built the engine already.
    MATURIN_PEP517_ARGS=${MATURIN_PEP517_ARGS:---profile suite} pip install --no-build-isolation --force-reinstall --no-deps .
fi

# Not from here: what was installed is what is tested.
cd tests
"$bin/python" -m pytest --quiet -p no:cacheprovider .
"$bin/python" ../examples/one_mass.py 2 50 0.5 50 -19.62 0 0 0.5 1 2
"$bin/springpot" --version
echo "springpot-py: all checks passed"
