"""What the documentation shows runs as it stands."""

from __future__ import annotations

from pathlib import Path

import pytest

import tauscope

ROOT = Path(__file__).parents[2]


def blocks() -> list[str]:
    text = (ROOT / "docs" / "python.md").read_text()
    return [part.split("```")[0] for part in text.split("```python\n")[1:]]


def test_the_page_runs_from_the_data_frame_to_the_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(ROOT / "data")
    first, *rest = blocks()
    if not tauscope.HAS_RECORDINGS:
        first = "\n".join(line for line in first.splitlines() if ".rrd" not in line)
    names: dict[str, object] = {}
    exec(first, names)
    names["u"] = [0.0, 1.0, 1.0, 0.0]
    for block in rest:
        exec(block, names)
    assert (tmp_path / "model.toml").exists() and (tmp_path / "boom.fmu").exists()


def test_every_function_and_setting_of_the_page_is_there() -> None:
    page = (ROOT / "docs" / "python.md").read_text()
    for name in tauscope.__all__:
        if name[0].islower() and name not in ("keywords",):
            assert f"`{name}(" in page, name
    assert {"alpha", "passband", "first_last", "joint", "output_limits"} <= set(
        tauscope.keywords("estimate")
    )
