"""The stiff flyball governor of scenarios/flyball_governor.toml with MuJoCo: couplers as spatial tendons with stiffness and damping.

Reads from the standard input one line of JSON, {"runs": [[INTEGRATOR, STEP], ...], "t": [...], "s": [...]}: what to run, and where the slider is at
these times. Answers each run with a line "INTEGRATOR STEP SECONDS ERROR", the error the largest of the slider's place at these times, m.
Needs mujoco.
"""

import json
import math
import sys
import time

import mujoco

MODEL = """
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0 0 -9.81" timestep="{step}" integrator="{integrator}"/>
  <worldbody>
    <body name="shaft">
      <joint name="spin" type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0.5" mass="0.3" diaginertia="0.0250025 0.0250025 5e-6"/>
      <body name="slider">
        <joint name="s" type="slide" axis="0 0 1"/>
        <inertial pos="0 0 0" mass="3" diaginertia="0.005 0.005 0.005"/>
        <site name="s1" pos="0.05 0 0"/>
        <site name="s2" pos="-0.05 0 0"/>
      </body>
      <body name="rod1" pos="0.05 0 1">
        <joint name="a" type="hinge" axis="0 1 0"/>
        <inertial pos="0.9716981132075472 0 0" mass="5.3" diaginertia="5e-6 0.0957572169811321 0.0957572169811321"/>
        <site name="r1" pos="0.5 0 0"/>
      </body>
      <body name="rod2" pos="-0.05 0 1">
        <joint name="b" type="hinge" axis="0 -1 0"/>
        <inertial pos="-0.9716981132075472 0 0" mass="5.3" diaginertia="5e-6 0.0957572169811321 0.0957572169811321"/>
        <site name="r2" pos="-0.5 0 0"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="c1" stiffness="8e5" damping="4e4" springlength="0.5"><site site="s1"/><site site="r1"/></spatial>
    <spatial name="c2" stiffness="8e5" damping="4e4" springlength="0.5"><site site="s2"/><site site="r2"/></spatial>
  </tendon>
</mujoco>
"""


def run(integrator, step, times, places):
    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, integrator=integrator))
    data = mujoco.MjData(model)
    data.qpos[:] = [0.0, 0.5, math.pi / 6, math.pi / 6]
    data.qvel[0] = 2 * math.pi
    error, begun, done = 0.0, time.perf_counter(), 0
    for at, place in zip(times, places):
        steps = round(at / step) - done
        if steps > 0:
            mujoco.mj_step(model, data, nstep=steps)
            done += steps
        error = max(error, abs(data.qpos[1] - place))
    return time.perf_counter() - begun, error


asked = json.loads(sys.stdin.readline())
for integrator, step in asked["runs"]:
    seconds, error = run(integrator, step, asked["t"], asked["s"])
    print(integrator, step, seconds, error, flush=True)
