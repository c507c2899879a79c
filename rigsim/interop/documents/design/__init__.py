"""What `rigsim design --json` prints and design.json holds."""
