"""A system on every second position of its mesh tables: the influence of the nodes between them."""

from __future__ import annotations

from dataclasses import replace

from dynamics.assembly.assemble import System
from dynamics.kernels.by_address import by_address
from dynamics.meshes.decimated_tables import decimated, decimated_grids


def with_decimated_tables(system: System, every: int = 2) -> System:
    """Return `system` on each `every`-th position node of all tables that its flanks use."""
    elements = system.arrays.elements
    flank, spatial = elements.laws.flank, elements.laws.spatial_flank
    laws = elements.laws._replace(
        flank=flank._replace(table=decimated(flank.table, every)),
        spatial_flank=spatial._replace(grid=decimated_grids(spatial.grid, every)),
    )
    changed = by_address(elements._replace(laws=laws))
    return replace(system, arrays=by_address(system.arrays._replace(elements=changed)))
