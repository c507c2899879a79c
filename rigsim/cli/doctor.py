"""`rigsim doctor`: which renderers work here, and what installs the others."""

from __future__ import annotations

import typer

from rigsim.cli.kit.answer import print_document
from rigsim.cli.kit.options import Json


def doctor(as_json: Json = False) -> None:
    """Say which renderers work here, and the one line that installs what is missing."""
    from rigsim.sim import backend

    probes = [backend.probe(name) for name in backend.RENDERERS if name != "auto"]
    if as_json:
        from rigsim.interop.documents.listings import doctor_document

        print_document(doctor_document(probes))
        return

    from rigsim.present.kit.console import print_table

    print_table(
        "Renderers (--renderer)",
        ("renderer", "works", "detail"),
        [(probe.name, "yes" if probe.works else "no", probe.detail) for probe in probes],
    )
    best = next(probe for probe in probes if probe.works)
    typer.echo(f"--renderer auto takes {best.name}")
    for probe in probes:
        if not probe.works:
            typer.echo(f"to install {probe.name}: {probe.install}")
