"""The quantities of a tolerance study as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rigsim.study.tolerance import columns as col
from rigsim.study.tolerance.run import ToleranceResult
from rigsim.study.tolerance.sensitivities import UNITS, Sensitivity

if TYPE_CHECKING:
    import pandas as pd


def tolerance_table(result: ToleranceResult) -> pd.DataFrame:
    """One row a quantity, the worst first; the columns of docs/reference/tolerance.md."""
    import pandas as pd  # a document needs none of it

    names = [col.at_distance(item.depth_m * 1e3).name for item in result.depths]
    return pd.DataFrame(
        [
            {
                **quantity_head(result, item),
                **dict(zip(names, item.depth_rms_mm, strict=True)),
                **quantity_rest(result, item),
            }
            for item in result.sensitivities
        ]
    ).replace(math.inf, math.nan)


def quantity_head(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    """What a quantity is and is held to."""
    given = result.tolerances
    return {
        col.QUANTITY: item.key,
        col.UNIT: UNITS[item.key],
        col.TOLERANCE: item.tolerance,
        col.FORM: "bound" if given.is_bound(item.key) else "std",
        col.SOURCE: given.source(item.key),
    }


def quantity_rest(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    """What a quantity does to the depth, and what it takes; infinite where any tolerance does."""
    found: dict[str, Any] = {
        col.COMMON: item.common_mm,
        col.DIFFERING: item.differing_mm,
        col.VARIANCE_SHARE: item.share,
        col.ROW: item.row_px,
        col.ROW_LARGEST: item.row_largest_px,
    }
    both = result.interactions
    place = 0 if both is None else both.place(item.key)
    for names, indices in (
        (col.SOBOL, None if both is None else both.error),
        (col.SOBOL_BIAS, None if both is None else both.bias),
    ):
        for kind, name in names.items():
            found[name] = None if indices is None else float(getattr(indices, kind)[place])
    return found | {col.NEEDED_ALONE: item.needed_alone, col.NEEDED_EQUAL_SHARE: item.needed_equal_share}
