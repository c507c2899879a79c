"""The quantities of a tolerance study as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rigsim.study.tolerance.run import ToleranceResult
from rigsim.study.tolerance.sensitivities import UNITS, Sensitivity

if TYPE_CHECKING:
    import pandas as pd


from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def tolerance_table(result: ToleranceResult) -> pd.DataFrame:
    """One row a quantity, the worst first; the columns of docs/reference/tolerance.md."""
    import pandas as pd  # a document needs none of it

    distances = [item.depth_m * 1e3 for item in result.depths]
    return pd.DataFrame(
        [
            {
                **quantity_head(result, item),
                **{
                    f"depth_error_at_{distance:.10g}_mm": error
                    for distance, error in zip(distances, item.depth_rms_mm, strict=True)
                },
                **quantity_rest(result, item),
                "needed_alone": item.needed_alone,
                "needed_equal_share": item.needed_equal_share,
            }
            for item in result.sensitivities
        ]
    ).replace(math.inf, math.nan)


def quantity_head(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    """What a quantity is and is held to."""
    given = result.tolerances
    return {
        "quantity": item.key,
        "unit": UNITS[item.key],
        "tolerance": item.tolerance,
        "form": "bound" if given.is_bound(item.key) else "std",
        "source": given.source(item.key),
    }


def quantity_rest(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    """What a quantity does to the depth."""
    found: dict[str, Any] = {
        "common_mm": item.common_mm,
        "differing_mm": item.differing_mm,
        "variance_share": item.share,
    }
    both = result.interactions
    place = 0 if both is None else both.place(item.key)
    for name, indices in (
        ("sobol", None if both is None else both.error),
        ("sobol_bias", None if both is None else both.bias),
    ):
        for kind in ("first", "first_se", "total", "total_se"):
            found[f"{name}_{kind}"] = None if indices is None else float(getattr(indices, kind)[place])
    return found
