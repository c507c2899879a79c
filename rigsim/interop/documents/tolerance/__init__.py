"""What `rigsim tolerance --json` prints and tolerance.json holds."""
