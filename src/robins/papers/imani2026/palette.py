"""The looks that this wing adds to the house's: one for each kind of filter that was not there, and one for the reference.

Importing this module is enough; doing so twice changes nothing. Kinds that exist keep their look (``inflated``, ``gated``,
``multi-kernel``, ``huber``, ``truth``). Colours say the kind: sky blue the EKF and its inflated relative, orange whatever tests
chi-square (with the gate), blue and vermillion correntropy with many kernels and with one. Line styles keep apart in grey
what is drawn together: truth, reference, EKF, CI-RKF and MKMC-EKF have five different ones.
"""

from robins.publish import style

LOOKS = {
    "ekf": (style.SKY, (0, (12, 1.5)), "8"),
    "no-update": (style.GREY, "--", "_"),
    "chi-square": (style.ORANGE, "--", (4, 1, 0)),
    "chi-square-corrected": (style.ORANGE, "-", (4, 1, 45)),
    "single-kernel": (style.VERMILLION, (0, (1, 1)), (3, 1, 0)),
    "multi-kernel-gain": (style.BLUE, (0, (6, 1.5, 2.5, 1.5)), (6, 1, 0)),
    "as-printed": (style.BLACK, "-.", "4"),
    "fixed-point": (style.PURPLE, "-.", "+"),
    "reference": (style.GREY, ":", ""),
}
"""Colour, line style and marker by family; stars are (points, 1, angle)."""

FAMILIES = (*LOOKS, "inflated", "gated", "multi-kernel", "huber", "truth")
"""Every family of this wing."""

for _name, _look in LOOKS.items():
    style.add_family(_name, *_look)


def look(family: str) -> dict:
    """Colour, line style and marker of a family, as `robins.publish.style.family`; whoever asks here has this wing's looks."""
    return style.family(family)
