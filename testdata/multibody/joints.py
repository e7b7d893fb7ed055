"""Mixed trees of joints with rotors, by MuJoCo: writes joints.json beside this file.

python3 joints.py, with MuJoCo 4.0.0 and NumPy. Joints of several coordinates are several joints of one MuJoCo body, in their order; helical joints have no
counterpart there.
"""

import json
import pathlib

import mujoco
import numpy as np

rng = np.random.default_rng(29)
KINDS = ["revolute", "prismatic", "cylindrical", "universal", "planar", "spherical"]


def rotation(rpy):
    r, p, y = rpy
    x = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    t = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    z = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    return z @ t @ x


def quaternion(matrix):
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, matrix.flatten())
    return quat


def shortest(n):
    """The shortest turn that leads z to n, by its rotation vector."""
    up = np.array([0.0, 0.0, 1.0])
    about = np.cross(up, n)
    sine, cosine = np.linalg.norm(about), up @ n
    if sine == 0.0:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    x, y, z = about / sine
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sine * k + (1 - cosine) * k @ k


def unit(v):
    return np.asarray(v) / np.linalg.norm(v)


def tree(kinds, chain):
    bodies = []
    for i, kind in enumerate(kinds):
        a = rng.normal(size=(3, 3))
        second = a @ a.T * 0.05 + 0.02 * np.eye(3)
        inertia = np.trace(second) * np.eye(3) - second
        bodies.append({
            "parent": None if i == 0 else (i - 1 if chain else int(rng.integers(0, i))),
            "kind": kind,
            "axis": rng.normal(size=3).tolist(),
            "axis2": rng.normal(size=3).tolist(),
            "origin": rng.uniform(-0.6, 0.6, 3).tolist(),
            "rpy": rng.uniform(-3, 3, 3).tolist(),
            "armature": rng.uniform(0, 0.4, 3).tolist(),
            "mass": float(rng.uniform(0.5, 3)),
            "com": rng.uniform(-0.3, 0.3, 3).tolist(),
            "inertia": inertia.tolist(),
        })
    return bodies


def joints(body):
    axis, second = unit(body["axis"]), unit(body["axis2"])
    turned = shortest(axis)
    table = {
        "revolute": [("hinge", axis)],
        "prismatic": [("slide", axis)],
        "cylindrical": [("slide", axis), ("hinge", axis)],
        "universal": [("hinge", axis), ("hinge", second)],
        "planar": [("slide", turned[:, 0]), ("slide", turned[:, 1]), ("hinge", axis)],
        "spherical": [("ball", None)],
    }
    return table[body["kind"]]


def numbers(values):
    return " ".join(repr(float(v)) for v in values)


def mjcf(bodies, gravity):
    def one(i):
        body = bodies[i]
        j = body["inertia"]
        full = [j[0][0], j[1][1], j[2][2], j[0][1], j[0][2], j[1][2]]
        text = f'<body pos="{numbers(body["origin"])}" quat="{numbers(quaternion(rotation(body["rpy"])))}">'
        text += f'<inertial pos="{numbers(body["com"])}" mass="{body["mass"]!r}" fullinertia="{numbers(full)}"/>'
        for k, (kind, axis) in enumerate(joints(body)):
            # A spherical joint has no rotor.
            own = "" if axis is None else f'axis="{numbers(axis)}" armature="{body["armature"][k]!r}"'
            text += f'<joint type="{kind}" {own}/>'
        text += "".join(one(k) for k, other in enumerate(bodies) if other["parent"] == i)
        return text + "</body>"

    roots = "".join(one(i) for i, body in enumerate(bodies) if body["parent"] is None)
    return (
        f'<mujoco><compiler autolimits="true" boundmass="0" boundinertia="0" balanceinertia="false"/>'
        f'<option gravity="{numbers(gravity)}"><flag contact="disable" constraint="disable" energy="enable"/></option>'
        f"<worldbody>{roots}</worldbody></mujoco>"
    )


def order(bodies):
    """Bodies in MuJoCo's order: depth first."""
    found = []

    def visit(i):
        found.append(i)
        for k, other in enumerate(bodies):
            if other["parent"] == i:
                visit(k)

    for i, body in enumerate(bodies):
        if body["parent"] is None:
            visit(i)
    return found


def states(bodies, gravity, count):
    model = mujoco.MjModel.from_xml_string(mjcf(bodies, gravity))
    data = mujoco.MjData(model)
    # Where MuJoCo has the numbers of each body, and the same in the order of the bodies here.
    q_of, v_of, q_at, v_at = {}, {}, 0, 0
    for i in order(bodies):
        nq = sum(4 if kind == "ball" else 1 for kind, _ in joints(bodies[i]))
        nv = sum(3 if kind == "ball" else 1 for kind, _ in joints(bodies[i]))
        # x y z w here, w x y z there.
        q_of[i] = [q_at + 1, q_at + 2, q_at + 3, q_at] if nq == 4 else list(range(q_at, q_at + nq))
        v_of[i] = list(range(v_at, v_at + nv))
        q_at, v_at = q_at + nq, v_at + nv
    q_map = [k for i in range(len(bodies)) for k in q_of[i]]
    v_map = [k for i in range(len(bodies)) for k in v_of[i]]
    rows = []
    for _ in range(count):
        q, v, tau = rng.uniform(-2, 2, q_at), rng.uniform(-2, 2, v_at), rng.uniform(-5, 5, v_at)
        data.qpos[q_map] = q
        mujoco.mj_normalizeQuat(model, data.qpos)
        data.qvel[v_map], data.qfrc_applied[v_map] = v, tau
        mujoco.mj_forward(model, data)
        mass = np.zeros((v_at, v_at))
        mujoco.mj_fullM(model, mass, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, mass)
        rows.append({
            "q": data.qpos[q_map].tolist(), "v": v.tolist(), "tau": tau.tolist(),
            "mass": mass[np.ix_(v_map, v_map)].tolist(), "bias": data.qfrc_bias[v_map].tolist(),
            "a": data.qacc[v_map].tolist(), "energy": data.energy.tolist(),
        })
    return rows


gravity = [0.3, -0.7, -9.81]
trees = [tree(KINDS, True), tree(KINDS[::-1], False), tree(list(rng.permutation(KINDS * 2)), False), tree(["spherical", "planar", "universal"], True)]
trees = [[{**body, "kind": str(body["kind"])} for body in one] for one in trees]
written = {
    "made_by": f"joints.py with MuJoCo {mujoco.__version__}",
    "gravity": gravity,
    "trees": [{"bodies": one, "states": states(one, gravity, 4)} for one in trees],
}
pathlib.Path(__file__).with_name("joints.json").write_text(json.dumps(written) + "\n")
