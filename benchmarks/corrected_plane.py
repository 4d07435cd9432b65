"""The plane corrected for a finite width against three dimensions: agreement, and costs of both."""

from __future__ import annotations

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = """
import resource
from fe_contact import Gear, GearPair, analyze
def cpu():
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)
gear = Gear(teeth=20, normal_module=4e-3, face_width={width}, bore_diameter=40e-3)
pair = GearPair(gear, gear, center_distance=80e-3)
force = 106.4e3 * {width}
def table(model, level):
    start = cpu()
    positions = 64 if model == "3d" else None
    database = analyze(pair, normal_forces=[force], model=model, level=level, positions=positions)
    return cpu() - start, database
for model in ("auto", "3d"):
    table(model, "draft")  # may compile
plane_seconds, plane = table("auto", "standard")
seconds, space = table("3d", "fine")
found = {{}}
for name in ("mean", "peak_to_peak"):
    one, other = (getattr(t, name)(force=force) for t in (plane, space))
    found[name] = 100 * abs(one.value / other.value - 1)
    found[name + "_error"] = 100 * one.error / one.value
measured = found | {{"plane": plane_seconds, "space": seconds}}
"""
_MODULES = (1.25, 6.25)


def figures() -> list[Figure]:
    """Return the figures of a narrow and a usual face."""
    return [figure for modules in _MODULES for figure in _width(modules)]


def _width(modules: float) -> list[Figure]:
    """Measure one face width."""
    run = measure(_CODE.format(width=4e-3 * modules), LINEOFACTION_CACHE="off")
    subject = f"2-D corrected for its finite width against 3-D fine, 20/20, face of {modules:g} modules"
    return [
        Figure(subject, "mean STE off", run["mean"], "%", 0.5),
        Figure(subject, "own error estimate of the mean", run["mean_error"], "%"),
        Figure(subject, "peak-to-peak STE off", run["peak_to_peak"], "%", 1.0),
        Figure(subject, "own error estimate of peak-to-peak", run["peak_to_peak_error"], "%"),
        Figure(subject, "2-D, cold", run["plane"], "CPU s"),
        Figure(subject, "3-D, cold", run["space"], "CPU s"),
    ]
