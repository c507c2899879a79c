"""What people type, read: quantities with units, ranges, and the rigs that options describe.

The command line and the page both read words here, so both understand the same ones.
"""
