"""`rigsim calibrate`."""
