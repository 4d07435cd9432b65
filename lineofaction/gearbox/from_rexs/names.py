"""Names of a scene's parts: those of the file, made unlike each other."""

from __future__ import annotations

from lineofaction.gearbox.from_rexs.part import Part

LONGEST = 64
"""Characters of a name in a scene."""


class Names:
    """Gives each part of one kind its name.

    A name that is too long, or that another part has, ends in the component's id.
    """

    def __init__(self) -> None:
        self._names: dict[int, str] = {}

    def of(self, part: Part, suffix: str = "") -> str:
        """Return the name of a part; the same whenever it is asked for again without a suffix."""
        if not suffix and part.id in self._names:
            return self._names[part.id]
        name = (" ".join(part.name.split()) or part.type) + suffix
        if len(name) > LONGEST or name in self._names.values():
            ending = f" ({part.id}){suffix}"
            name = name[: LONGEST - len(ending)].rstrip() + ending
        self._names[part.id if not suffix else -len(self._names) - 1] = name
        return name
