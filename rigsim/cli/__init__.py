"""Command line: words to one call."""


def main() -> int:
    """Run the command line; returns the exit code: 0 fine, 1 error, 2 usage, 3 outside tolerance."""
    from rigsim import interrupts

    interrupts.listen()
    try:
        from rigsim.cli.app import run

        code = run()
    except KeyboardInterrupt:  # while still importing
        interrupts.caught()
        code = interrupts.exit_code()
    if code == interrupts.exit_code():
        interrupts.leave(code)
    return code
