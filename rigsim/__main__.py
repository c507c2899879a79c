"""`python -m rigsim` is `rigsim`."""

import sys

from rigsim.cli import main

if __name__ == "__main__":  # worker processes import this file again
    sys.exit(main())
