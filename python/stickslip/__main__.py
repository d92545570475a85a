"""The program: ``stickslip --help``, or ``python -m stickslip --help``."""

from __future__ import annotations

import signal
import sys

from . import _core


def main() -> int:
    """Runs the program with the arguments of this process.

    Returns
    -------
    int
        The exit status: 0 converged, 1 not converged, 2 bad input, 3 a failure of the machine or a bug.
    """
    # The program handles Ctrl-C itself, and saves what it has.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.program([sys.executable, "-m", "stickslip"], sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
