"""The model of flexible shafts: elements, modes, errors, in plain JSON."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.bodies import ElasticShaft
from dynamics.mechanism.rotor import Rotor
from dynamics.types import Json


def flexible_shafts(rotors: Sequence[Rotor]) -> list[Json]:
    """Return one entry per flexible shaft, SI."""
    return [_entry(rotor.shaft.name, rotor.elastic) for rotor in rotors if rotor.elastic is not None]


def _entry(name: str, elastic: ElasticShaft) -> Json:
    """One shaft: how its beam was divided, what was kept of it, and the errors of either."""
    families = {"bending": elastic.bending, "extension": elastic.extension, "torsion": elastic.torsion}
    return {
        "shaft": name,
        "elements": elastic.position.size - 1,
        "element_error": elastic.mesh_error,
        "highest_frequency": elastic.highest,
        "truncation_error": elastic.truncation,
        "damping_ratio": elastic.damping_ratio,
        "held_modes": {kind: modes.fixed for kind, modes in families.items()},
        "held_modes_up_to": {kind: modes.limit for kind, modes in families.items()},
        "free_frequencies": {kind: modes.frequency.tolist() for kind, modes in families.items()},
        "freedoms": list(elastic.kinds),
    }
