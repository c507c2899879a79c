"""Version of the package; the build reads it from here."""

__version__ = "0.1.0"
"""Version of the package.

Example:
    >>> import rigsim
    >>> rigsim.__version__.count(".")
    2
"""
