"""A small REXS model with a value of every form."""

from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    Document,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
)


def small_model(version: str = "1.7") -> Model:
    """Return a pair of gears on two shafts under two load cases."""
    return Model(
        version=version,
        application='a < b & "c"',
        application_version="1",
        date="2024-03-13T13:51:48+01:00",
        relations=(
            *(_assembly(number, 1, part) for number, part in enumerate((2, 3, 6), 1)),
            _assembly(4, 2, 4, order=1),
            _assembly(5, 3, 5, order=1),
            Relation(
                6, "stage", (Reference(6, "stage"), Reference(4, "gear_1"), Reference(5, "gear_2", "wheel"))
            ),
        ),
        components=(
            Component(1, "gear_unit", _every_form(), "Getriebe Ä ' < >"),
            Component(
                2, "shaft", (Attribute("u_axis_vector", "floating_point_array", (1.0, 0.0, 0.0), "mm"),)
            ),
            Component(
                3, "shaft", (Attribute("reference_component_for_position", "reference_component", 2, "none"),)
            ),
            Component(4, "cylindrical_gear", _gear(20)),
            Component(5, "cylindrical_gear", _gear(41)),
            Component(
                6, "cylindrical_stage", (Attribute("center_distance", "floating_point", 0.1 + 0.2, "mm"),)
            ),
        ),
        spectra=(_spectrum(),),
        language="en",
        extra=(("writer", "kept"),),
    )


def small_document() -> Document:
    return Document(small_model(), {"matrices/housing.txt": b"1 2 3"})


def _assembly(number: int, whole: int, part: int, order: int | None = None) -> Relation:
    refs = (Reference(whole, "assembly"), Reference(part, "part", "a hint", (("mark", "kept"),)))
    return Relation(number, "ordered_assembly" if order else "assembly", refs, order)


def _gear(teeth: int) -> tuple[Attribute, ...]:
    return (
        Attribute("number_of_teeth", "integer", teeth, "none"),
        Attribute("normal_module", "floating_point", 2.0, "mm", origin="user_defined"),
        Attribute("face_width", "floating_point", None, "mm"),
    )


def _every_form() -> tuple[Attribute, ...]:
    return (
        Attribute("account_for_gravity", "boolean", True, "none"),
        Attribute("data_source", "file_reference", "matrices/housing.txt", "none"),
        Attribute("custom_word", "string", "12", extra=(("since", "1"),)),
        Attribute("custom_enum", "enum", "true"),
        Attribute("custom_whole", "integer", -3),
        Attribute("custom_words", "string_array", ("a", "", "<b>")),
        Attribute("custom_choices", "enum_array", ("a", "b")),
        Attribute("custom_flags", "boolean_array", (True, False)),
        Attribute("custom_none", "integer_array", None),
        Attribute("custom_empty", "floating_point_array", ()),
        Attribute("custom_matrix", "floating_point_matrix", ((1.0, 2.5e-300), (1e23, -0.0)), "N / m"),
        Attribute("custom_no_matrix", "floating_point_matrix", ()),
        Attribute("custom_whole_matrix", "integer_matrix", ((1, 2), (3, 4))),
        Attribute("custom_lists", "array_of_integer_arrays", ((1,), (2, 3), ())),
        Attribute("custom_coded", "floating_point_array", (0.5, 0.1), "mm", "float64"),
        Attribute("custom_short", "floating_point_array", (0.5, -2.0), "mm", "float32"),
        Attribute("custom_coded_whole", "integer_array", (1, -2), None, "int32"),
        Attribute(
            "custom_coded_matrix",
            "floating_point_matrix",
            ((1.0, 2.0), (3.0, 4.0), (5.0, 6.0)),
            "mm",
            "float64",
        ),
    )


def _spectrum() -> LoadSpectrum:
    cases = (
        LoadCase(
            1, (Component(2, "shaft", (Attribute("rotational_speed", "floating_point", 543.0, "1 / min"),)),)
        ),
        LoadCase(2, (), (("note", "idle"),)),
    )
    return LoadSpectrum(
        1, cases, (Component(1, "gear_unit", (Attribute("custom_life", "floating_point", 2e4, "h"),)),)
    )
