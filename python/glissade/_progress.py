# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line that a long solve shows."""

from __future__ import annotations

import sys
import typing
import warnings

if typing.TYPE_CHECKING:
    from ._core import IterationSummary

_SHOWN_AFTER_S = 1.0


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")  # not imported: half a second of an ordinary program's time
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and type(shell).__name__ in ("ZMQInteractiveShell", "Shell")


def _is_terminal(stream: typing.Any) -> bool:
    try:
        return bool(stream.isatty())
    except (AttributeError, ValueError):
        return False


class Progress:
    """Iterations, cost and rate once a solve takes longer than a second (tqdm; a bar of its own in
    notebooks)."""

    def __init__(self) -> None:
        self._bar: typing.Any = None

    def update(self, iteration: IterationSummary) -> None:
        try:
            self._show(iteration)
        except (AttributeError, ImportError, OSError, ValueError):
            pass  # a stream that is closed, or none: no reason to end a solve

    def _show(self, iteration: IterationSummary) -> None:
        if self._bar is None:
            if iteration.total_time_s < _SHOWN_AFTER_S:
                return
            with warnings.catch_warnings():  # a notebook without ipywidgets has a bar of text, that is all
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]

            self._bar = tqdm(desc="solve", unit="it", initial=iteration.iteration)
        self._bar.set_postfix_str(
            f"cost {iteration.cost:.6g}, lambda {iteration.damping:.1e}", refresh=False
        )
        self._bar.update(iteration.iteration - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            try:
                self._bar.close()
            except (AttributeError, OSError, ValueError):
                pass


def make(asked: bool) -> Progress | None:
    """None where nobody asked and nobody looks."""
    if asked or _in_notebook() or _is_terminal(sys.stderr):
        return Progress()
    return None
