"""The speeds that a train of gears leaves open: a null space over fractions."""

from __future__ import annotations

from fractions import Fraction

Row = dict[int, Fraction]


class TrainSpeeds:
    """All sets of shaft speeds that the meshes joined so far allow, as an exact basis.

    `shafts`: number of shafts, all free at first. The basis has two parts: `_set` are the vectors of laws,
    `_open` those that no law sets. A condition on the speeds, or a law, takes one vector out of `_open` and
    subtracts a multiple of it from the others, such that they meet the condition.
    """

    def __init__(self, shafts: int) -> None:
        self._shafts = shafts
        self._open = [[Fraction(int(i == j)) for j in range(shafts)] for i in range(shafts)]
        self._set: list[list[Fraction]] = []

    def join(self, a: int, b: int, carrier: int | None, ratio: Fraction) -> None:
        """Demand w_b - w_c = ratio (w_a - w_c)."""
        row: Row = {}
        for shaft, factor in ((b, Fraction(1)), (a, -ratio), (carrier, ratio - 1)):
            if shaft is not None:
                row[shaft] = row.get(shaft, Fraction(0)) + factor
        values = [self._along(basis, row) for basis in self._open]
        pivot = next((i for i, value in enumerate(values) if value != 0), None)
        if pivot is None:
            return
        chosen, size = self._open.pop(pivot), values.pop(pivot)
        self._open = [
            _less(basis, value / size, chosen) for basis, value in zip(self._open, values, strict=True)
        ]

    def at_rest(self, shaft: int, carrier: int | None) -> bool:
        """Return whether the shaft can no longer turn against the carrier."""
        row: Row = {shaft: Fraction(1)}
        if carrier is not None:
            row[carrier] = row.get(carrier, Fraction(0)) - 1
        return all(self._along(basis, row) == 0 for basis in self._open)

    def ratio(self, a: int, b: int, carrier: int | None) -> Fraction | None:
        """Return (w_b - w_c) / (w_a - w_c) where the meshes joined so far fix it, else None."""
        pairs = []
        for basis in self._open:
            c = Fraction(0) if carrier is None else basis[carrier]
            pairs.append((basis[a] - c, basis[b] - c))
        rotating = next((pair for pair in pairs if pair[0] != 0), None)
        if rotating is None:
            return None
        ratio = rotating[1] / rotating[0]
        return ratio if all(second == ratio * first for first, second in pairs) else None

    def set_by_law(self, shaft: int) -> bool:
        """Let the next law set the speed of `shaft`; return False if other laws set it already."""
        pivot = next((i for i, basis in enumerate(self._open) if basis[shaft] != 0), None)
        if pivot is None:
            return False
        chosen = self._open.pop(pivot)
        unit = [value / chosen[shaft] for value in chosen]
        self._open = [_less(basis, basis[shaft], unit) for basis in self._open]
        self._set = [_less(basis, basis[shaft], unit) for basis in self._set]
        self._set.append(unit)
        return True

    def open_shaft(self) -> int | None:
        """Return the first shaft whose speed no law sets, or None."""
        return next((s for s in range(self._shafts) if any(basis[s] != 0 for basis in self._open)), None)

    def ratios(self) -> tuple[tuple[Fraction, ...], ...]:
        """Return the speed of each shaft per unit of each law, (shafts, laws)."""
        return tuple(tuple(basis[s] for basis in self._set) for s in range(self._shafts))

    @staticmethod
    def _along(basis: list[Fraction], row: Row) -> Fraction:
        return sum((factor * basis[shaft] for shaft, factor in row.items()), Fraction(0))


def _less(vector: list[Fraction], factor: Fraction, other: list[Fraction]) -> list[Fraction]:
    return [x - factor * y for x, y in zip(vector, other, strict=True)]
