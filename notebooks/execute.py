"""Runs the notebooks and stores their outputs: python3 notebooks/execute.py [NOTEBOOK…]

What differs from machine to machine is left out: execution counts, times, versions, widgets. A cell that raises or
writes to standard error stops the work, and its notebook stays as it was.
"""

import os
import sys
import tempfile
from pathlib import Path

import nbclient
import nbformat

os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")  # which only warns of frozen modules
FOLDER = Path(__file__).resolve().parent
LONGEST = 300  # s that a cell may take


def executed(file: Path) -> nbformat.NotebookNode:
    """The notebook with the outputs that it has now, run in its folder."""
    notebook = nbformat.read(file, as_version=4)
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3", "language": "python"}
    client = nbclient.NotebookClient(notebook, timeout=LONGEST, kernel_name="python3",
                                     resources={"metadata": {"path": str(file.parent)}})
    with tempfile.TemporaryDirectory() as nobodys:  # without what a user has set for IPython
        client.execute(env=os.environ | {"IPYTHONDIR": nobodys})
    return tidy(notebook)


def tidy(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Only what a reader sees."""
    notebook.metadata = {"kernelspec": notebook.metadata.kernelspec, "language_info": {"name": "python"}}
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    for number, cell in enumerate(notebook.cells, 1):
        cell.id = f"cell-{number}"
        cell.metadata = {}
        if cell.cell_type != "code":
            continue
        cell.execution_count = None
        cell.outputs = joined(cell.outputs)
        for output in cell.outputs:
            if output.output_type == "stream" and output.name == "stderr":
                raise RuntimeError(f"cell {number} writes to standard error: {output.text}")
            if "execution_count" in output:
                output.execution_count = None
            output.pop("metadata", None)
            if output.output_type in ("display_data", "execute_result"):
                output.metadata = {}
                if "image/png" in output.data:
                    output.data.pop("text/plain", None)
    return notebook


def joined(outputs: list[nbformat.NotebookNode]) -> list[nbformat.NotebookNode]:
    """Pieces in which printed text happened to come, as one."""
    whole: list[nbformat.NotebookNode] = []
    for output in outputs:
        if whole and output.output_type == whole[-1].output_type == "stream" and output.name == whole[-1].name:
            whole[-1].text += output.text
        else:
            whole.append(output)
    return whole


def main(files: list[Path]) -> None:
    for file in files or sorted(FOLDER.glob("*.ipynb")):
        notebook = executed(file)
        whole = file.with_suffix(".new")
        nbformat.write(notebook, whole)
        os.replace(whole, file)
        print(file.name)


if __name__ == "__main__":
    main([Path(one).resolve() for one in sys.argv[1:]])
