"""Command line: words to one call."""


def main() -> int:
    """Run the command line; returns the exit code: 0 fine, 1 error, 2 usage, 3 outside tolerance."""
    from rigsim.cli.kit import ends

    ends.listen()
    try:
        from rigsim.cli.app import run

        code = run()
    except KeyboardInterrupt:  # while still importing
        code = ends.exit_code()
    if code == ends.exit_code():
        ends.leave(code)
    return code
