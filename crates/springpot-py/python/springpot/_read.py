"""Results that are in a folder, as a run in memory again."""

from __future__ import annotations

import os
import warnings

from ._errors import MissingResultsError, SpringpotWarning
from ._run import Run
from ._springpot import Stored


def read(folder: str | os.PathLike[str]) -> Run:
    """Reads the results that ``springpot run``, :func:`run` with ``out``, :func:`sweep` or :meth:`Run.save` wrote, in any of their formats.

    All numbers are those of the run, to the bit, and nothing is run: neither the scenario nor its files need be there any more. Cases that failed are in
    ``Run.failures``. A run that was broken off has the cases that it began.

    Raises:
        SpringpotError: there are no results, a file of theirs is damaged, or they are one part of a run. Of a folder that is not there it is a
            ``FileNotFoundError`` too.
    """
    path = os.fspath(folder)
    if not os.path.exists(path):
        raise MissingResultsError(f"{path}: there is no such folder", filename=path)
    stored, cases, warning = Stored.read(path)
    if warning is not None:
        warnings.warn(warning, SpringpotWarning, stacklevel=2)
    return Run(stored, cases)
