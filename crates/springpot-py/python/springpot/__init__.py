"""Springpot: robots whose bodies are joined by real materials.

Everything is in SI units (m, kg, s, rad, N, K); a number may also be given as a text with its unit, ``"25 degC"``.

>>> import springpot as sp
>>> arm = sp.Model.from_scenario('''
... [[robot.body]]
... name = "arm"
... joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
... mass = 2
... com = [0.5, 0, 0]
... ''')
>>> arm.gravity([0.0])
array([-9.81])
"""

from collections.abc import Mapping as _Mapping

from . import fractional, units
from ._errors import ModelError, RunError, ScenarioError, SpringpotError, SpringpotWarning
from ._case import Case
from ._cluster import sweep
from ._figure import Figure
from ._design import Design, DesignedParameter, design
from ._fit import Fit, Parameter, Problem, fit, problem
from ._gradient import gradient
from ._law import Master, datasheet, law, laws, master, network, prony
from ._linear import LinearModel, frequency_response, linearise, modes
from ._read import read
from ._regressor import element_regressor
from ._run import Run, run
from ._tools import Finding, Modulus, check, fmu, modulus
from ._springpot import Bank, Law, Model, Prony, Simulation, SimulationState, Snapshot, __version__

_Mapping.register(Snapshot)

__all__ = [
    "Bank",
    "Case",
    "Design",
    "DesignedParameter",
    "Figure",
    "Finding",
    "Fit",
    "Law",
    "LinearModel",
    "Master",
    "Model",
    "Modulus",
    "ModelError",
    "Parameter",
    "Problem",
    "Prony",
    "Run",
    "RunError",
    "ScenarioError",
    "Simulation",
    "SimulationState",
    "Snapshot",
    "SpringpotError",
    "SpringpotWarning",
    "__version__",
    "check",
    "datasheet",
    "design",
    "fit",
    "fmu",
    "element_regressor",
    "fractional",
    "frequency_response",
    "gradient",
    "law",
    "laws",
    "linearise",
    "master",
    "modes",
    "modulus",
    "network",
    "problem",
    "prony",
    "read",
    "run",
    "sweep",
    "units",
]
