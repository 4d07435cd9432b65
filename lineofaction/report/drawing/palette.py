"""Colors that color-blind readers can tell, also in gray print.

Categories take the palette of Okabe and Ito (2008); ordered values take dark-to-light steps of cividis, which
rises evenly in lightness for normal and for red-green-blind eyes (Nunez, Anderton and Renslow 2018, PLoS ONE
13(7)).
"""

from __future__ import annotations

BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
)
CATEGORIES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
HARMONICS = (*CATEGORIES, "#59636E", "#8F3F00")
DESIGNS = BLUE, VERMILLION
"""Design A, the one before; design B, the one after."""
GEARS = "#3D4752", "#8D98A5"
"""Pinion and wheel: two steels, so that blue and orange are designs."""
INK, MUTED, GRID = "#1B1F24", "#59636E", "#DDE1E6"

# cividis at 0, 0.1 ... 1.0
CIVIDIS = (
    "#00224E", "#083370", "#35456C", "#4F576C", "#666970", "#7D7C78",
    "#948E77", "#AEA371", "#C8B866", "#E5CF52", "#FEE838",
)  # fmt: skip
# of values of either sign: blue below zero, vermillion above, gray for what is close to it
SIGNED = ("#004A75", "#0072B2", "#7FB5D6", "#DDE1E6", "#E9A777", "#D55E00", "#8F3F00")
_DARKEST, _LIGHTEST = 0.0, 0.82  # lighter than this vanishes on white paper


def category(index: int) -> str:
    """Return the color of the index-th category; after six they repeat."""
    return CATEGORIES[index % len(CATEGORIES)]


def harmonic(order: int) -> str:
    """Return the color of a harmonic by its number from 1 on; after eight they repeat."""
    return HARMONICS[(order - 1) % len(HARMONICS)]


def tooth_pair(pair: int) -> str:
    """Return the color of a tooth pair by its index; the page's live flanks take the same."""
    return category(-pair)


def ordered(index: int, count: int) -> str:
    """Return the color of step `index` of `count` ordered values, dark for the first."""
    return cividis(_DARKEST + (_LIGHTEST - _DARKEST) * index / max(count - 1, 1))


def cividis(fraction: float) -> str:
    """Return the color at a fraction, 0 to 1, of the ordered palette."""
    low = min(int(fraction * 10), 9)
    weight = fraction * 10 - low
    parts = ([int(color[i : i + 2], 16) for color in CIVIDIS[low : low + 2]] for i in (1, 3, 5))
    return "#" + "".join(f"{round(a + (b - a) * weight):02X}" for a, b in parts)
