"""What stands under a picture is true: over 30 random pairs (22 of them at night) and three computed ones."""

import math
import re
from dataclasses import asdict, replace
from functools import cache

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.ste import Curve, Metadata, PairGeometry, SteDatabase
from lineofaction.report.drawing.figure import Figure
from lineofaction.report.pair import pair_of
from lineofaction.report.ste.curves import MAX_LINES, drawn_loads, few_loads, load_labels
from lineofaction.report.ste.page import static_results

POSITIONS = 48


def random_table(seed: int) -> SteDatabase:
    """Return the table of a pair that is drawn at random: 1 to 7 loads, 1 to 5 tooth pairs in contact."""
    rng = np.random.default_rng(seed)
    pair = _pair(rng)
    geometry = PairGeometry.of(pair)
    torque = np.sort(np.round(rng.uniform(1.0, 900.0, rng.integers(1, 8)), 1))
    force = torque / (geometry.base_radius[0] * math.cos(geometry.base_helix_angle))
    skew = 1e-6 * np.array([-20.0, 0.0, 40.0]) if rng.random() < 0.5 else np.zeros(1)
    change = 1e-3 * np.array([0.0, 0.1]) if rng.random() < 0.3 else np.zeros(1)
    position = np.arange(POSITIONS) / POSITIONS
    grid = (POSITIONS, force.size, skew.size, change.size)
    counts = np.broadcast_to(_pairs(rng, position)[:, None, None, None], grid)
    pairs = np.arange(int(counts.max()))
    ste = _ste(rng, position, force, grid[2:])
    helical = geometry.base_helix_angle > 0.0
    centroid = 1e-3 * helical * np.sin(2.0 * np.pi * position)[:, None, None, None] - 50.0 * skew[:, None]
    return SteDatabase(
        position=position,
        force=force,
        torque=torque,
        misalignment=skew,
        center_distance_change=change,
        pair=pairs,
        static_transmission_error=ste,
        tangent_compliance=0.9 * ste / force[:, None, None],
        no_load_transmission_error=np.zeros((POSITIONS, *grid[2:])),
        load_share=(pairs < counts[..., None]) / counts[..., None],
        face_centroid=np.broadcast_to(centroid, grid),
        max_pressure=np.broadcast_to(1e7 * np.sqrt(force)[:, None, None], grid),
        pairs_in_contact=counts,
        status=np.zeros(grid, dtype=np.int8),
        error_estimate=ste * (math.nan if rng.random() < 0.2 else 10.0 ** rng.uniform(-4.0, -1.0)),
        residuals=np.zeros((*grid, 4)),
        geometry=geometry,
        metadata=Metadata(case={"pair": asdict(pair)} if rng.random() < 0.9 else {"name": "random"}),
    )


def _pair(rng: np.random.Generator) -> GearPair:
    teeth = int(rng.integers(18, 60)), int(rng.integers(18, 90))
    helix = float(rng.choice([0.0, rng.uniform(0.1, 0.5)]))
    relief, crowning = rng.choice([0.0, 1.0, 1.0]) * rng.uniform(1e-6, 40e-6, 2)
    pinion = Gear(
        teeth=teeth[0],
        normal_module=3e-3,
        face_width=float(rng.uniform(0.01, 0.05)),
        bore_diameter=1.5e-3 * teeth[0],
        helix_angle=helix,
        modification=FlankModification(
            tip_relief=relief, tip_relief_length=1.5e-3, helix_crowning=crowning * (helix > 0.0)
        ),
    )
    return GearPair(
        pinion, replace(pinion, teeth=teeth[1], bore_diameter=1.5e-3 * teeth[1], helix_angle=-helix)
    )


def _pairs(rng: np.random.Generator, position: np.ndarray) -> np.ndarray:
    """Draw the number of pairs in contact, with one more on a part of the pitch or on all of it."""
    first, share = int(rng.integers(1, 5)), rng.choice([rng.uniform(0.1, 0.9), 1.0])
    return first + (np.abs(position - 0.5) < 0.5 * share).astype(int)


def _ste(
    rng: np.random.Generator, position: np.ndarray, force: np.ndarray, alignments: tuple[int, ...]
) -> np.ndarray:
    """Draw a ripple of some harmonics, from a thousandth to a fifth of the mean, changing with the load."""
    order = np.arange(1, 6)
    size = 10.0 ** rng.uniform(-3.0, -0.7) * rng.random(5) / order
    tones = size * np.cos(2.0 * np.pi * (position[:, None] * order + rng.random(5)))
    level = (force / force[-1])[:, None] ** rng.uniform(-0.3, 0.3, 5)
    shape = 1.0 + tones @ level.T
    mean = 4e-9 * force[-1] * (force / force[-1]) ** 0.9
    worse = 1.0 + 0.3 * rng.random(alignments)
    return (mean * shape)[:, :, None, None] * worse


EVERY_CHANGE = 8
"""Of 30 seeds; together they have every figure."""
NUMBER = r"(-?\d+(?:\.\d+)?)"


def figures(database: SteDatabase) -> dict[str, Figure]:
    return {figure.key: figure for section in static_results(database) for figure in section.figures}


@cache
def drawn_at_random(seed: int) -> tuple[SteDatabase, dict[str, Figure]]:
    database = random_table(seed)
    return database, figures(database)


def says(text: str, value: float) -> bool:
    digits = len(text.partition(".")[2])
    unit = 10.0 ** (-digits) if digits else 10.0 ** max(len(text.lstrip("-")) - 3, 0)
    return abs(float(text) - value) <= 0.501 * unit


def curves(database: SteDatabase, misalignment: float = 0.0) -> dict[str, Curve]:
    labels = load_labels(database)
    return {
        labels[k].removesuffix(" N m"): database.curve(
            force=float(database.force[k]), misalignment=misalignment
        )
        for k in drawn_loads(database)
    }


def check_ste(figure: Figure, database: SteDatabase) -> None:
    found = re.findall(
        rf"{NUMBER}(?: ± {NUMBER})? µm at {NUMBER} N m, about a mean of {NUMBER} µm", figure.alternative
    )
    named = curves(database)
    torques = list(named)
    assert [torque for *_, torque, _ in found] == list(dict.fromkeys([torques[-1], torques[0]]))
    for ripple, error, torque, mean in found:
        one = named[torque]
        assert says(ripple, 1e6 * one.peak_to_peak.value) and says(mean, 1e6 * one.mean.value)
        assert says(error, 1e6 * one.peak_to_peak.error) if error else math.isnan(one.peak_to_peak.error)


def check_least_and_largest(text: str, named: dict[str, Curve], unit: str) -> None:
    """A finding on peak to peak over something, by the numbers that name its values."""
    found = re.findall(
        rf"{NUMBER} µm at (?:misalignment |change of the center distance )?{NUMBER} {unit}", text
    )
    assert len(found) == 2
    sizes = {name: one.peak_to_peak for name, one in named.items()}
    ends = min(sizes.values(), key=lambda e: e.value), max(sizes.values(), key=lambda e: e.value)
    for (ripple, name), end in zip(found, ends, strict=True):
        assert says(ripple, 1e6 * end.value)
        assert any(
            float(name) == pytest.approx(float(n), rel=6e-3) and e.value == end.value
            for n, e in sizes.items()
        )
    apart = ends[1].value - ends[0].value > ends[0].error + ends[1].error
    assert ("is least" in text) == (apart or math.isnan(ends[0].error))
    assert ("no more than its errors" in text) != ("is least" in text)


def check_ripple(figure: Figure, database: SteDatabase) -> None:
    requested, _, between = figure.alternative.partition(" Between them it falls to ")
    check_least_and_largest(requested, curves(database), "N m")
    if between:
        ((ripple, torque),) = re.findall(rf"{NUMBER} µm, at {NUMBER} N m", between)
        least = database.curve(torque=float(torque)).peak_to_peak
        assert float(ripple) == pytest.approx(1e6 * least.value, rel=6e-3)
        assert all(least.value < other.peak_to_peak.value for other in curves(database).values())


def check_deviations(figure: Figure, database: SteDatabase) -> None:
    text, force = figure.alternative, float(database.force[-1])
    assert text.count(f"At {load_labels(database)[-1]}") == len(figure.content)
    parts = re.split(r"(?<=\.) (?=At )", text)
    axes = (database.misalignment * 1e6, database.center_distance_change * 1e3)
    units = (("misalignment", "µm"), ("center_distance_change", "mm"))
    varied = [(at, *unit) for at, unit in zip(axes, units, strict=True) if at.size > 1]
    for part, (at, field, unit) in zip(parts, varied, strict=True):
        scale = 1e-6 if unit == "µm" else 1e-3
        named = {f"{v:.6g}": database.curve(force=force, **{field: scale * v}) for v in at}
        check_least_and_largest(part, named, unit)


def check_spectrum(figure: Figure, database: SteDatabase) -> None:
    (torque, order, size) = re.findall(
        rf"At {NUMBER} N m order {NUMBER} is the largest, {NUMBER} µm", figure.alternative
    )[0]
    tones = curves(database)[torque].harmonics
    assert tones[int(order) - 1].value == max(tone.value for tone in tones)
    assert says(size, 1e6 * tones[int(order) - 1].value)
    above = re.findall(r"(\d+) of (\d+) orders exceed their error", figure.alternative)
    if above:
        assert above == [(str(sum(tone.value > tone.error for tone in tones)), "20")]
    else:
        assert all(math.isnan(tone.error) for tone in tones)
    bars, veil = figure.content[0].bars
    for k, tone in enumerate(tones):
        if not math.isnan(tone.error):
            assert (veil.top[k] >= bars.top[k]) == (tone.error >= tone.value) or bars.top[k] == bars.base


def check_waterfall(figure: Figure, database: SteDatabase) -> None:
    tones = {
        (order, torque): tone
        for torque, curve in curves(database).items()
        for order, tone in enumerate(curve.harmonics, 1)
        if not tone.error >= tone.value
    }
    if not tones:
        assert figure.alternative == "No order exceeds its error at any load."
        return
    ((order, torque, level),) = re.findall(
        rf"Order {NUMBER} at {NUMBER} N m is the largest: {NUMBER} dB re 1 µm", figure.alternative
    )
    largest = max(tone.value for tone in tones.values())
    assert tones[int(order), torque].value == largest
    assert says(level, 20.0 * math.log10(1e6 * largest))


def check_load_sharing(figure: Figure, database: SteDatabase) -> None:
    text, counts = figure.alternative, database.pairs_in_contact[:, :, 0, 0]
    ((force, share, torque),) = re.findall(
        rf"at most {NUMBER} N, {NUMBER} % of the load, at {NUMBER} N m", text
    )
    last = load_labels(database).index(f"{torque} N m")
    m = int(np.argmin(np.abs(database.misalignment)))
    largest = float(database.load_share[:, last, m, 0].max())
    assert last == database.force.size - 1
    assert says(share, 100.0 * largest) and says(force, largest * database.force[last])
    for panel in figure.content:
        load = load_labels(database).index(panel.title)
        total = np.nansum([line.y for line in panel.lines], axis=0)
        np.testing.assert_allclose(total, database.force[load], rtol=1e-9)
        for value, mark in panel.y.names:
            newton, percent = re.fullmatch(rf"{NUMBER} N, {NUMBER} %", mark).groups()
            assert says(newton, value) and says(percent, 100.0 * value / database.force[load])
    for low, high, torque in re.findall(rf"(\d) (?:or|to) (\d) tooth pairs carry the load at {NUMBER}", text):
        column = counts[:, load_labels(database).index(f"{torque} N m")]
        assert (int(low), int(high)) == (column.min(), column.max())
    for part, torque in re.findall(rf"{NUMBER} % of the mesh cycle at {NUMBER} N m", text):
        alone = counts[:, load_labels(database).index(f"{torque} N m")] == 1
        width = np.diff(np.append(database.position, 1.0))  # positions crowd where the pairs change
        assert abs(float(part) - 100.0 * float(alone @ width)) < 1.0
    assert ("One pair carries" in text) == bool((counts == 1).any())
    assert ("no pair is ever alone" in text) == bool((counts > 1).all())


def check_mesh_stiffness(figure: Figure, database: SteDatabase) -> None:
    (mean, torque) = re.findall(rf"Mean {NUMBER} N/\(mm µm\) at {NUMBER} N m", figure.alternative)[0]
    k = load_labels(database).index(f"{torque} N m")
    force = database.force[k] * math.cos(database.geometry.base_helix_angle)
    ste = database.ste(np.arange(2000) / 2000.0, float(database.force[k]))
    stiffness = 1e-9 * float(np.mean(force / ste)) / database.geometry.face_width
    assert float(mean) == pytest.approx(stiffness, rel=6e-3)
    against = re.search(rf", {NUMBER} % (above|below) the {NUMBER} N/\(mm µm\) of ISO", figure.alternative)
    pair = pair_of(database)
    assert (against is None) == (pair is None) == ("ISO" not in figure.caption)
    if against and isinstance(pair, GearPair):
        standard = 1e-9 * iso6336_stiffness(pair).mesh_stiffness
        beyond = 100.0 * (stiffness / standard - 1.0) * (1.0 if against[2] == "above" else -1.0)
        assert float(against[1]) == pytest.approx(beyond, abs=1.0)
        assert says(against[3], standard)
    for panel in figure.content:
        assert all(panel.y.limits[0] <= mark.value <= panel.y.limits[1] for mark in panel.references)


def check_budget(figure: Figure, database: SteDatabase) -> None:
    """The named part is the largest one, and the parts are the mean, in the bars as in the table."""
    found = rf"At {NUMBER} N m .* is of (.*): {NUMBER} of {NUMBER} µm, {NUMBER} %\."
    ((torque, name, size, mean, share),) = re.findall(found, figure.alternative)
    (panel,) = figure.content
    (bars,) = panel.bars
    parts = {text: float(bars.top[int(x)]) for x, text in panel.x.names}
    assert name == max(parts, key=lambda part: parts[part]) and says(size, parts[name])
    assert sum(parts.values()) == pytest.approx(float(mean), rel=2e-3)
    assert says(share, 100.0 * parts[name] / sum(parts.values()))
    rows = {row[0]: row[1:] for row in figure.table.rows}
    for part, (pinion, wheel, both, _) in rows.items():
        assert says(both, parts[part])
        assert not pinion or float(pinion) + float(wheel) == pytest.approx(float(both), rel=1e-2)
    force = float(database.force[load_labels(database).index(f"{torque} N m")])
    (springs, table) = re.findall(rf"mean is {NUMBER} µm, that of the table {NUMBER} µm", figure.caption)[0]
    assert springs == mean and says(table, 1e6 * database.mean(force=force).value)
    pair = pair_of(database)
    modified = not (pair.pinion.modification.neutral and pair.wheel.modification.neutral)
    assert modified or "flank modifications" not in parts


def check_flanks(figure: Figure, database: SteDatabase) -> None:
    ends = rf"from {NUMBER} MPa at {NUMBER} N m to {NUMBER} MPa at {NUMBER} N m"
    found = rf"{ends}: {NUMBER} times for {NUMBER} times"
    ((minimum, first, maximum, last, growth, by),) = re.findall(found, figure.alternative)
    ends = [load_labels(database).index(f"{torque} N m") for torque in (first, last)]
    assert ends == [drawn_loads(database)[0], drawn_loads(database)[-1]]
    low, high = (1e-6 * float(database.max_pressure[:, k, 0, 0].max()) for k in ends)
    assert says(minimum, low) and says(maximum, high) and says(growth, high / low)
    assert says(by, float(database.torque[ends[1]] / database.torque[ends[0]]))
    assert ("mid-face" in figure.caption) == (len(figure.content) == 2)


def check_drawing(figure: Figure, database: SteDatabase) -> None:
    pair = pair_of(database)
    modified = len(figure.content) > 1
    assert ("Material removed" in figure.caption) == ("flank modifications" in figure.title) == modified
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        flat = f"The {name} is not modified." in figure.alternative
        assert flat == gear.modification.neutral
        if not flat:
            ((maximum,),) = [
                re.findall(rf"At most {NUMBER} µm are removed from the {name}", figure.alternative)
            ]
            corner = gear.modification.material_removed(
                gear, gear.tip_form_roll_length, 0.5 * gear.face_width
            )
            assert says(maximum, 1e6 * float(corner))


def check_face_load(figure: Figure, database: SteDatabase) -> None:
    ends = rf"At {NUMBER} N m the load acts from {NUMBER} to {NUMBER} mm from mid-face"
    largest = rf"; the largest pressure is {NUMBER} MPa"
    ((torque, low, high, pressure),) = re.findall(ends + largest, figure.alternative)
    at = (slice(None), load_labels(database).index(f"{torque} N m"))
    assert says(low, 1e3 * database.face_centroid[at].min()) and says(
        high, 1e3 * database.face_centroid[at].max()
    )
    assert says(pressure, 1e-6 * database.max_pressure[at].max())
    assert ("from slice to slice" in figure.caption) == (database.geometry.base_helix_angle != 0.0)


CHECKS = {
    "ste": check_ste,
    "ripple": check_ripple,
    "ste_spectrum": check_spectrum,
    "ste_waterfall": check_waterfall,
    "pair_drawing": check_drawing,
    "load_sharing": check_load_sharing,
    "deflection_budget": check_budget,
    "flanks_over_torque": check_flanks,
    "mesh_stiffness": check_mesh_stiffness,
    "deviations": check_deviations,
    "face_load": check_face_load,
}


def check_loads(database: SteDatabase) -> None:
    shown = drawn_loads(database)
    chosen = few_loads(database)
    assert chosen == shown if len(shown) <= MAX_LINES else len(chosen) <= MAX_LINES
    assert (chosen[0], chosen[-1]) == (shown[0], shown[-1])


def check_findings(database: SteDatabase, drawn: dict[str, Figure]) -> None:
    """Every finding, by the numbers of the table; no exponents; and the ripple fills half of its panel."""
    check_loads(database)
    assert drawn.keys() <= CHECKS.keys()
    for key, figure in drawn.items():
        CHECKS[key](figure, database)
        assert not re.search(r"\de[-+]\d|nan|none", f"{figure.caption} {figure.alternative}")
    ripple = drawn["ste"].content[0]
    values = np.concatenate([line.y for line in ripple.lines])
    low, high = ripple.y.limits
    assert low < values.min() and values.max() < high
    assert np.ptp(values) >= 0.5 * (high - low)
    named = re.search(r"cut by the axis at (.*?)\. ", drawn["ste"].caption)
    outside = [
        line.name
        for line in ripple.lines
        if (line.y + line.band).max() > high or (line.y - line.band).min() < low
    ]
    assert (named[1].split(", ") if named else []) == outside
    for k in range(len(ripple.lines) - 1 if len(drawn["ste"].content) > 1 else 0):
        harris = drawn["ste"].content[1].lines
        assert np.all(harris[k].y < harris[k + 1].y), "the order of the loads is readable"


def seeds() -> list[object]:
    late = [pytest.param(seed, marks=pytest.mark.nightly) for seed in range(EVERY_CHANGE, 30)]
    return [*range(EVERY_CHANGE), *late]


@pytest.mark.drawn
@pytest.mark.parametrize("seed", seeds())
def test_findings_are_true_of_random_pairs(seed):
    check_findings(*drawn_at_random(seed))


def test_the_random_pairs_have_every_figure():
    drawn = [drawn_at_random(seed)[1] for seed in range(EVERY_CHANGE)]
    assert set().union(*drawn) == CHECKS.keys()


def computed() -> list[GearPair]:
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=1e-3)
    gear = Gear(teeth=23, normal_module=2e-3, face_width=12e-3, bore_diameter=20e-3)
    helical = replace(gear, helix_angle=math.radians(25.0), modification=relief)
    return [
        GearPair(gear, replace(gear, teeth=31)),
        GearPair(replace(gear, modification=relief), replace(gear, teeth=41, modification=relief)),
        GearPair(helical, replace(helical, teeth=29, helix_angle=-helical.helix_angle)),
    ]


@pytest.mark.law
@pytest.mark.usefixtures("coarse_sectors")
@pytest.mark.parametrize("pair", computed(), ids=["spur", "relieved", "helical"])
def test_findings_are_true_of_computed_pairs(pair):
    model = "plane_strain" if pair.base_helix_angle == 0.0 else "3d"
    database = analyze(pair, torques=[20.0, 45.0, 70.0], level="draft", model=model)
    check_findings(database, figures(database))
