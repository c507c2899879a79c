"""Build the documentation site into docs/_build/html, a warning being an error: `./run docs [--no-serve]`."""

from __future__ import annotations

import argparse
import http.server
import re
import sys
from functools import partial
from pathlib import Path

from sphinx.cmd.build import build_main

DOCS = Path(__file__).resolve().parent.parent / "docs"
BUILT = DOCS / "_build"
_FETCHED = r'(?:src|href)="(?:https?:)?//[^"]*\.(?:js|css|woff2?)[?"]|src="(?:https?:)?//'


def build() -> int:
    """Build the site; returns Sphinx's exit code."""
    _forget_removed_examples()
    words = ["--fail-on-warning", "--keep-going", "--quiet", "--builder", "html"]
    code = build_main([*words, "--doctree-dir", str(BUILT / "doctrees"), str(DOCS), str(BUILT / "html")])
    for page in (BUILT / "html").glob("**/*.html"):
        if re.search(_FETCHED, page.read_text(encoding="utf-8")):
            print(f"{page}: loads a script, style or font from elsewhere", file=sys.stderr)
            code = code or 1
    return code


def _forget_removed_examples() -> None:
    """Pages of examples that are gone would stand there without a way to them."""
    kept = {path.stem for path in (DOCS / "gallery").glob("*.py")} | {"index"}
    for path in (DOCS / "auto_gallery").glob("*.rst"):
        if path.stem not in kept:
            path.unlink()


def serve(port: int) -> None:
    """Show the site to this machine alone, until Ctrl-C."""
    handler = partial(http.server.SimpleHTTPRequestHandler, directory=str(BUILT / "html"))
    with http.server.ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        print(f"The site: http://127.0.0.1:{server.server_port}/ (Ctrl-C ends)", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return


def main() -> int:
    """Build, then serve unless told otherwise."""
    parser = argparse.ArgumentParser(prog="./run docs", description="Build the documentation and serve it.")
    parser.add_argument("--no-serve", action="store_true", help="build into docs/_build/html, and end")
    parser.add_argument("--port", type=int, default=8000, help="where to serve; 0 takes a free one")
    words = parser.parse_args()
    code = build()
    if code == 0 and not words.no_serve:
        serve(words.port)
    return code


if __name__ == "__main__":
    sys.exit(main())
