"""A script that uses every class, for the type checker."""

import numpy as np
from numpy.typing import NDArray

import springpot as sp

TEXT = """
robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
motion = { kind = "forward" }
time = { end = "1 s", output_step = "10 ms" }
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "springpot"
parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
"""

model: sp.Model = sp.Model.from_scenario(TEXT)
tau: NDArray[np.float64] = model.rnea([0.1], [0.0], [0.0])
by_q, by_v = model.rnea_derivatives(np.zeros((3, 1)), np.zeros(1), np.zeros((3, 1)))
names: list[str] = model.joint_names


def controller(t: float, q: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    return -10 * q - v


simulation: sp.Simulation = sp.Simulation(TEXT, controller=controller, sample="10 ms", set={"time.end": 0.5})
simulation.step_to(0.2)
snapshot: sp.Snapshot = simulation.snapshot()
force: float = snapshot["strut.force"]
unit: str = snapshot.units["strut.force"]
state: sp.SimulationState = simulation.state()
simulation.set_state(state)

law: sp.Law = sp.law("springpot", c="50 N*s^alpha/m", alpha=0.4)
modulus: NDArray[np.complex128] = law.modulus([1.0, 2.0])
series: sp.Prony = sp.prony(law, (1e-3, "10 s"))
found, deviation = sp.datasheet([("stiffness", "5 kN/m", 0.0)])
bank: sp.Bank = sp.Bank([law, {"law": "spring", "parameters": {"k": 3.0}}])
bank.begin([0.0, 0.0])
forces, by_stroke, by_rate = bank.evaluate(0.0, 0.1, np.zeros((2, 3)))
bank.commit()
half: NDArray[np.float64] = sp.fractional.derivative([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], np.zeros(8), 0.5)
values, errors = sp.fractional.derivative(np.linspace(0, 1, 20), np.zeros(20), 0.5, with_error=True)
kelvin: float = sp.units.parse("25 degC", "K")
try:
    sp.Simulation("a = 1")
except sp.ScenarioError as error:
    place: tuple[str | None, int | None, int | None] = (error.path, error.line, error.column)
except (sp.RunError, sp.ModelError, sp.SpringpotError):
    raise
