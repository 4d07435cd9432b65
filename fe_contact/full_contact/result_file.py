"""The .dat file of CalculiX: the rotation of gear 1 and the reactions of gear 2's bore."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from fe_contact.full_contact.input_deck import HELD, MM, TURNING
from fe_contact.types import FloatArray, IntArray

_HEAD = re.compile(r"^\s*(displacements|forces)\s.*for set (\S+) and time", re.MULTILINE)


@dataclass(frozen=True)
class Printed:
    """One solved position.

    Attributes
    ----------
    turning : float
        Displacement of the turning node, m: transmission error beyond the approach of the placed pair.
    nodes : (b,) int array
        Numbers of gear 2's bore nodes in the deck.
    reactions : (b, 2) array
        Forces of the shaft on them, N.
    """

    turning: float
    nodes: IntArray
    reactions: FloatArray

    def moment(self, points: FloatArray, about: FloatArray) -> float:
        """Moment in N m, counter-clockwise, of the reactions at their nodes' points (b, 2) about a point."""
        arms = points - about
        return float(np.sum(arms[:, 0] * self.reactions[:, 1] - arms[:, 1] * self.reactions[:, 0]))


def read_printed(text: str) -> Printed:
    """Return the last values that were printed.

    Raises
    ------
    ValueError
        Something is missing, or no number.
    """
    blocks: dict[tuple[str, str], str] = {}
    heads = list(_HEAD.finditer(text))
    ends = [*(head.start() for head in heads), len(text)][1:]
    for head, end in zip(heads, ends, strict=True):
        blocks[head.group(1), head.group(2)] = text[text.index("\n", head.end()) : end]
    try:
        turning, held = _rows(blocks["displacements", TURNING]), _rows(blocks["forces", HELD])
    except KeyError as error:
        raise ValueError(f"CalculiX printed no {' of '.join(error.args[0])}") from None
    if len(turning) != 1 or not np.all(np.isfinite(held)) or not np.all(np.isfinite(turning)):
        raise ValueError("CalculiX printed no finite result")
    return Printed(float(turning[0, 1]) / MM, held[:, 0].astype(np.int64), held[:, 1:3])


def _rows(block: str) -> FloatArray:
    """Node number and three components in each row, (n, 4)."""
    return np.array([[float(word) for word in line.split()] for line in block.splitlines() if line.strip()])
