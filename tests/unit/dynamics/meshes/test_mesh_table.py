"""Tables that break the protocol are refused, each by its field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import repeated, square_wave_table

from dynamics.errors import InputError
from dynamics.meshes.mesh_table import check_table

TABLE = square_wave_table()


def broken():
    falling = TABLE.deflection.copy()
    falling[0, 0, 5, 3] = falling[0, 0, 5, 2]
    hole = TABLE.stiffness.copy()
    hole[0, 0, 7, 7] = np.nan
    soft = TABLE.stiffness.copy()
    soft[..., -1] = 0.0
    return [
        ("table", object()),
        ("table.position", replace(TABLE, position=TABLE.position + 0.1)),
        ("table.position", replace(TABLE, position=TABLE.position[::-1].copy())),
        ("table.position", replace(repeated(TABLE, 3), period=2)),
        ("table.period", replace(TABLE, period=0)),
        ("table.period", replace(TABLE, period=1.5)),
        ("table.level", replace(TABLE, level=TABLE.level + 1.0)),
        ("table.deflection", replace(TABLE, deflection=TABLE.deflection[..., :-1])),
        ("table.deflection", replace(TABLE, deflection=falling)),
        ("table.stiffness", replace(TABLE, stiffness=hole)),
        ("table.stiffness", replace(TABLE, stiffness=soft)),
    ]


def test_a_good_table_passes():
    check_table(TABLE, "table")
    check_table(repeated(TABLE, 3), "table")


@pytest.mark.parametrize(("field", "table"), broken())
def test_a_broken_table_is_refused(field, table):
    with pytest.raises(InputError) as caught:
        check_table(table, "table")
    assert caught.value.field == field
