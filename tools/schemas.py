"""Write docs/schema anew from the documents' types: .venv/bin/python tools/schemas.py"""

from __future__ import annotations

import json
from pathlib import Path

from rigsim.interop.documents.schema import DOCUMENTS, schema

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "schema"

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for old in FOLDER.glob("*.schema.json"):
        old.unlink()
    for name in DOCUMENTS:
        text = json.dumps(schema(name), indent=2, ensure_ascii=False)
        (FOLDER / f"{name}.schema.json").write_text(text + "\n", encoding="utf-8")
