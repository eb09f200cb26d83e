# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Completion scripts for bash and zsh, of the help of the programs (help_text.py). For make_man.py."""

HEAD = "# Made by scripts/make_man.py of what the programs say with --help.\n"


def commands_of(pages):
    """{command of glissade: program}"""
    return {title.removeprefix("glissade-"): program for title, (_, _, program) in pages.items()
            if title.startswith("glissade-")}


# ---- bash ----------------------------------------------------------------------------------------------

BASH = r'''
# _glissade PROGRAM: completes the word at hand. "=" and ":" are words of their own to bash.
_glissade() {
  local program=${1##*/} cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  if [[ $program == glissade ]]; then
    if ((COMP_CWORD == 1)) || { ((COMP_CWORD == 2)) && [[ $prev == help ]]; }; then
      mapfile -t COMPREPLY < <(compgen -W "$(_glissade_commands) help --help --version" -- "$cur")
      return
    fi
    program=$(_glissade_program "${COMP_WORDS[1]}")
  fi
  if [[ $cur == "=" ]]; then
    cur=''
  elif [[ $prev == "=" ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  local takes=''
  [[ $prev == --* ]] && takes=$(_glissade_value "$program" "$prev")
  case $takes in
    words*)
      mapfile -t COMPREPLY < <(compgen -W "${takes#words }" -- "$cur")
      [[ ${COMPREPLY[0]} == *: ]] && compopt -o nospace
      ;;
    folder)
      mapfile -t COMPREPLY < <(compgen -d -- "$cur")
      compopt -o filenames
      ;;
    value) ;;
    *)
      if [[ -z $takes && $cur == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_glissade_options "$program")" -- "$cur")
      else
        local words=''
        [[ -z $takes ]] && words=$(_glissade_arguments "$program")
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur"; compgen -f -- "$cur")
        compopt -o filenames
      fi
      ;;
  esac
} 2>/dev/null
'''


def bash_case(name, subject, rows):
    lines = [f"{name}() {{", f"  case {subject} in"]
    lines += [f"    {key}) echo '{value}' ;;" for key, value in rows]
    return "\n".join([*lines, "  esac", "}", ""])


def bash_script(pages):
    by_program = {program: page for page, _, program in pages.values()}
    commands = commands_of(pages)
    words = {"file": "file", "path": "file", "folder": "folder", "value": "value"}
    values = []
    for program, page in by_program.items():
        for option in page.options:
            takes = "words " + " ".join(option.words) if option.words else words.get(option.takes)
            if takes:
                values.append((f"{program}:{option.name}", takes))
    parts = [
        f"_glissade_commands() {{\n  echo '{' '.join(commands)}'\n}}\n",
        bash_case("_glissade_program", '"$1"', commands.items()),
        bash_case("_glissade_options", '"$1"', [(program, " ".join(name for o in page.options for name in o.names))
                                                for program, page in by_program.items()]),
        bash_case("_glissade_arguments", '"$1"', [(program, " ".join(w for a in page.arguments for w in a.words))
                                                  for program, page in by_program.items()]),
        bash_case("_glissade_value", '"$1:$2"', values)]
    return HEAD + "\n".join(parts) + BASH + f"\ncomplete -F _glissade {' '.join(by_program)}\n"


def write_bash(pages, folder):
    """One script, and a file of the name of every other program that reads it: bash looks by name."""
    folder.mkdir(parents=True, exist_ok=True)
    names = [program for _, _, program in pages.values()]
    (folder / names[0]).write_text(bash_script(pages), encoding="utf-8")
    for name in names[1:]:
        (folder / name).write_text(HEAD + f'. "${{BASH_SOURCE[0]%/*}}/{names[0]}"\n', encoding="utf-8")


# ---- zsh -----------------------------------------------------------------------------------------------


def zsh_text(text, limit=90):
    """For [...] of a specification: the first sentence, without what ends it there."""
    text = text.split(". ")[0]
    text = text if len(text) <= limit else text[:limit].rsplit(" ", 1)[0] + " ..."
    for character in "\\[]:":
        text = text.replace(character, "\\" + character)
    return text.replace("'", "'\\''")


def zsh_action(option):
    words = [word.replace(":", "\\:") for word in option.words]
    actions = {"words": f"({' '.join(words)})", "file": "_files", "path": "_files", "folder": "_files -/", "value": " "}
    return f":{option.type.split('|')[0] if not words else 'one of'}:{actions[option.takes]}" if option.takes else ""


def zsh_function(program, page):
    lines = [f"_glissade_{program}() {{", "  _arguments -S \\"]
    for option in page.options:
        for name in option.names:
            many = "\\*" if option.repeatable else ""
            equals = "=" if option.takes_value and name.startswith("--") else ""
            lines.append(f"    {many}'{name}{equals}[{zsh_text(option.text)}]{zsh_action(option)}' \\")
    for argument in page.arguments:
        action = f"({' '.join(argument.words)})" if argument.words else "_files"
        lines.append(f"    ':{argument.name}:{action}' \\")
    lines[-1] = lines[-1].removesuffix(" \\")
    return "\n".join([*lines, "}", ""])


def zsh_script(pages):
    programs = {program: page for page, _, program in pages.values() if program != "glissade"}
    lines = {title.removeprefix("glissade-"): line for title, (_, line, _) in pages.items()}
    names = [program for _, _, program in pages.values()]
    parts = [f"#compdef {' '.join(names)}\n{HEAD}"]
    parts += [zsh_function(program, page) for program, page in programs.items()]
    commands = commands_of(pages)
    entries = [f"    '{name}:{zsh_text(lines[name])}'" for name in commands]
    cases = [f"    {name}) _glissade_{program} ;;" for name, program in commands.items()]
    parts.append("\n".join([
        "_glissade_command() {", "  local -a commands=(", *entries, "    'help:say all about a command'", "  )",
        "  if ((CURRENT == 2)); then", "    _describe command commands", "    return", "  fi",
        "  if [[ $words[2] == help ]]; then", "    ((CURRENT == 3)) && _describe command commands", "    return", "  fi",
        "  local command=$words[2]", "  shift words", "  ((CURRENT--))", "  case $command in", *cases, "  esac", "}", ""]))
    parts.append('case $service in\n  glissade) _glissade_command "$@" ;;\n  *) _glissade_$service "$@" ;;\nesac\n')
    return "\n".join(parts)


def write_zsh(pages, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "_glissade").write_text(zsh_script(pages), encoding="utf-8")
