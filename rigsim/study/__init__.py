"""Experiments: trials, sweeps, statistics and verdicts."""
