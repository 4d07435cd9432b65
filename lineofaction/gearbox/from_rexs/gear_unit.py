"""The components of a model by their relations."""

from __future__ import annotations

from collections.abc import Iterator

from lineofaction.gearbox.from_rexs.account import Account
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.rexs import Model, Relation


class GearUnit:
    """A model's components, found by type and by their roles in relations.

    Parameters
    ----------
    model : Model
        Of the newest version, its references checked.

    Attributes
    ----------
    account : Account
        What becomes of its values.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.account = Account(model)
        self._parts = {component.id: Part(component, self.account) for component in model.components}

    def part(self, number: int) -> Part:
        """Return the component of an id."""
        return self._parts[number]

    def of_type(self, *types: str) -> tuple[Part, ...]:
        """Return the components of these types, in the order of the file."""
        return tuple(part for part in self._parts.values() if part.type in types)

    def related(self, part: Part, relation: str, own: str, other: str) -> tuple[Part, ...]:
        """Return the components in role `other` of the relations in which `part` has the role `own`.

        Relations with an order come in it, others in the order of the file.
        """
        entries = [entry for entry in self.relations(relation) if entry.of_role(own) == part.id]
        entries.sort(key=lambda entry: entry.order or 0)
        numbers = (ref.id for entry in entries for ref in entry.refs if ref.role == other)
        return tuple(self._parts[number] for number in numbers)

    def relations(self, *types: str) -> Iterator[Relation]:
        """Yield the relations of these types, in the order of the file."""
        return (relation for relation in self.model.relations if relation.type in types)

    def children(self, part: Part, *types: str) -> tuple[Part, ...]:
        """Return the parts of an assembly, an ordered one's in its order; all types if none is named."""
        parts = (
            *self.related(part, "ordered_assembly", "assembly", "part"),
            *self.related(part, "assembly", "assembly", "part"),
        )
        unique = {child.id: child for child in parts}
        return tuple(child for child in unique.values() if not types or child.type in types)

    def owner(self, part: Part, *types: str) -> Part | None:
        """Return the first assembly of these types that has `part`, None if there is none."""
        for relation in self.relations("assembly", "ordered_assembly"):
            number = relation.of_role("assembly")
            if relation.of_role("part") == part.id and number is not None:
                owner = self._parts[number]
                if not types or owner.type in types:
                    return owner
        return None

    def load_cases(self) -> tuple[tuple[Part, ...], ...]:
        """Return what each load case of the first spectrum sets, empty without a spectrum."""
        if not self.model.spectra:
            return ()
        cases = self.model.spectra[0].cases
        return tuple(tuple(Part(part, self.account) for part in case.components) for case in cases)
