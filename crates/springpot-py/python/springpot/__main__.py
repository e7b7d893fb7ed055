"""``python -m springpot``: the command line."""

from __future__ import annotations

import os
import signal
import sys

from ._springpot import command_line


def main() -> int:
    """Runs the command ``springpot`` with the arguments of this process; gives its exit code."""
    # The command has handlers of its own, which Python's would keep from a process that waits for it.
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command_line(["springpot", *map(os.fsdecode, sys.argv[1:])])


if __name__ == "__main__":
    sys.exit(main())
