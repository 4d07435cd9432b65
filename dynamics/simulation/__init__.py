"""Entry points: from a scene to its result, in memory or streamed to a file."""

from dynamics.simulation.ahead import compile_ahead
from dynamics.simulation.documents import undescribed
from dynamics.simulation.to_file import interrupted_run, run_scene, simulate, simulate_to_file

__all__ = ["compile_ahead", "interrupted_run", "run_scene", "simulate", "simulate_to_file", "undescribed"]
