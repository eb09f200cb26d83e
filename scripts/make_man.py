#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes manual pages, the reference in Markdown and completions for bash and zsh of what the programs
themselves say (--help).

    make_man.py [--man DIR] [--markdown DIR] [--bash DIR] [--zsh DIR] FOLDER_OF_THE_EXECUTABLES
"""

import argparse
import pathlib
import re
import sys

import completions
import help_text


# ---- Manual pages ------------------------------------------------------------------------------------


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"(?m)^([.'])", r"\\&\1", text)


def laid_out(lines):
    return [".nf", *(roff(line) for line in lines), ".fi"]


def block_in_roff(block):
    """Paragraphs are filled, indented lines stay as they are."""
    out, k = [".PP"], 0
    while k < len(block):
        end = k
        indented = block[k].startswith(" ")
        while end < len(block) and block[end].startswith(" ") == indented:
            end += 1
        out += laid_out(block[k:end]) if indented else [roff(" ".join(block[k:end]))]
        k = end
    return out


def options_in_roff(options):
    out = []
    for option in options:
        names = ", ".join(rf"\fB{roff(name)}\fR" for name in option.names)
        kind = f" {roff(option.type)}" if option.words else rf" \fI{roff(option.type)}\fR" if option.type else ""
        out += [".TP", names + kind, roff(option.text)]
    return out


def manual_page(title, page, line, version, others):
    out = ['.\\" Made by scripts/make_man.py of what the program says itself.',
           f'.TH "{roff(title.upper())}" 1 "" "glissade {version}" "glissade"',
           ".SH NAME", f"{roff(title)} \\- {roff(line)}",
           ".SH SYNOPSIS", rf"\fB{roff(page.name)}\fR {roff(page.usage)}",
           ".SH DESCRIPTION", roff(page.description)]
    is_list = title == "glissade"
    if is_list:
        out.append(".SH COMMANDS")
    for block in page.notes if is_list else []:
        out += block_in_roff(block)
    if page.arguments and not is_list:
        out += [".SH ARGUMENTS", *options_in_roff(page.arguments)]
    out += [".SH OPTIONS", *options_in_roff(page.options)]
    if page.notes and not is_list:
        out.append(".SH NOTES")
        for block in page.notes:
            out += block_in_roff(block)
    if page.examples:
        out += [".SH EXAMPLES", *laid_out(page.examples)]
    if page.exit_code:
        out += [".SH EXIT STATUS", roff(page.exit_code)]
    see = [rf"\fB{roff(other)}\fR(1)" for other in others if other != title]
    out += [".SH SEE ALSO", ", ".join(see)]
    return "\n".join(out) + "\n"


def write_manual(pages, folder, version):
    folder.mkdir(parents=True, exist_ok=True)
    for title, (page, line, program) in pages.items():
        text = manual_page(title, page, line, version, pages)
        (folder / f"{title}.1").write_text(text, encoding="utf-8")
        if program != title:
            (folder / f"{program}.1").write_text(f".so man1/{title}.1\n", encoding="utf-8")


# ---- Markdown ----------------------------------------------------------------------------------------


def markdown(text):
    return re.sub(r"([\\`*_<>\[\]#|])", r"\\\1", text)


def fenced(lines):
    return ["```text", *lines, "```", ""]


def block_in_markdown(block):
    out, k = [], 0
    while k < len(block):
        end = k
        indented = block[k].startswith(" ")
        while end < len(block) and block[end].startswith(" ") == indented:
            end += 1
        out += fenced(line[2:] for line in block[k:end]) if indented else [*map(markdown, block[k:end]), ""]
        k = end
    return out


def options_in_markdown(options):
    # The shown form is code: nothing in it is escaped.
    return [*(f"- `{o.shown}`: {markdown(o.text)}" for o in options), ""]


def markdown_page(title, page, line, program):
    out = [f"# {page.name}", "", markdown(line[0].upper() + line[1:]) + ".", ""]
    if program != title:
        out += [f"The program `{program}` by another name.", ""]
    out += fenced([f"{page.name} {page.usage}"]) + [markdown(page.description), ""]
    if page.arguments:
        out += ["## Arguments", "", *options_in_markdown(page.arguments)]
    out += ["## Options", "", *options_in_markdown(page.options)]
    if page.notes:
        out += ["## Notes" if title != "glissade" else "## Commands", ""]
        for block in page.notes:
            out += block_in_markdown(block)
    if page.examples:
        out += ["## Examples", "", *fenced(page.examples)]
    if page.exit_code:
        out += ["## Exit code", "", markdown(page.exit_code), ""]
    return "\n".join(out).rstrip("\n") + "\n"


def write_markdown(pages, folder):
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["# Programs", "", "Made of what each says with `--help`.", ""]
    for title, (page, line, program) in pages.items():
        (folder / f"{title}.md").write_text(markdown_page(title, page, line, program), encoding="utf-8")
        lines.append(f"- [{markdown(page.name)}]({title}.md): {markdown(line)}")
    (folder / "index.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for what in ("man", "markdown", "bash", "zsh"):
        parser.add_argument(f"--{what}", type=pathlib.Path, metavar="DIR")
    parser.add_argument("executables", type=pathlib.Path, metavar="FOLDER_OF_THE_EXECUTABLES")
    arguments = parser.parse_args()
    pages = help_text.read_all(arguments.executables.resolve())
    if not pages:
        sys.exit(f"make_man.py: {arguments.executables}: no program of glissade is in this folder")
    if arguments.man:
        write_manual(pages, arguments.man, help_text.version_of(arguments.executables.resolve()))
    if arguments.markdown:
        write_markdown(pages, arguments.markdown)
    if arguments.bash:
        completions.write_bash(pages, arguments.bash)
    if arguments.zsh:
        completions.write_zsh(pages, arguments.zsh)


if __name__ == "__main__":
    main()
