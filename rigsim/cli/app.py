"""The commands, and how their errors and exit codes reach the shell."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from typing import Annotated, cast

import typer

from rigsim import interrupts
from rigsim._version import __version__
from rigsim.cli import lazy
from rigsim.cli.kit import answer, faults, terminal
from rigsim.errors import InvalidRange, OutputError, RigsimError

COMMANDS = {
    "studio": lazy.Command(
        "rigsim.cli.studio:studio",
        "Open the live page: numbers, pictures and a rendered scene that follow while you drag.",
    ),
    "sweep": lazy.Command(
        "rigsim.cli.sweep:sweep",
        "Sweep rigs through a scene: predicted, simulated and measured depth error side by side, "
        "in a report.",
    ),
    "tolerance": lazy.Command(
        "rigsim.cli.tolerance:tolerance",
        "Rank a rig's tolerances by what they do to the depth, and count the built rigs that are good.",
    ),
    "render": lazy.Command(
        "rigsim.cli.render:render",
        "Render a stereo pair with exact depth, disparity and segmentation.",
    ),
    "design": lazy.Command(
        "rigsim.cli.design.design:design",
        "Find the rigs that meet requirements, recommend one, and verify it by simulation.",
    ),
    "rig": lazy.Command(
        "rigsim.cli.rig:rig",
        "Say what a calibration's rig is, and what is odd about it: each remark with its reason and cure.",
    ),
    "measure": lazy.Command(
        "rigsim.cli.measure:measure",
        "Measure a pair of pictures: matches, depths, how accurate they are, and whether the rig fits.",
    ),
    "calibrate": lazy.Command(
        "rigsim.cli.calibrate.calibrate:app",
        "Plan a calibration, or make one of your pictures, and say what it leaves of the depth.",
    ),
    "infer": lazy.Command(
        "rigsim.cli.infer:infer",
        "Infer the disparity noise that explains depth errors at known distances.",
    ),
    "verify": lazy.Command(
        "rigsim.cli.verify:verify",
        "Test triangulators on cases with known answers; exit code 3 when one fails.",
    ),
    "compare": lazy.Command(
        "rigsim.cli.compare:compare",
        "Compare triangulators: distance to the bound, bias, lost points and speed, over geometry and noise.",
    ),
    "scenes": lazy.Command(
        "rigsim.cli.scenes:scenes", "List the bundled scenes, the preset rigs and the sensors."
    ),
    "presets": lazy.Command(
        "rigsim.cli.presets:presets",
        "List the rigs that --preset takes; with NAME, the sources of each number.",
    ),
    "doctor": lazy.Command(
        "rigsim.cli.doctor:doctor",
        "Say which renderers work here, and the one line that installs what is missing.",
    ),
    "calc": lazy.Command(
        "rigsim.cli.calc.calc:app", "Calculate with closed forms: a point, a distance, a rig's limits."
    ),
    "export": lazy.Command(
        "rigsim.cli.export:app", "Write a rig, or a rendered data set, in other programs' formats."
    ),
}
"""The commands, in the order of `rigsim --help`; a new one is a line here."""

app = typer.Typer(
    cls=lazy.group(COMMANDS),
    name="rigsim",
    help="Design stereo camera rigs: depth accuracy predicted, simulated and measured, side by side.",
    epilog="Start with: rigsim sweep --baseline 50:500",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


# what typer raises for bad words has no public name, but one that derives from it has
_UsageError = cast(type[Exception], typer.BadParameter.__bases__[0])


_OF_A_NAME = frozenset({errno.ENAMETOOLONG, errno.ELOOP, errno.EACCES, errno.EPERM})
"""What a path that the user named may be refused for, wherever it is first looked at."""


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"rigsim {__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version and exit."),
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line `arguments` (the process's own by default); returns the exit code.

    0 fine, 1 error, 2 usage, 3 outside tolerance, 130 interrupted. An error is one line on stderr.
    """
    words = list(answer.typed() if arguments is None else arguments)
    terminal.prepare()
    answer.tell(())
    try:
        _check_words(words)
        result = _called(words)
        if sys.stdout is not None:
            sys.stdout.flush()
    except RigsimError as error:
        return _fail(str(error), 2 if isinstance(error, InvalidRange) else 1)
    except _UsageError as error:
        return _fail(_in_one_line(error), 2)
    except (KeyboardInterrupt, typer.Abort):
        interrupts.caught()
        return interrupts.exit_code()
    except BrokenPipeError:
        _drop_output()  # the reader has gone: nothing to say
        return 1
    except OSError as error:
        if error.errno in _OF_A_NAME and error.filename is not None:
            return _fail(f"{str(error.filename)[:300]}: {error.strerror}; name another one", 1)
        if error.errno != errno.ENOSPC:
            if faults.NO_NET in os.environ:
                raise
            return _fail(faults.unforeseen(error, words), 1)
        _drop_output()
        return _fail(f"output: {error.strerror}; send it elsewhere, or free some space", 1)
    except Exception as error:
        if faults.NO_NET in os.environ:
            raise
        return _fail(faults.unforeseen(error, words), 1)
    finally:
        _release_claims()
    return (
        interrupts.exit_code()
        if result == interrupts.INTERRUPTED
        else result
        if isinstance(result, int)
        else 0
    )


def _called(words: list[str]) -> object:
    try:
        return app(words, prog_name="rigsim", standalone_mode=False)
    except Exception:
        if interrupts.is_ending():
            raise KeyboardInterrupt from None
        raise


def _check_words(words: list[str]) -> None:
    """Refuse what no option can mean.

    Raises:
        OutputError: a document is wanted, and there is nowhere to print it.
        InvalidRange: an option's value is empty, as from a variable of the shell that is not set.
    """
    if sys.stdout is None and "--json" in words:
        raise OutputError("standard output is closed: leave it open, --json prints there")
    for option, value in zip(words, [*words[1:], "?"], strict=False):
        name, equals, rest = option.partition("=")
        if name.startswith("--") and (value == "" if not equals else rest == ""):
            raise InvalidRange(f"{name}: its value is empty: give one (is a variable of the shell not set?)")


def _release_claims() -> None:
    """Outputs that were checked and not written, as after an error, are free again."""
    claims = sys.modules.get("rigsim.interop.files.claims")
    if claims is not None:
        claims.release_all()


def _drop_output() -> None:
    """What could not be written must not be tried again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(message: str, code: int) -> int:
    print(f"rigsim: error: {' '.join(message.split())}", file=sys.stderr)
    return code


def _in_one_line(error: Exception) -> str:
    """What typer says in a paragraph, and where to read on."""
    says = getattr(error, "format_message", error.__str__)()
    message = " ".join(str(says).split()).rstrip(".")
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else "rigsim"
    return f"{message[:1].lower()}{message[1:]}; see {command} --help"
