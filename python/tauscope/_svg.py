"""Small figures for notebooks, as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

WIDTH, HEIGHT, LEFT, BOTTOM = 520, 150, 60, 24


def _scaled(values: Sequence[float], low: float, high: float) -> list[float]:
    """Each value as a part of the axis from its lowest to its highest."""
    least, most = min(values), max(values)
    span = (most - least) or 1.0
    return [low + (high - low) * (value - least) / span for value in values]


def scatter(x: Sequence[float], y: Sequence[float], x_label: str, y_label: str) -> str:
    """Points of y over x."""
    if not x:
        return ""
    across = _scaled(x, LEFT, WIDTH - 10)
    up = _scaled([*y, 0.0], HEIGHT - BOTTOM, 10)[: len(y)]
    dots = "".join(
        f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2.5"/>' for a, b in zip(across, up, strict=True)
    )
    return _framed(f'<g fill="#2a6f97">{dots}</g>', f"{max([*y, 0.0]):.3g}", x_label, y_label)


def bars(names: Sequence[str], values: Sequence[float], unit: str) -> str:
    """One bar each, from zero; the longest is as long as the figure."""
    longest = max([*map(abs, values), 1e-300])
    rows = []
    for row, (name, value) in enumerate(zip(names, values, strict=True)):
        top, length = 4 + 20 * row, 300 * max(value, 0.0) / longest
        rows.append(
            f'<text x="150" y="{top + 12}" text-anchor="end">{escape(name)}</text>'
            f'<rect x="156" y="{top}" width="{length:.1f}" height="15" fill="#2a6f97"/>'
            f'<text x="{162 + length:.1f}" y="{top + 12}">{value:.3g} {escape(unit)}</text>'
        )
    height = 8 + 20 * len(rows)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH + 40}" height="{height}" '
        f'font-family="sans-serif" font-size="11">{"".join(rows)}</svg>'
    )


def _framed(inside: str, top: str, x_label: str, y_label: str) -> str:
    ground = HEIGHT - BOTTOM
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
        f'font-family="sans-serif" font-size="11">'
        f'<path d="M{LEFT} 6V{ground}H{WIDTH - 6}" fill="none" stroke="#888"/>{inside}'
        f'<text x="{LEFT - 4}" y="14" text-anchor="end">{top}</text>'
        f'<text x="{LEFT - 4}" y="{ground}" text-anchor="end">0</text>'
        f'<text x="4" y="{HEIGHT // 2}">{escape(y_label)}</text>'
        f'<text x="{WIDTH - 6}" y="{HEIGHT - 6}" text-anchor="end">{escape(x_label)}</text></svg>'
    )
