"""The native part of the package."""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "HAS_RECORDINGS",
    "Frame",
    "Function",
    "Printed",
    "TauscopeError",
    "__version__",
    "check",
    "describe",
    "options",
    "read",
    "refitted",
    "run",
    "simulate",
]

__version__: str
HAS_RECORDINGS: bool

class TauscopeError(ValueError):
    row: int | None
    column: str | None

@final
class Frame:
    def __new__(cls, table: Any, names: dict[str, str | None]) -> Frame: ...

@final
class Function:
    def __new__(
        cls,
        id: str,
        stage: str,
        function: Callable[..., float],
        arguments: list[str],
        parameters: list[tuple[str, float, float | None, float | None, float]],
        states: list[tuple[str, float | None]],
    ) -> Function: ...
    @property
    def id(self) -> str: ...

@final
class Printed:
    def text(self) -> str: ...

def run(
    arguments: list[str],
    logs: Any = None,
    progress: Callable[[str, int, int], None] | None = None,
    keeps: bool = False,
    functions: Sequence[Function] = ...,
) -> tuple[bool, Printed, list[tuple[str, str]], bool]: ...
def options(command: str) -> list[tuple[str, str, bool, bool]] | None: ...
def read(arguments: list[str], logs: Any = None) -> tuple[list[dict[str, Any]], list[str]]: ...
def check(text: str, name: str, functions: Sequence[Function]) -> list[str]: ...
def describe(
    text: str, of: str, functions: Sequence[Function]
) -> tuple[float, float, list[tuple[str, str, str, list[tuple[str, float]]]]]: ...
def refitted(
    text: str, of: str, values: list[tuple[str, float]], functions: Sequence[Function]
) -> str: ...
def simulate(
    text: str,
    of: str,
    input: npt.NDArray[np.float64],
    period_s: float,
    output: float,
    start_s: float,
    others: npt.NDArray[np.float64] | None,
    radians_per_output_unit: float,
    trial: str,
    functions: Sequence[Function],
) -> npt.NDArray[np.float64]: ...
