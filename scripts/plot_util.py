# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts plot_*.py share: glissade.plot, and drawing without a display.

Where the package is missing, a line says so and the script ends with code 2.
"""

from __future__ import annotations

import json
import pathlib
import sys
import typing

if typing.TYPE_CHECKING:
    from matplotlib.figure import Figure

_SCRIPT = pathlib.Path(sys.argv[0]).name
_FOLDER = pathlib.Path(__file__).resolve().parents[1]

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np

    import glissade as gl
    from glissade import plot, quaternions
except ImportError as error:
    print(f'{_SCRIPT}: {error}: pip install "{_FOLDER}[plot]", or PYTHONPATH=BUILD/python of a build with '
          "GLISSADE_BUILD_PYTHON=ON", file=sys.stderr)
    sys.exit(2)

__all__ = ["fail", "gl", "np", "plot", "plt", "quaternions", "read_json", "save"]


def fail(message: object) -> typing.NoReturn:
    """Ends the script with a line and code 2."""
    print(f"{_SCRIPT}: {message}", file=sys.stderr)
    sys.exit(2)


def read_json(path: pathlib.Path) -> typing.Any:
    """The content of a JSON file; ends the script where it is none."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        fail(f"{path}: {error}")


def save(figure: Figure, path: pathlib.Path, dpi: int = 100) -> None:
    """Writes a picture and forgets it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=dpi)
    plt.close(figure)
