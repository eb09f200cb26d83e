#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the direction of includes between modules.

A file of a module may include headers of its own module and of the modules listed before it. The
kernels include their own headers and a few C headers without inline code, never Eigen and never the
standard library: an inline function compiled for AVX-512 may become everybody's copy.
"""

import pathlib
import re
import sys

# One direction only. A module may use those before it. Testing (the public checkers) comes last: it is
# for tests and users, no module may lean on it.
MODULES = (
    "base lie kernels vertices eval losses cameras edges lanes graph structure linear gauge "
    "minimizer marginal covariance problem imu window io sim vision bridge testing"
).split()

# Headers that define types and macros only, and declarations of C functions.
KERNEL_SYSTEM_HEADERS = {"stddef.h", "stdint.h"}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def module_of(path, root):
    """The module a source file belongs to, None for top-level headers (glissade.h, testing.h)."""
    parts = path.relative_to(root).parts
    if parts[0] == "include":
        parts = parts[2:]
    else:
        parts = parts[1:]
    return parts[0] if len(parts) > 1 else None


def module_of_include(name, from_path, root):
    """The module of an included header, None where it is not one of ours."""
    for base in (root / "include", root / "src", from_path.parent):
        target = base / name
        if target.is_file():
            target = target.resolve()
            if root in target.parents:
                return module_of(target, root) or "top level"
    return "missing" if name.startswith("glissade/") else None


def check(path, root):
    module = module_of(path, root)
    if module is None:
        return
    shown = path.relative_to(root)
    if module not in MODULES:
        yield f"{shown}: no such module: {module} (add it to MODULES in {pathlib.Path(__file__).name})"
        return
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        kind, name = match.groups()
        other = module_of_include(name, path, root)
        where = f"{shown}:{number}"
        if other == "missing":
            yield f"{where}: {name} does not exist"
        elif other == "top level":
            yield f"{where}: module {module} must not include the top-level header {name}"
        elif module == "kernels":
            if other is None:
                if kind == '"' or name not in KERNEL_SYSTEM_HEADERS:
                    if not kernel_dispatch_exception(path, name):
                        yield f"{where}: kernels must not include {name}"
            elif other != "kernels":
                yield f"{where}: kernels must not include {name} of module {other}"
        elif other is not None:
            if other not in MODULES:
                yield f"{where}: {name} is in no known module"
            elif MODULES.index(other) > MODULES.index(module):
                yield f"{where}: module {module} must not know module {other} ({name})"


def kernel_dispatch_exception(path, name):
    """The choice of the table (src/kernels/*.cpp) reads the environment and the CPU's flags."""
    return path.parent.name == "kernels" and path.suffix == ".cpp" and name in {
        "stdlib.h", "string.h", "cpuid.h"}


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
    if root.is_file():
        root = root.parent.parent
    files = [p for top in ("include/glissade", "src") for p in sorted((root / top).rglob("*"))
             if p.suffix in {".h", ".cpp", ".inc", ".hpp"}]
    if not files:
        print(f"no sources under {root}", file=sys.stderr)
        return 1
    problems = [problem for path in files for problem in check(path, root)]
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{'FAIL' if problems else 'ok'}: includes of {len(files)} files, "
          f"{len(problems)} against the order of modules")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
