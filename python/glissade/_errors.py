# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is raised where a call is refused."""

from __future__ import annotations

import typing

if typing.TYPE_CHECKING:
    from ._core import EdgeArray, StatusCode, VertexArray


class Error(RuntimeError):
    """A call was refused; what it was asked to change is as before.

    code: what went wrong. vertex, edge: the culprit, an array of one handle, or None.
    """

    def __init__(
        self,
        message: str,
        code: StatusCode,
        vertex: VertexArray | None = None,
        edge: EdgeArray | None = None,
    ) -> None:
        super().__init__(message)
        self.code = code
        self.vertex = vertex
        self.edge = edge

    def __reduce__(self) -> tuple[typing.Any, ...]:
        # To another process: handles mean nothing there.
        return type(self), (self.args[0], self.code)

    def __str__(self) -> str:
        return f"{super().__str__()} [{self.code.name}]"
