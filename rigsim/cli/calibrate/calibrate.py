"""`rigsim calibrate`: plan a calibration, or make one of pictures, and say what it leaves of the depth."""

from __future__ import annotations

import typer

from rigsim.cli.calibrate.pictures import pictures
from rigsim.cli.calibrate.plan import plan

app = typer.Typer(
    name="calibrate",
    help="Plan a calibration, or make one of your pictures, and say what it leaves of the depth.",
)


@app.callback(invoke_without_command=True)
def _calibrate(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


app.command()(plan)
app.command()(pictures)
