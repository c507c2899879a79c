"""What pictures of a board hold: its corners in both cameras, whoever found them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.board import Board

Size = tuple[int, int]
"""Width and height, px."""


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """Corners of one board in n pairs of pictures; m corners each, row-major."""

    board: Board
    """The board."""
    names: tuple[str, ...]
    """What each pair is called."""
    observed: Array
    """Pixels (n, 2, m, 2) in the left and the right picture; NaN where none was found."""
    claimed_px: Array
    """Standard deviation (n, 2, m) of one coordinate that the finder claims, px; NaN where it does not."""
    weights: Array
    """One over the noise of a corner as a multiple of the others', (n, 2, m)."""
    polarity: Ids
    """1 or -1 by the colour of the square after a board's first corner, (n, 2); 0 where it is not known."""
    sizes: tuple[Size, Size]
    """Width and height of the left and the right pictures, px."""

    @classmethod
    def of(
        cls,
        board: Board,
        names: tuple[str, ...],
        observed: Array,
        sizes: tuple[Size, Size],
        weights: Array | None = None,
    ) -> Sightings:
        """Corners found elsewhere: nothing is known of colours, or of what their finder claims.

        Raises:
            InvalidRange: their number is not the board's.
        """
        wanted = (len(names), 2, board.rows * board.cols, 2)
        if observed.shape != wanted:
            raise InvalidRange(
                f"corners of shape {observed.shape}: must be {wanted}: pair, camera, corner, (u, v)"
            )
        unknown = np.full(observed.shape[:3], np.nan)
        ones = np.ones(observed.shape[:3]) if weights is None else weights
        return cls(board, names, observed, unknown, ones, np.zeros((len(names), 2), np.int32), sizes)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def found(self) -> Mask:
        """Which corners are known, (n, 2, m)."""
        return np.asarray(np.isfinite(self.observed).all(axis=3))

    @property
    def cameras(self) -> Mask:
        """Which cameras saw a board, (n, 2)."""
        return np.asarray(self.found.any(axis=2))

    @property
    def claimed_rms_px(self) -> float:
        """Root mean square of what the finder claims, px; NaN where it claims nothing."""
        known = np.isfinite(self.claimed_px)
        return float(np.sqrt(np.mean(self.claimed_px[known] ** 2))) if known.any() else float("nan")

    def chosen(self, which: npt.NDArray[np.intp] | Mask) -> Sightings:
        """Some of the pairs."""
        index = np.arange(len(self))[which]
        return replace(
            self,
            names=tuple(self.names[k] for k in index),
            observed=self.observed[index],
            claimed_px=self.claimed_px[index],
            weights=self.weights[index],
            polarity=self.polarity[index],
        )

    def reordered(self, pair: int, order: npt.NDArray[np.intp]) -> Sightings:
        """With the corners of one pair's right picture in another `order` (m,)."""
        observed, claimed, weights = self.observed.copy(), self.claimed_px.copy(), self.weights.copy()
        for each in (observed, claimed, weights):
            each[pair, 1] = each[pair, 1, order]
        return replace(self, observed=observed, claimed_px=claimed, weights=weights)
