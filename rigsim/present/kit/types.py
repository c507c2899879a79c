"""What tables and figures are, for those who hand them on without making them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias

import pandas as pd
from matplotlib.figure import Figure as Figure

Table: TypeAlias = pd.DataFrame


def table(rows: Iterable[Mapping[str, object]]) -> Table:
    """A table of `rows`, which name their columns."""
    return pd.DataFrame(list(rows))
