"""Copying, which browsers allow a page of the same machine, and others by an older way."""

from __future__ import annotations

import json

from nicegui import ui

_COPY = """\
(async text => {
  try { await navigator.clipboard.writeText(text); return true; } catch (refused) {
    const box = document.createElement('textarea');
    box.value = text; box.style.position = 'fixed'; box.style.opacity = 0;
    document.body.append(box); box.select();
    const done = document.execCommand('copy'); box.remove(); return done;
  }
})(%s)
"""


async def copy(text: str, what: str) -> None:
    """Put `text` on the clipboard, and say so; `what` names it."""
    done = await ui.run_javascript(f"return {_COPY % json.dumps(text)}", timeout=5.0)
    ui.notify(f"{what} copied" if done else f"{what} could not be copied: the browser refuses it")
