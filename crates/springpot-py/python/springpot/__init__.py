"""Springpot: robots whose bodies are joined by real materials.

Everything is in SI units (m, kg, s, rad, N, K); a number may also be given as a text with its unit, ``"25 degC"``, where a scenario takes one.
"""

from ._errors import ModelError, RunError, ScenarioError, SpringpotError
from ._springpot import Model, __version__

__all__ = ["Model", "ModelError", "RunError", "ScenarioError", "SpringpotError", "__version__"]
