"""How a ratio or a time compares with its goals, in words."""


def as_fraction(value: float) -> str:
    """A ratio below one as ``1/x``, any other as it is."""
    return f"1/{1 / value:.1f}" if value < 1 else f"{value:.2f}"


def verdict(value: float, required: float, good: float) -> str:
    """How a ratio or time compares with its goals; smaller is better."""
    return "good" if value <= good else "met" if value <= required else "MISSED"
