"""Rigid-body algorithms called from Python: Springpot, Pinocchio and MuJoCo in turn, medians of one run.

``python bench/algorithms.py [URDF] [ROUNDS]``; needs ``pin`` and ``mujoco`` from PyPI. MuJoCo reads the same URDF file. The engine's own batch is
timed in turn with ours where ``cargo build --release -p springpot --example batch`` has been called.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import springpot as sp

ROOT = Path(__file__).resolve().parents[3]


def median_of(calls, rounds, number):
    """Median seconds of one call of each, called ``number`` times in turn."""
    taken = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            begun = time.perf_counter()
            for _ in range(number):
                call()
            taken[name].append((time.perf_counter() - begun) / number)
    return {name: float(np.median(times)) for name, times in taken.items()}


def main(urdf=ROOT / "testdata/multibody/ur5.urdf", rounds=41):
    robot = sp.Model.from_urdf(urdf)
    q = robot.random(seed=1)
    v, a = np.linspace(-1, 1, robot.nv), np.linspace(1, -1, robot.nv)
    many = robot.random(seed=2, count=100_000)
    vs, as_ = np.tile(v, (100_000, 1)), np.tile(a, (100_000, 1))
    out = np.empty_like(vs)
    rnea = {"springpot": lambda: robot.rnea(q, v, a)}
    aba = {"springpot": lambda: robot.aba(q, v, a)}
    crba = {"springpot": lambda: robot.crba(q)}
    batch = {"springpot": lambda: robot.rnea(many, vs, as_, out=out)}
    try:
        import pinocchio as pin

        model = pin.buildModelFromUrdf(str(urdf))
        data = model.createData()
        assert np.allclose(pin.rnea(model, data, q, v, a), robot.rnea(q, v, a), atol=1e-9)
        rnea["pin"] = lambda: pin.rnea(model, data, q, v, a)
        aba["pin"] = lambda: pin.aba(model, data, q, v, a)
        crba["pin"] = lambda: pin.crba(model, data, q)
        batch["pin, a loop"] = lambda: [pin.rnea(model, data, x, v, a) for x in many[:1000]]
    except ImportError:
        print("pin is not installed")
    try:
        import mujoco

        spec = mujoco.MjSpec.from_file(str(urdf))
        # Shapes have nothing to do with the algorithms.
        for shape in [*spec.geoms, *spec.meshes]:
            spec.delete(shape)
        mj = spec.compile()
        state = mujoco.MjData(mj)
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a

        def inverse():
            mujoco.mj_inverse(mj, state)

        rnea["mujoco mj_inverse"] = inverse
        aba["mujoco mj_forward"] = lambda: mujoco.mj_forward(mj, state)
    except Exception as error:
        print(f"mujoco: {error}")
    print("| call | microseconds, median |")
    print("|---|---|")
    for title, calls in [("rnea", rnea), ("aba", aba), ("crba", crba)]:
        for name, seconds in median_of(calls, rounds, 2000).items():
            print(f"| {title}, {name} | {1e6 * seconds:.2f} |")
    for name, seconds in median_of(batch, max(5, rounds // 4), 1).items():
        count = 1000 if "loop" in name else 100_000
        print(f"| rnea of {count} states, {name}, each | {1e6 * seconds / count:.3f} |")
    beside_rust(urdf, batch["springpot"])


def beside_rust(urdf, batch):
    """Medians of 15 batches of 10⁵ states, Python's and Rust's in turn."""
    example = ROOT / "target/release/examples/batch"
    if not example.exists():
        print("the engine's own batch is not built")
        return
    for _ in range(5):
        own = median_of({"": batch}, 15, 1)[""]
        rust = subprocess.run([example, urdf], capture_output=True, text=True, check=True).stdout
        print(f"batch: {1e4 * own:.0f} ns a state from Python; Rust: {rust.strip()}")


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]))
