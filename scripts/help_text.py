# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the programs say of themselves: reads their --help, whose form is that of app/common/options.cpp.
Manual pages, completions and the reference are made of it, so that nothing is told twice."""

import dataclasses
import pathlib
import re
import subprocess

INDENT = 30  # columns before the text of an option


@dataclasses.dataclass
class Option:
    """An option, or an argument by its place."""

    names: list  # ["-h", "--help"]; of an argument ["FILE"]
    type: str  # "N", "X", "FILE", "lm|nielsen|dogleg"; "" of a flag
    text: str
    repeatable: bool = False

    @property
    def name(self):
        return self.names[-1]

    @property
    def takes_value(self):
        return self.type != ""

    @property
    def words(self):
        """Those that it takes, where it takes some words only; "huber:" where a number follows."""
        words = self.type.split("|")
        return [re.sub(r"(?<=:)[A-Z]+$", "", word) for word in words] if len(words) > 1 else []

    @property
    def takes(self):
        """"words", "file", "folder", "path" (either), "value" or "" (nothing)."""
        if self.words:
            return "words"
        kinds = {"FILE": "file", "DIR": "folder", "PATH": "path", "": ""}
        return kinds.get(self.type, "value")

    @property
    def shown(self):
        return ", ".join(self.names) + (f" {self.type}" if self.type else "")


@dataclasses.dataclass
class Help:
    name: str  # "glissade solve", "make_data"
    description: str
    usage: str  # what follows the name
    arguments: list
    options: list
    notes: list  # blocks of lines that follow the options; indented ones are laid out
    examples: list  # lines, not indented
    exit_code: str

    def option(self, name):
        return next((o for o in self.options if name in o.names), None)


@dataclasses.dataclass
class Command:
    """A line of `glissade --help`."""

    name: str
    program: str
    group: str
    text: str


def options_of(lines):
    """Of a block under "Options:" or "Positionals:"."""
    found = []
    for line in lines:
        if line.startswith("  ") and not line.startswith(" " * INDENT):
            head, _, text = line.strip().partition("  ")
            names, _, kind = head.partition(" ")
            repeatable = kind.endswith(" ...")
            found.append(Option(names.split(","), kind.removesuffix(" ..."), text.strip(), repeatable))
        elif found:
            found[-1].text = f"{found[-1].text} {line.strip()}".strip()
    return found


def parse(text):
    head, _, rest = text.partition("Usage: ")
    usage, _, rest = rest.partition("\n")
    at = re.search(r" (?=\[OPTIONS\])", usage)
    name, usage = (usage[:at.start()], usage[at.end():]) if at else (usage, "")
    blocks = [block.splitlines() for block in re.split(r"\n{2,}", rest.strip("\n"))]
    arguments, options, notes, examples, exit_code = [], [], [], [], ""
    for block in blocks:
        if block[0] == "Positionals:":
            arguments = options_of(block[1:])
        elif block[0] == "Options:":
            options = options_of(block[1:])
        elif block[0] == "Examples:":
            examples = [line.strip() for line in block[1:]]
        elif block[0].startswith("Exit code: "):
            exit_code = " ".join(block).removeprefix("Exit code: ")
        else:
            notes.append(block)
    return Help(name, " ".join(head.split()), usage, arguments, options, notes, examples, exit_code)


def ask(program, called="", option="--help"):
    """What a program prints; `called` as if by another name ("glissade solve")."""
    done = subprocess.run([called or str(program), option], executable=str(program), capture_output=True,
                          text=True, check=True, timeout=60)
    return done.stdout


def commands_of(front):
    """The commands that the help of `glissade` lists."""
    found = []
    for block in front.notes:
        group = ""
        for line in block:
            line_of_one = re.fullmatch(r"  (\w+) +(.*) \[(\w+)\]", line)
            if line_of_one:
                found.append(Command(line_of_one[1], line_of_one[3], group, line_of_one[2]))
            elif line.endswith(":"):
                group = line[:-1]
    return found


def program_names(folder, sources):
    """The programs in a folder that have a source in app/."""
    return sorted(p.stem for p in sources.glob("*.cpp") if (folder / p.stem).is_file())


def read_all(folder):
    """{page: (Help, one line, program)} of the programs in a folder of executables: "glissade",
    "glissade-solve", "make_data", ..."""
    sources = pathlib.Path(__file__).resolve().parents[1] / "app"
    pages = {}
    behind_a_command = set()
    if (folder / "glissade").is_file():
        front = parse(ask(folder / "glissade"))
        pages["glissade"] = (front, front.description.rstrip("."), "glissade")
        for command in commands_of(front):
            behind_a_command.add(command.program)
            program = folder / command.program
            if program.is_file():
                text = ask(program, f"glissade {command.name}")
                pages[f"glissade-{command.name}"] = (parse(text), command.text, command.program)
    for name in program_names(folder, sources):
        if name != "glissade" and name not in behind_a_command:
            page = parse(ask(folder / name))
            first = re.split(r"(?<=[.?!:]) ", page.description)[0].rstrip(".:")
            pages[name] = (page, first[0].lower() + first[1:], name)
    return pages


def version_of(folder):
    """"0.1.0", of any program."""
    sources = pathlib.Path(__file__).resolve().parents[1] / "app"
    name = program_names(folder, sources)[0]
    return re.search(r"\(glissade\) (\S+)", ask(folder / name, option="--version"))[1]
