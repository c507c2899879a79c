"""What benchmarks and tests both look at: wrong and right triangulators, and pictures of known corners."""
