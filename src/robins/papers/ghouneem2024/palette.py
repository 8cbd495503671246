"""The looks that this wing adds to the house's: one for each of its kinds of filter.

Importing this module is enough; doing so twice changes nothing. The unscented filter keeps the look that it has everywhere
(``ukf``), and so does the truth. Colours say the kind: sky blue every EKF, vermillion the paper's new method, green the filter with
physical noise, black dots the reduced inertial sensors without a filter, purple the fixes alone. Line styles and markers keep apart in
grey what is drawn together.
"""

from robins.publish import style

LOOKS = {
    "ekf-pi": (style.SKY, (0, (20, 1.5)), (3, 0, 0)),
    "ekf-pm": (style.SKY, (0, (3, 1.2)), (3, 0, 180)),
    "ekf-f": (style.SKY, (0, (1.5, 0.8)), (4, 0, 45)),
    "new": (style.VERMILLION, "-.", (5, 1, 180)),
    "physical": (style.GREEN, (0, (4, 1.2, 1.2, 1.2, 1.2, 1.2)), (4, 2, 45)),
    "riss-only": (style.BLACK, (0, (1, 2.2)), "|"),
    "gps-only": (style.PURPLE, (0, (3, 3)), "."),
}
"""Colour, line style and marker by family; a marker of three numbers is (points, 0 polygon, 1 star or 2 asterisk, angle)."""

FAMILIES = (*LOOKS, "ukf", "truth")
"""Every family of this wing."""

for _name, _look in LOOKS.items():
    style.add_family(_name, *_look)


def look(family: str) -> dict:
    """Colour, line style and marker of a family, as `robins.publish.style.family`; whoever asks here has this wing's looks."""
    return style.family(family)
