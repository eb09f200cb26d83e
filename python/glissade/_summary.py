# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a SolveSummary shows itself."""

from __future__ import annotations

import html
import typing

if typing.TYPE_CHECKING:
    from . import _core


def to_dict(self: _core.SolveSummary) -> dict[str, typing.Any]:
    """All of it as plain numbers, texts and lists: for JSON or a data frame."""
    return {
        "termination": self.termination.name.lower(),
        "converged": self.converged,
        "initial_cost": self.initial_cost,
        "final_cost": self.final_cost,
        "accepted_steps": self.accepted_steps,
        "rejected_steps": self.rejected_steps,
        "num_poses": self.num_poses,
        "num_landmarks": self.num_landmarks,
        "num_edges": self.num_edges,
        "num_threads": self.num_threads,
        "linear_solver": self.linear_solver,
        "linear_solver_reason": self.linear_solver_reason,
        "times": self.times,
        "iterations": [
            {
                "iteration": it.iteration,
                "accepted": it.accepted,
                "cost": it.cost,
                "cost_change": it.cost_change,
                "gradient_max": it.gradient_max,
                "step_norm": it.step_norm,
                "gain_ratio": it.gain_ratio,
                "lambda": it.damping,
                "linear_iterations": it.linear_iterations,
                "time_s": it.time_s,
                "total_time_s": it.total_time_s,
            }
            for it in self.iterations
        ],
    }


def text(self: _core.SolveSummary) -> str:
    return f"{self.table()}\n{self.brief_report()}"


def as_html(self: _core.SolveSummary) -> str:
    columns = ("iteration", "cost", "cost_change", "gradient_max", "damping", "time_s")
    rows = "".join(
        "<tr>" + "".join(f"<td>{getattr(it, name):.6g}</td>" for name in columns) + "</tr>"
        for it in self.iterations
    )
    head = "".join(f"<th>{name.replace('_', ' ')}</th>" for name in columns)
    return f"<p>{html.escape(self.brief_report())}</p><table><tr>{head}</tr>{rows}</table>"
