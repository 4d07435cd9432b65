"""Levels of pairs within tolerances by `loa change`, against a whole analysis of the scene for each pair."""

from __future__ import annotations

import copy
import math
import warnings
from typing import Any

import numpy as np

import lineofaction as loa
from benchmarks.figures import Figure
from benchmarks.heard_flanks import PAIRS, two_shafts
from fe_contact.types import FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.studies.change.result import HIGH, LOW, MEDIAN
from lineofaction.gearbox.units import factor
from model_studies.spread import quantiles

SUBJECT = "levels of pairs within tolerances, transfer functions once"
DRAWN, FEW, SAMPLES, RELIEF = 200, 32, 5, 7.0
"""Pairs of a sample, of a small one, samples, and the tip relief of both gears after the change, µm."""
SPEEDS, ORDERS = np.arange(2000.0, 12001.0, 1000.0).tolist(), 3
TOLERANCES = {"tolerance_class": 6, "misalignment_um": 5.0, "samples": DRAWN}
WITHIN, BAND = 0.2, 3.0
"""dB of a quantile; per cent of the pairs around 90."""


def figures() -> list[Figure]:
    """Return how far quantiles are off, and how many pairs of other samples are within the band of one."""
    scene = two_shafts(PAIRS[1])
    case = copy.deepcopy(scene["meshes"][0]["case"])
    for gear in ("pinion", "wheel"):
        case["pair"][gear]["tip_relief_um"] = RELIEF
    began = cpu_seconds()
    changes = [_change(scene, case, seed) for seed in range(SAMPLES)]
    by_change = (cpu_seconds() - began) / (2 * SAMPLES * DRAWN)
    scene["meshes"][0]["case"], began = case, cpu_seconds()
    same = changes[0]
    whole = np.array([_whole(scene, same.names, each) for each in same.deviation])
    by_whole = (cpu_seconds() - began) / DRAWN
    model = same.after.pairs[:, 0, 0]
    ends = (np.quantile(each, (LOW, MEDIAN, HIGH)) for each in (model, whole))
    off = [abs(first - second) for first, second in zip(*ends, strict=True)]
    low, _, high = quantiles(model, (LOW, MEDIAN, HIGH))
    designs = [[side.pairs[:, 0, 0] for side in (each.before, each.after)] for each in changes]
    levels = np.array(designs).transpose(1, 0, 2)  # (design, sample, pair)
    return [
        *(
            Figure(SUBJECT, f"{name} % of {DRAWN} pairs are below: off", value, "dB", WITHIN)
            for name, value in zip((5, 50, 95), off, strict=True)
        ),
        Figure(SUBJECT, "largest difference of one pair", float(np.abs(model - whole).max()), "dB"),
        Figure(SUBJECT, "90 % of the pairs are within", float(high - low), "dB"),
        *(figure for drawn in (FEW, DRAWN) for figure in _coverage(levels, drawn)),
        Figure(SUBJECT, "a pair by `loa change`", by_change, "CPU s"),
        Figure(SUBJECT, "a pair by a whole analysis", by_whole, "CPU s"),
    ]


def _coverage(levels: FloatArray, drawn: int) -> list[Figure]:
    """Return how many pairs of other samples lie in the band of `drawn` pairs; of levels (D, N, P).

    The standard error is that of the bands, by their own scatter, and of the pairs held out.
    """
    shares = []
    for design in levels:
        for number, sample in enumerate(design):
            others = np.delete(design, number, axis=0)
            for first in range(0, sample.size - drawn + 1, drawn):
                low, high = quantiles(sample[first : first + drawn], (LOW, HIGH))
                shares.append(100.0 * float(np.mean((others >= low) & (others <= high))))
    share, bands = float(np.mean(shares)), len(shares)
    error = math.hypot(float(np.std(shares)) / bands**0.5, 30.0 / levels.size**0.5)
    name = f"pairs held out within the band of {drawn}"
    return [
        Figure(SUBJECT, f"{name}, mean of {bands} bands", share, "%"),
        Figure(SUBJECT, f"{name}: off 90 %, either way", abs(share - 90.0), "%", BAND),
        Figure(SUBJECT, f"{name}: its standard error", error, "%"),
    ]


def _change(scene: dict[str, Any], after: dict[str, Any], seed: int) -> Any:
    question: dict[str, Any] = {"after": after, "speed_rpm": SPEEDS, "orders": ORDERS}
    return loa.change(scene, **question, tolerances=TOLERANCES | {"seed": seed})


def _whole(scene: dict[str, Any], names: tuple[str, ...], deviation: FloatArray) -> float:
    """Return the level of a scene whose pair deviates by (d,) in m, analyzed anew, at its loudest speed."""
    made = copy.deepcopy(scene)
    mesh = made["meshes"][0]
    for name, amount in zip(names, deviation.tolist(), strict=True):
        gear, _, field = boundary_name(name).rpartition(".")
        if gear:
            figures = mesh["case"]["pair"][gear]
            figures[field] = figures.get(field, 0.0) + amount / factor(field)
        else:
            mesh["case"]["errors"] = {"misalignment_um": [amount / factor(field)]}
            mesh["misalignment_um"] = amount / factor(field)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # some deviations are smaller than can be made
        response = loa.response(made, speed_rpm=SPEEDS, orders=ORDERS)
    square = 0.5 * (np.abs(response.bearing_force[:, :3]) ** 2).sum(axis=(0, 1, 3))
    return float(10.0 * np.log10(square.max()))
