"""The whole product from Python: one function a use case, with the words of the command line.

Each takes plain arguments, floats with units in their names, and returns a `Result`. The command line calls
exactly these functions; `rigsim` has them all by name.
"""
