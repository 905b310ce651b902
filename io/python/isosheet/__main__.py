"""The command ``isosheet``, also as ``python -m isosheet``."""

import os
import sys

from ._isosheet import command


def main() -> None:
    """Does what the command line says, and ends the process with the exit code of the command."""
    program, *words = sys.argv
    if program.endswith("__main__.py"):
        # A sweep starts this program for each of its runs: the one that pip installs beside Python.
        program = os.path.join(os.path.dirname(sys.executable), "isosheet")
    sys.exit(command([program, *words]))


if __name__ == "__main__":
    main()
