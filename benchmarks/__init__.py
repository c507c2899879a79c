"""Speed and accuracy against peers, as ratios: ``python -m benchmarks [name...]``."""
