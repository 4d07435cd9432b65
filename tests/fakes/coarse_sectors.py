"""Tooth sectors twice as coarse: laws of analyses that hold on every mesh are shown on the smallest."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from fe_contact.geometry import Toothing
from fe_contact.mesh import SectorRecipe
from fe_contact.planning.discretization import SECTOR_RECIPE


@pytest.fixture(scope="module")
def coarse_sectors() -> Iterator[None]:
    """Give each level elements twice as large, and little more than half the layers: a third of the time.

    What a test says of the accuracy of a level needs the level itself.
    """
    with pytest.MonkeyPatch.context() as patch:
        for level, recipe in list(SECTOR_RECIPE.items()):
            patch.setitem(SECTOR_RECIPE, level, _coarse(recipe))
        yield


def _coarse(recipe: Callable[[Toothing], SectorRecipe]) -> Callable[[Toothing], SectorRecipe]:
    def coarse(gear: Toothing) -> SectorRecipe:
        usual = recipe(gear)
        return replace(usual.scaled(2.0), layers=usual.layers // 2 + 2, merge_rows=())

    return coarse
