"""Command line: words to one call."""


def main() -> int:
    """Run the command line; returns the exit code: 0 fine, 1 error, 2 usage, 3 outside tolerance."""
    try:
        from rigsim.cli.app import run

        return run()
    except KeyboardInterrupt:  # while still importing
        return 130
