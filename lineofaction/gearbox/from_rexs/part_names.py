"""Names of the parts of a scene, each as its file names it and no two alike."""

from __future__ import annotations

from lineofaction.gearbox.from_rexs.gear_unit import Part

LONGEST = 64
"""Characters of a name in a scene."""


class Names:
    """Namer of parts: each part of one kind gets a name of its own.

    A name that is too long, or that another part has, ends in the component's id.
    """

    def __init__(self) -> None:
        self._names: dict[int, str] = {}

    def of(self, part: Part, suffix: str = "") -> str:
        """Return the name of a part; without a suffix the same each time."""
        if not suffix and part.id in self._names:
            return self._names[part.id]
        name = (" ".join(part.name.split()) or part.type) + suffix
        if len(name) > LONGEST or name in self._names.values():
            ending = f" ({part.id}){suffix}"
            name = name[: LONGEST - len(ending)].rstrip() + ending
        self._names[part.id if not suffix else -len(self._names) - 1] = name
        return name
