"""Figures as a person would write them."""

import math

_MISSING = "–"


def format_figure(value: float | None, unit: str = "") -> str:
    """A figure with three significant digits and its unit."""
    if value is None or math.isnan(value):
        return _MISSING
    if math.isinf(value):
        text = "∞" if value > 0 else "−∞"
    elif value == 0 or (float(value).is_integer() and abs(value) < 1e4):
        text = f"{value:.0f}"
    elif 1e-3 <= abs(value) < 1e4:
        digits = max(0, 2 - math.floor(math.log10(abs(value))))
        text = f"{value:.{digits}f}"
    else:
        text = _power_of_ten(value)
    gap = "" if unit in ("", "°", "×") else " "
    return f"{text.replace('-', '−')}{gap}{unit}"


def format_limit(value: float) -> str:
    """A threshold, which is a round number, without idle zeros."""
    plain = value == 0 or 1e-3 <= abs(value) < 1e4
    return (f"{value:g}" if plain else _power_of_ten(value)).replace("-", "−")


def words_of(name: str) -> str:
    """A key for people: "wrap-seam" and "wrap_seam" are "Wrap seam"."""
    plain = name.replace("-", " ").replace("_", " ").strip()
    return plain[:1].upper() + plain[1:]


def _power_of_ten(value: float) -> str:
    mantissa, exponent = f"{value:.1e}".replace(".0e", "e").split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}" if mantissa == "1" else f"{mantissa}·10{raised}"
