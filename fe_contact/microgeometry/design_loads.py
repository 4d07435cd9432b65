"""The loads at which designs are assessed: torques, each with the misalignment of the mesh under it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import SiNote
from fe_contact.errors import InputError, finite, within
from fe_contact.options import LARGEST_DEVIATION, Levels
from fe_contact.types import FloatArray, IntArray

SAME = 1e-12
"""Misalignments that differ by less, in m, are equal: a sum in another order differs in its last bits."""

Misalignments = float | Levels
"""One value for all loads, or one for each, m."""

CALLED_FOR = "called for by designs that remove less"
"""Reason of an effect that is on although the design that decides about effects does not call for it."""


@dataclass(frozen=True)
class DesignLoads:
    """L loads, by rising torque; loads of one torque differ in their misalignment."""

    torque: FloatArray
    """Torque on the driving gear, N m. Shape (L,)."""
    misalignment: FloatArray
    """Growth of the gap over the common face width as parts yield with the torque, m. Shape (L,)."""

    @classmethod
    def of(cls, torques: Levels, misalignment: Misalignments) -> DesignLoads:
        """Return the loads of torques in N m and of their misalignments in m.

        Raises `InputError`: no torque, torques that fall, one load twice, or another number of misalignments
        than one or one for each torque.
        """
        torque = np.array([finite(f"torques[{i}]", value) for i, value in enumerate(torques)])
        if not torque.size:
            raise InputError("torques", [], "a non-empty list of finite numbers")
        paired = np.broadcast_to(_misalignments(misalignment, torque.size), torque.shape)
        if np.any(np.diff(torque) < 0.0) or len({*zip(torque, paired, strict=True)}) < torque.size:
            bound = "increasing, and equal only at different misalignments"
            raise InputError("torques", torque.tolist(), bound, "Sort the list and drop repeats.")
        return cls(torque, paired)

    def with_torques(self, further: Levels) -> tuple[DesignLoads, IntArray]:
        """Return these loads with loads at further torques (T,), and the indices (L,) of these among them.

        Misalignments of further torques are linear between the loads, constant beyond the lowest and highest.
        """
        added = np.setdiff1d(further, self.torque)
        torque = np.concatenate([self.torque, added])
        between = np.interp(added, self.torque, self.misalignment)
        order = np.argsort(torque, kind="stable")
        merged = DesignLoads(torque[order], np.concatenate([self.misalignment, between])[order])
        return merged, np.flatnonzero(order < self.torque.size)


def misalignment_axis(misalignment: FloatArray, deviation: FloatArray) -> FloatArray:
    """Return the axis of a table that holds misalignments (L,) with none and with each deviation (S,), m."""
    values = np.unique(np.concatenate([misalignment, np.add.outer(deviation, misalignment).ravel()]))
    is_new = np.append(True, np.diff(values) > SAME)
    return np.asarray(values[is_new])


def snapped_to_axis(axis: FloatArray, misalignment: FloatArray) -> FloatArray:
    """Return misalignments in m; one within `SAME` of a value of the axis (M,) becomes that value."""
    nearest = axis[np.abs(axis - misalignment[..., None]).argmin(axis=-1)]
    return np.where(np.abs(nearest - misalignment) <= SAME, nearest, misalignment)


def _misalignments(misalignment: Misalignments, loads: int) -> FloatArray:
    values = np.atleast_1d(np.asarray(misalignment, dtype=object)).tolist()
    if len(values) not in (1, loads):
        raise InputError("misalignment", values, f"one number, or {loads}, one for each torque")
    remedy = SiNote("In m: 10 µm is 1e-5.")
    checked = []
    for i, value in enumerate(values):
        name = f"misalignment[{i}]" if np.ndim(misalignment) else "misalignment"
        checked.append(within(name, value, -LARGEST_DEVIATION, LARGEST_DEVIATION, remedy))
    return np.array(checked)
