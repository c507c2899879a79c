"""What tables and figures are, for those who hand them on without making them."""

from __future__ import annotations

from typing import TypeAlias

import pandas as pd
from matplotlib.figure import Figure as Figure

Table: TypeAlias = pd.DataFrame
