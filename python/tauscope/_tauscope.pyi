"""The native part of the package."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

__version__: str
HAS_RECORDINGS: bool

class TauscopeError(ValueError):
    row: int | None
    column: str | None

def run(
    arguments: list[str],
    logs: Any = None,
    progress: Callable[[str, int, int], None] | None = None,
    keeps: bool = False,
) -> tuple[bool, str, list[tuple[str, str]], bool]: ...
def options(command: str) -> list[tuple[str, str, bool, bool]] | None: ...
def read(arguments: list[str], logs: Any = None) -> tuple[list[dict[str, Any]], list[str]]: ...
def check(text: str, name: str) -> list[str]: ...
def describe(
    text: str, of: str
) -> tuple[float, float, list[tuple[str, str, str, list[tuple[str, float]]]]]: ...
def refitted(text: str, of: str, values: list[tuple[str, float]]) -> str: ...
def simulate(
    text: str,
    of: str,
    input: npt.NDArray[np.float64],
    period_s: float,
    output: float,
    start_s: float,
    others: npt.NDArray[np.float64] | None,
    radians_per_output_unit: float,
) -> npt.NDArray[np.float64]: ...
