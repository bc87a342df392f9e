"""Runs each notebook beside this file, and fails where a cell does."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

for path in sorted(Path(__file__).parent.glob("*.ipynb")):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(
        notebook, timeout=600, resources={"metadata": {"path": str(path.parent)}}
    ).execute()
    cells = sum(cell.cell_type == "code" for cell in notebook.cells)
    sys.stdout.write(f"{path.name}: {cells} cells\n")
