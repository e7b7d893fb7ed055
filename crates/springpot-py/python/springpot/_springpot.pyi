"""The compiled module."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._scenario import Scenario

__version__: str

Array: TypeAlias = NDArray[np.float64]

def command_line(arguments: Sequence[str]) -> int:
    """Runs the command ``springpot`` with these arguments, the program's name first; gives its exit code."""
