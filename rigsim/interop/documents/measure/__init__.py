"""What `rigsim measure --json` prints and measure.json holds."""
