"""The type of a list in the inputs of a study: any sequence is taken, and a tuple is kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

if TYPE_CHECKING:
    from collections.abc import Sequence as Row
else:
    from pydantic import Strict

    class Row:
        """``Row[Speed]`` is a list of speeds: for pydantic a tuple that takes lists too."""

        def __class_getitem__(cls, entry: Any) -> Any:
            """Return the type of a list of such entries."""
            return Annotated[tuple[entry, ...], Strict(False)]


__all__ = ["Row"]
