"""What `rigsim calibrate ... --json` prints, and the files it writes."""
