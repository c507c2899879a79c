"""`python -m rigsim` is `rigsim`."""

from rigsim.cli import main

main()
