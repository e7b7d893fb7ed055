"""States of arm.xml and bounds.xml with mass matrix and bias forces as MuJoCo has them, meshes taken as exact volumes: reference.json.

python testdata/mjcf/reference.py (mujoco 4.0, NumPy). Coordinates and velocities in the order and the axes of springpot: quaternions x y z w, of what
floats the linear velocity in its own axes.
"""

import json
import pathlib

import mujoco
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


FREE, BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)


def first(numbers, k):
    """Of numbers that newer versions have as powers beside one another the first."""
    return float(np.ravel(numbers[k])[0])


def reference(file):
    spec = mujoco.MjSpec.from_file(str(HERE / file))
    for mesh in spec.meshes:
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT
    model = spec.compile()
    random, states = np.random.default_rng(7), []
    for _ in range(3):
        data = mujoco.MjData(model)
        data.qpos[:] = random.uniform(-1, 1, model.nq)
        data.qvel[:] = random.uniform(-1, 1, model.nv)
        mujoco.mj_normalizeQuat(model, data.qpos)
        mujoco.mj_forward(model, data)
        q, turned, rate = data.qpos.copy(), np.eye(model.nv), np.zeros(model.nv)
        for joint in range(model.njnt):
            at, k = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
            kind = int(model.jnt_type[joint])
            if kind in (FREE, BALL):
                at += 3 if kind == FREE else 0
                w, x, y, z = data.qpos[at : at + 4]
                q[at : at + 4] = [x, y, z, w]
            if kind == FREE:
                matrix = np.zeros(9)
                mujoco.mju_quat2Mat(matrix, data.qpos[at : at + 4])
                turned[k : k + 3, k : k + 3] = matrix.reshape(3, 3)
        v = turned.T @ data.qvel
        for joint in range(model.njnt):
            if int(model.jnt_type[joint]) == FREE:
                k = model.jnt_dofadr[joint]
                rate[k : k + 3] = turned[k : k + 3, k : k + 3] @ np.cross(v[k + 3 : k + 6], v[k : k + 3])
        mass = np.zeros((model.nv, model.nv))
        try:
            mujoco.mj_fullM(model, mass, data.qM)
        except (AttributeError, TypeError):
            mujoco.mj_fullM(model, data, mass)
        # Armature is felt along the velocities of springpot, not along those of MuJoCo.
        bias = turned.T @ (data.qfrc_bias + (mass - np.diag(model.dof_armature)) @ rate)
        mass = turned.T @ mass @ turned
        states.append({"q": q.tolist(), "v": v.tolist(), "M": mass.tolist(), "bias": bias.tolist()})
    springs = [
        [first(model.jnt_stiffness, k), first(model.dof_damping, model.jnt_dofadr[k]), float(model.qpos_spring[model.jnt_qposadr[k]])]
        for k in range(model.njnt)
        if int(model.jnt_type[k]) not in (FREE, BALL)
    ]
    return {"file": file, "states": states, "springs": springs}


if __name__ == "__main__":
    found = [reference(file) for file in ["arm.xml", "bounds.xml"]]
    (HERE / "reference.json").write_text(json.dumps({"mujoco": mujoco.__version__, "robots": found}) + "\n")
