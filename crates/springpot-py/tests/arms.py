"""One arm, written for each engine: two links, and a strut from the world to the second of them."""

from __future__ import annotations

START = (0.4, -0.9)

SCENARIO = """
[[robot.body]]
name = "upper"
joint = {{ name = "q1", kind = "revolute", axis = [0, 1, 0] }}
mass = 1.2
com = [0.15, 0.02, 0.01]
inertia = {{ xx = 0.002, yy = 0.011, zz = 0.012 }}
[[robot.body]]
name = "lower"
joint = {{ name = "q2", kind = "revolute", axis = [0.6, 0.8, 0], origin = [0.3, 0, 0] }}
mass = 0.8
com = [0.1, 0, -0.01]
inertia = {{ xx = 0.001, yy = 0.006, zz = 0.005 }}
[[element]]
name = "strut"
from = {{ body = "world", point = [0.05, 0.1, -0.35] }}
to = {{ body = "lower", point = [0.12, 0.03, 0.02] }}
rest_length = "42 cm"
law = "fractional-kelvin-voigt"
parameters = {{ k = 60, c = 12, alpha = {alpha} }}
[motion]
{motion}
[time]
end = "{end} s"
output_step = "4 ms"
[solver]
rtol = 1e-10
"""

MJCF = """
<mujoco>
  <option timestep="{h}" integrator="{integrator}"><flag energy="enable" contact="disable"/></option>
  <worldbody>
    <site name="base" pos="0.05 0.1 -0.35"/>
    <body>
      <joint name="q1" type="hinge" axis="0 1 0"/>
      <inertial pos="0.15 0.02 0.01" mass="1.2" diaginertia="0.002 0.011 0.012"/>
      <body pos="0.3 0 0">
        <joint name="q2" type="hinge" axis="0.6 0.8 0"/>
        <inertial pos="0.1 0 -0.01" mass="0.8" diaginertia="0.001 0.006 0.005"/>
        <site name="tip" pos="0.12 0.03 0.02"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def scenario(alpha: float, end: float) -> str:
    """The arm falls from :data:`START`."""
    start = f"kind = \"forward\"\nstart = {{ q = {{ q1 = {START[0]}, q2 = {START[1]} }} }}"
    return SCENARIO.format(alpha=alpha, end=end, motion=start)


def prescribed(alpha: float, end: float) -> str:
    """The arm goes q1 = 0.4 + 0.5 sin 5t, q2 = −0.9 + 0.3 sin 8t."""
    motion = 'kind = "prescribed"\njoints = { q1 = "0.4 + 0.5*sin(5*t)", q2 = "-0.9 + 0.3*sin(8*t)" }'
    return SCENARIO.format(alpha=alpha, end=end, motion=motion)


def mjcf(h: float, integrator: str) -> str:
    return MJCF.format(h=h, integrator=integrator)


def strut(alpha: float, **more: object) -> dict[str, object]:
    """The strut, without its ends."""
    parameters = {"k": 60, "c": 12, "alpha": alpha}
    return {"name": "strut", "rest_length": "42 cm", "law": "fractional-kelvin-voigt", "parameters": parameters, **more}
