#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the numbers that the documentation states with what the programs say.

    check_docs_figures.py [--bin FOLDER] [--results FOLDER] [--write] [COMMAND...]

docs/figures.json lists commands and figures. A command is run once, with --json, and its result kept in
the folder of results where one is given (a result that is there already is used). A figure is a piece of
a document with `@` for each number (and `...` for what else may stand in a cell), and for each number what
it must be: a Python expression over the results (`study["covariance"]["relative_error"]`), in which the
functions below are known. `tolerance` is relative (default 0.01), `absolute` is not; `factor` is for
numbers that are rounding: at most so many times larger or smaller. Commands with $GLISSADE_DATA are left
out where that folder does not have what they name.

--write puts the numbers of this run into the documents, with as many digits as stood there.
With names of commands only the figures of these are looked at.

Exit code: 0 where all agree, 1 where not, 2 where something cannot be run. Needs only Python.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


# ---- What expressions may use --------------------------------------------------------------------
def row(rows, **wanted):
    """The row with these values."""
    for r in rows:
        if all(r.get(key) == value for key, value in wanted.items()):
            return r
    raise KeyError(wanted)


def column(rows, *path):
    """What each row has there."""
    values = []
    for r in rows:
        for key in path:
            r = r[key]
        values.append(r)
    return values


def percent(a, b):
    """How much a is over b."""
    return 100 * (a / b - 1)


KNOWN = {"row": row, "column": column, "percent": percent, "median": statistics.median, "max": max,
         "min": min, "abs": abs, "len": len, "sum": sum, "range": range, "round": round}


# ---- Commands ------------------------------------------------------------------------------------
def can_run(command):
    """Whether the data sets are here that the command names."""
    data = os.environ.get("GLISSADE_DATA")
    return all(pathlib.Path(word.replace("$GLISSADE_DATA", data)).exists() if data else False
               for word in command if "$GLISSADE_DATA" in word)


def run(name, command, folder, results):
    """The parsed result of a command."""
    command = [os.path.expandvars(word) for word in command]
    path = results / f"{name}.json"
    if not path.exists():
        words = [str(path) if word == "{json}" else word for word in command]
        print(f"{name}: {' '.join(command[:-2])}", flush=True)
        done = subprocess.run([str(folder / words[0]), *words[1:]], cwd=ROOT, text=True,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        if done.returncode != 0:
            raise OSError(f"{' '.join(words)} ended with {done.returncode}: {done.stderr.strip()}")
    return json.loads(path.read_text(encoding="utf-8"))


# ---- Numbers in documents ------------------------------------------------------------------------
def pattern_of(text):
    """The piece of a document, however its lines are broken."""
    parts = [r"\s+".join(re.escape(word) for word in re.split(r"\s+", part)) for part in text.split("@")]
    # Numbers of other figures in between: "...".
    return re.compile(f"({NUMBER})".join(parts).replace(r"\.\.\.", r"[^|\n]*"))


def written_like(value, like):
    """A number with as many digits as another."""
    if "e" in like or "E" in like:
        mantissa = re.split("[eE]", like)[0]
        digits = len(mantissa.split(".")[1]) if "." in mantissa else 0
        head, exponent = f"{value:.{digits}e}".split("e")
        return f"{head}e{int(exponent)}" if re.search(r"e-?\d$", like) else f"{head}e{exponent}"
    if "." in like:
        text = f"{value:.{len(like.split('.')[1])}f}"
        if like.lstrip("+-").startswith("."):
            text = re.sub(r"^(-?)0\.", r"\1.", text)
    else:
        text = f"{value:.0f}"
    if float(text) == 0:
        return text.lstrip("-")
    return f"+{text}" if like[0] in "+-" and value > 0 else text


def agrees(stated, value, like, figure):
    if "factor" in figure:
        return 0 < value <= stated * figure["factor"] and value >= stated / figure["factor"]
    # A number is right if it is what the value rounds to, or nearly.
    if float(written_like(value, like)) == stated:
        return True
    if "absolute" in figure:
        return abs(stated - value) <= figure["absolute"]
    return abs(stated - value) <= figure.get("tolerance", 0.01) * abs(value)


def check(figure, results, documents, write):
    """Messages about what does not agree; documents are changed where asked."""
    name = figure["doc"]
    if name not in documents:
        documents[name] = (ROOT / name).read_text(encoding="utf-8")
    text = documents[name]
    match = pattern_of(figure["text"]).search(text)
    if match is None:
        return [f"{name}: does not say \"{figure['text']}\""]
    if len(figure["values"]) != len(match.groups()):
        return [f"{name}: \"{figure['text']}\" has {len(match.groups())} numbers, not "
                f"{len(figure['values'])}"]
    wrong, pieces, at = [], [], match.start()
    for k, expression in enumerate(figure["values"], 1):
        value = float(eval(expression, {"__builtins__": {}}, {**KNOWN, **results}))  # noqa: S307
        stated = match.group(k)
        if not agrees(float(stated), value, stated, figure):
            line = text.count("\n", 0, match.start(k)) + 1
            wrong.append(f"{name}:{line}: {stated} is {value:.6g} ({expression})")
        pieces += [text[at:match.start(k)], written_like(value, stated)]
        at = match.end(k)
    pieces.append(text[at:match.end()])
    if write:
        documents[name] = text[:match.start()] + "".join(pieces) + text[match.end():]
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin",
                        help="where the programs are (default build/release/bin)")
    parser.add_argument("--results", type=pathlib.Path, help="folder of the JSON results, kept")
    parser.add_argument("--write", action="store_true", help="write the numbers into the documents")
    parser.add_argument("commands", nargs="*", help="commands of docs/figures.json (default: all)")
    args = parser.parse_args()
    table = json.loads((ROOT / "docs/figures.json").read_text(encoding="utf-8"))
    unknown = set(args.commands) - set(table["commands"])
    if unknown:
        parser.error(f"docs/figures.json has no command {', '.join(sorted(unknown))}")
    wanted = {name: command for name, command in table["commands"].items()
              if not args.commands or name in args.commands}
    for name in [name for name, command in wanted.items() if not can_run(command)]:
        del wanted[name]
        print(f"{name}: left out, its data are not in $GLISSADE_DATA")

    with tempfile.TemporaryDirectory() as temporary:
        folder = args.results or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            results = {name: run(name, command, args.bin.resolve(), folder.resolve())
                       for name, command in wanted.items()}
        except (OSError, ValueError) as error:
            print(f"check_docs_figures.py: {error}", file=sys.stderr)
            return 2
    figures = [f for f in table["figures"] if f["command"] in wanted]
    documents, wrong, numbers = {}, [], 0
    for figure in figures:
        numbers += len(figure["values"])
        wrong += check(figure, results, documents, args.write)
    for message in wrong:
        print(message, file=sys.stderr)
    if args.write:
        for name, text in documents.items():
            (ROOT / name).write_text(text, encoding="utf-8")
    print(f"{'FAIL' if wrong else 'ok'}: {numbers} numbers of {len(figures)} figures, "
          f"{len(wrong)} do not agree")
    return 1 if wrong and not args.write else 0


if __name__ == "__main__":
    sys.exit(main())
