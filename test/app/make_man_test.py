#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/make_man.py: manual pages, Markdown and completions say what the programs say."""

import re
import shutil
import subprocess
import sys

from app_test_util import ROOT, AppTest, main

sys.path.insert(0, str(ROOT / "scripts"))
import help_text  # noqa: E402
import make_man  # noqa: E402

HELP = """Does things. And more - of
it.
Usage: thing [OPTIONS] FILE [KIND]

Positionals:
  FILE                        What is read
  KIND one|two                What is made

Options:
  -h,--help                   Print this and exit
  --count N                   How many, not
                              how often (default 3)
  --which fast|slow:W|some-thing
                              Of them
  --many FILE ...             May be repeated

A note in
two lines:
  laid   out
.dots begin this line
and \\backslashes too

Examples:
  thing a.txt --count 2       two of them

Exit code: 0; 2 where it
makes no sense.
"""


class MakeManTest(AppTest):
    def make(self, *args):
        done = subprocess.run([sys.executable, ROOT / "scripts" / "make_man.py", *map(str, args), self.folder_of_executables],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def pages(self):
        return help_text.read_all(self.folder_of_executables)

    # ---- What is read ------------------------------------------------------------------------------

    def test_reads_the_form_of_help(self):
        page = help_text.parse(HELP)
        self.assertEqual((page.name, page.usage), ("thing", "[OPTIONS] FILE [KIND]"))
        self.assertEqual(page.description, "Does things. And more - of it.")
        self.assertEqual([(a.name, a.words) for a in page.arguments], [("FILE", []), ("KIND", ["one", "two"])])
        self.assertEqual([o.name for o in page.options], ["--help", "--count", "--which", "--many"])
        count, which, many = page.options[1:]
        self.assertEqual((count.type, count.text, count.takes), ("N", "How many, not how often (default 3)", "value"))
        self.assertEqual((which.words, which.text, which.takes), (["fast", "slow:", "some-thing"], "Of them", "words"))
        self.assertEqual((many.type, many.repeatable, many.takes), ("FILE", True, "file"))
        self.assertFalse(page.options[0].takes_value)
        self.assertEqual(page.options[0].names, ["-h", "--help"])
        self.assertEqual(len(page.notes), 1)
        self.assertEqual(page.examples, ["thing a.txt --count 2       two of them"])
        self.assertEqual(page.exit_code, "0; 2 where it makes no sense.")

    # ---- Manual pages ------------------------------------------------------------------------------

    def test_manual_pages(self):
        self.make("--man", "man1")
        pages = self.pages()
        for title, (page, _, program) in pages.items():
            text = (self.folder / "man1" / f"{title}.1").read_text(encoding="utf-8")
            for section in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT STATUS", "SEE ALSO"):
                self.assertIn(f"\n.SH {section}\n", text, title)
            if program != title:
                self.assertEqual((self.folder / "man1" / f"{program}.1").read_text(encoding="utf-8"),
                                 f".so man1/{title}.1\n")
            self.assertGreater(text.count("\n.TP\n"), 1)
            self.assertEqual(text.count("\n.TP\n"), len(page.options) + (len(page.arguments) if title != "glissade" else 0))
            self.check_renders(title, page)

    def check_renders(self, title, page):
        """As man shows it: nothing is lost and groff has nothing to say."""
        if shutil.which("groff") is None:
            return
        done = subprocess.run(["groff", "-man", "-Tascii", "-ww", "-rLL=100n", self.folder / "man1" / f"{title}.1"],
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "", title)
        shown = re.sub(r"\x1b\[[0-9;]*m|.\x08", "", done.stdout)
        words = re.sub(r"-\s*\n\s*", "-", shown)  # broken at a hyphen
        words = " ".join(words.split())
        for option in page.options:
            self.assertIn(option.name, words)
            self.assertIn(" ".join(option.text.split())[:40].rsplit(" ", 1)[0], words)
        for example in page.examples:
            self.assertIn(" ".join(example.split()), words)

    def test_what_roff_would_take_for_its_own(self):
        text = make_man.manual_page("thing", help_text.parse(HELP), "does things", "1.2.3", ["other", "thing"])
        self.assertIn(".dots begin this line and \\ebackslashes too", text)
        self.assertNotRegex(text, r"(?m)^\.dots")
        self.assertIn("A note in two lines:\n.nf\n  laid   out\n.fi\n", text)
        self.assertIn("\\fB\\-\\-which\\fR fast|slow:W|some\\-thing", text)
        self.assertIn("\\fBother\\fR(1)", text)

    # ---- Markdown ----------------------------------------------------------------------------------

    def test_markdown(self):
        self.make("--markdown", "out")
        index = (self.folder / "out" / "index.md").read_text(encoding="utf-8")
        for title, (page, _, _) in self.pages().items():
            self.assertIn(f"]({title}.md): ", index)
            text = (self.folder / "out" / f"{title}.md").read_text(encoding="utf-8")
            self.assertTrue(text.startswith(f"# {page.name}\n"))
            self.assertEqual(text.count("```") % 2, 0)
            for option in page.options:
                self.assertIn(f"- `{option.shown}`: ", text)
            for example in page.examples:
                self.assertIn(f"\n{example}\n", text)

    # ---- bash --------------------------------------------------------------------------------------

    def complete(self, *words):
        """What bash offers for the last of the words."""
        script = ". bash/glissade; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); "
        script += "_glissade \"$1\"; printf '%s\\n' \"${COMPREPLY[@]}\""
        done = subprocess.run(["bash", "--norc", "-c", script, "bash", *words], cwd=self.folder, capture_output=True,
                              text=True, check=True)
        return sorted(filter(None, done.stdout.splitlines()))

    def test_bash(self):
        self.make("--bash", "bash")
        pages = self.pages()
        commands = sorted(title.removeprefix("glissade-") for title in pages if title.startswith("glissade-"))
        self.assertEqual([w for w in self.complete("glissade", "") if not w.startswith("-")], sorted([*commands, "help"]))
        self.assertEqual(self.complete("glissade", "so"), ["solve"])
        self.assertEqual(self.complete("/usr/bin/glissade", "help", "rep"), [c for c in commands if c.startswith("rep")])
        for title, (page, _, program) in pages.items():
            name = title.removeprefix("glissade-")
            start = ["glissade", name] if title != name else [program]
            if title == "glissade":
                continue
            with self.subTest(title=title):
                options = sorted(n for o in page.options for n in o.names if n.startswith("--"))
                self.assertEqual(self.complete(*start, "--"), options)
                self.assertEqual(self.complete(program, "--"), options)
                for option in page.options:
                    if option.words:
                        self.assertEqual(self.complete(*start, option.name, ""), sorted(option.words))
                        self.assertEqual(self.complete(*start, option.name, "=", ""), sorted(option.words))
                        first = option.words[0]
                        self.assertIn(first, self.complete(*start, option.name, "=", first[:2]))
                        self.assertEqual(self.complete(*start, option.name, "="), sorted(option.words))
        self.write("some file.txt", "")
        (self.folder / "some folder").mkdir()
        self.assertEqual(self.complete("glissade", "solve", "some"), ["some file.txt", "some folder"])
        self.assertEqual(self.complete("ba_solve", "--json", "some"), ["some file.txt", "some folder"])
        self.assertEqual(self.complete("ba_solve", "--threads", ""), [])
        self.assertIn("windows", self.complete("make_data", "w"))
        # Every program has a file by its name, which says the same.
        for _, _, program in pages.values():
            done = subprocess.run(["bash", "--norc", "-c", f". bash/{program}; complete -p {program}"], cwd=self.folder,
                                  capture_output=True, text=True, check=True)
            self.assertEqual(done.stdout, f"complete -F _glissade {program}\n")

    # ---- zsh ---------------------------------------------------------------------------------------

    def test_zsh(self):
        self.make("--zsh", "zsh")
        script = self.folder / "zsh" / "_glissade"
        text = script.read_text(encoding="utf-8")
        pages = self.pages()
        self.assertEqual(text.splitlines()[0].split(), ["#compdef", *(program for _, _, program in pages.values())])
        for _, (page, _, program) in pages.items():
            if program == "glissade":
                continue
            function = text.partition(f"\n_glissade_{program}() {{")[2].partition("\n}")[0]
            for option in page.options:
                self.assertIn(f"'{option.name}{'=' if option.takes_value else ''}[", function)
        if shutil.which("zsh") is None:
            self.skipTest("no zsh to read it")
        subprocess.run(["zsh", "-n", script], check=True)
        # The real thing: a zsh on a terminal of its own is asked for what it offers.
        offered = self.ask_zsh("glissade so\t")
        self.assertIn("glissade solve", offered)
        self.assertIn("ba_solve --linear-solver", self.ask_zsh("ba_solve --linear-s\t"))
        self.assertIn("--linear-solver=implicit-pcg", self.ask_zsh("glissade solve --linear-solver=im\t"))

    def ask_zsh(self, typed):
        program = r"""
zmodload zsh/zpty
zpty z zsh -f -i
zpty -w z "PS1=; fpath=($PWD/zsh \$fpath); autoload -U compinit; compinit -u -D; print ready"
zpty -r z line '*ready*ready*'
zpty -n -w z "$1"
sleep 1
zpty -n -w z $'\C-a\C-k print -r -- end\n'
zpty -r z line '*end*'
print -r -- "$line"
zpty -d z
"""
        done = subprocess.run(["zsh", "-f", "-c", program, "zsh", typed], cwd=self.folder, capture_output=True, text=True,
                              check=True, timeout=60)
        return done.stdout

    def test_refuses_a_folder_without_programs(self):
        done = subprocess.run([sys.executable, ROOT / "scripts" / "make_man.py", "--man", "m", self.folder], cwd=self.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no program of glissade is in this folder", done.stderr)
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    main(MakeManTest)
