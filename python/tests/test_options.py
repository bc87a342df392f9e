"""The types that editors complete from are those of the program, and hold."""

from __future__ import annotations

import ast
import importlib.util
import inspect
from graphlib import TopologicalSorter
from pathlib import Path
from types import ModuleType

import pytest

import tauscope
from tauscope import _options
from tauscope._messages import COMMANDS

HERE = Path(__file__).parents[1]
PACKAGE = Path(tauscope.__file__).parent

#: What mypy accepts, line by line, and what not.
CALLS = """\
from pathlib import Path
import tauscope
found = tauscope.estimate("log.csv", alpha="0.1s", max_delay=40, joint=["boom"], paper=True)
found = tauscope.estimate("log.csv", first_last="keep", method=("auto", "hinge"), max_sse=None)
tauscope.sweep(Path("log.csv"), alpha=[5, 10], passband="none").combinations["alpha"]
tauscope.simulate(effect=["dead_band"], strength="weak", duration=60)
tauscope.design(hold=(0.5, 2), levels=[-1, 0.5], output="input.csv")
tauscope.Model("").fit("log.csv", split="blocks").score("log.csv", sample_period=0.01)
tauscope.estimate("log.csv", alhpa=5)  # wrong
tauscope.estimate("log.csv", first_last="kept")  # wrong
tauscope.estimate("log.csv", paper="yes")  # wrong
tauscope.explain("log.csv", split="halves")  # wrong
tauscope.simulate(alpha=5)  # wrong
"""


def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("stubs", HERE / "stubs.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.skipif(not tauscope.HAS_RECORDINGS, reason="built without options of recordings")
def test_the_types_are_made_from_the_options_of_the_program() -> None:
    written = Path(_options.__file__).read_text("utf-8")
    assert written == generator().module(), "run `python stubs.py` in the folder python"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_setting_has_a_type_and_is_in_the_signature(command: str) -> None:
    typed = set(getattr(_options, f"{command.capitalize()}Options").__annotations__)
    arguments = inspect.signature(getattr(tauscope, command)).parameters
    assert set(tauscope.keywords(command)) <= set(arguments)
    own = set(arguments) - typed
    assert own <= {"data", "model", "progress", "effect", "output", "plant", "truth"}
    assert typed <= set(tauscope.keywords(command))


def test_mypy_knows_right_settings_from_wrong_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It looks for the package where it is started."""
    api = pytest.importorskip("mypy.api")
    script = tmp_path / "calls.py"
    script.write_text(CALLS)
    monkeypatch.chdir(HERE)
    said, _, _ = api.run(["--config-file=pyproject.toml", str(script)])
    lines = {int(line.split(":")[1]) for line in said.splitlines() if ": error:" in line}
    wrong = {at for at, line in enumerate(CALLS.splitlines(), 1) if line.endswith("# wrong")}
    assert lines == wrong, said


def imported(path: Path) -> set[str]:
    """The modules of the package that a module imports, wherever in it."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            found |= {node.module} if node.module else {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert (node.module or "").split(".")[0] != "tauscope", path
        elif isinstance(node, ast.Import):
            assert all(alias.name.split(".")[0] != "tauscope" for alias in node.names), path
    return found


def test_no_module_imports_itself_by_way_of_others() -> None:
    """Also not inside a function, or for types alone."""
    graph = {path.stem: imported(path) for path in PACKAGE.glob("*.py")}
    assert graph["_commands"] >= {"_model", "_results", "_options"}
    TopologicalSorter(graph).prepare()
