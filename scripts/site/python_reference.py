# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""{python-module} NAME: classes and functions of the Python package, from its stubs (.pyi) and sources (.py),
read and never imported: the site is built where the package is not."""

import ast
import dataclasses
import functools
import inspect
import pathlib
import re

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx import addnodes

import cpp_reference


@dataclasses.dataclass
class Entity:
    kind: str
    name: str            # Problem.add_poses, plot.schur
    signature: str
    description: str
    members: list

    @property
    def anchor(self):
        return "py-" + self.name


def is_public(name):
    return not name.startswith("_") or name in ("__init__", "__getitem__", "__len__", "__call__")


def without_modules(code):
    return re.sub(r"\b(?:numpy|np|typing|collections\.abc|glissade|_core)\.(?=\w)", "", code)


def entities_of(body, prefix=""):
    """Public names of a module or class; overloads stand under one name."""
    found = {}
    for k, node in enumerate(body):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            if not is_public(node.name):
                continue
            name = prefix + node.name
            description = inspect.cleandoc(ast.get_docstring(node) or "")
            if isinstance(node, ast.ClassDef):
                bases = f"({', '.join(map(ast.unparse, node.bases))})" if node.bases else ""
                entity = Entity("class", name, f"class {node.name}{bases}", description,
                                list(entities_of(node.body, name + ".").values()))
            else:
                if node.name == "__init__" and not description and len(node.args.args) == 1 and not node.args.vararg:
                    continue
                decorators = {ast.unparse(d) for d in node.decorator_list}
                if any(d.endswith(".setter") for d in decorators):
                    continue
                returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
                if "property" in decorators:
                    signature = f"{node.name}: {ast.unparse(node.returns)}" if node.returns else node.name
                else:
                    arguments = ast.unparse(node.args)
                    arguments = re.sub(r"^(self|cls)(, /)?(, )?", "", arguments) if prefix else arguments
                    signature = f"{node.name}({arguments}){returns}"
                entity = Entity("function", name, without_modules(signature), description, [])
            if name in found:
                found[name].signature += "\n" + entity.signature
                found[name].description = found[name].description or entity.description
            else:
                found[name] = entity
        elif prefix and isinstance(node, (ast.Assign, ast.AnnAssign)):  # values of an enum, attributes
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            if not isinstance(target, ast.Name) or not is_public(target.id):
                continue
            kind = f": {ast.unparse(node.annotation)}" if isinstance(node, ast.AnnAssign) else ""
            name = prefix + target.id
            found[name] = Entity("attribute", name, without_modules(target.id + kind), text_after(body, k), [])
    return found


def text_after(body, k):
    """The string that stands after an attribute and describes it."""
    value = getattr(body[k + 1], "value", None) if k + 1 < len(body) else None
    return inspect.cleandoc(value.value) if isinstance(value, ast.Constant) and isinstance(value.value, str) else ""


def imported_names(tree):
    """{module: names} that a package takes from modules of its own, as in `from ._errors import Error`."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.level == 1 and node.module:
            found.setdefault(node.module, set()).update(alias.name for alias in node.names)
    return found


FIRST = ["Problem", "VertexArray", "EdgeArray", "EdgeKind", "SolveOptions", "SolveSummary", "Error", "SlidingWindow",
         "SlidingWindowOptions"]


def read_package(folder, package, found):
    """Adds {module: (description, {name: entity})} of a package and of those in it; "" is the outermost."""
    imported = imported_names(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
    for path in sorted([*folder.glob("*.pyi"), *folder.glob("*.py")], key=lambda p: (p.suffix == ".py", p.name)):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        private = path.stem.startswith("_")
        wanted = imported.get(path.stem, set()) if path.stem != "__init__" else {"*"}
        if private and not wanted:
            continue
        module = package if private else ".".join(filter(None, (package, path.stem)))
        text, entities = found.get(module, ("", {}))
        prefix = module + "." if module else ""
        for name, entity in entities_of(tree.body, prefix).items():
            if not private or "*" in wanted or name.removeprefix(prefix) in wanted:
                known = entities.setdefault(name, entity)
                known.description = known.description or entity.description
        is_its_own = not private or path.stem == "__init__"
        own = inspect.cleandoc(ast.get_docstring(tree) or "") if is_its_own else ""
        found[module] = (own or text, entities)
    for path in sorted(folder.glob("*/__init__.py")):
        read_package(path.parent, ".".join(filter(None, (package, path.parent.name))), found)


@functools.cache
def modules(package):
    """{module, "" for the package itself: (description, entities)}. A module whose name begins with "_" is the
    package's, as far as that imports its names; a stub is taken before the source."""
    folder, found = pathlib.Path(package), {}
    if package and (folder / "__init__.py").is_file():
        read_package(folder, "", found)
    return {module: (text, sorted(entities.values(), key=lambda e: FIRST.index(e.name) if e.name in FIRST else len(FIRST)))
            for module, (text, entities) in found.items() if entities}


def names(package):
    """{name: (page, anchor)}."""
    def walk(entities):
        for entity in entities:
            yield entity
            yield from walk(entity.members)
    return {entity.name: (page_of(module), entity.anchor)
            for module, (_, entities) in modules(package).items() for entity in walk(entities)}


def page_of(module):
    return f"reference/python/{module or 'glissade'}"


def paragraphs(text):
    """Blocks of a docstring: indented ones are code, lines that begin with - or * a list."""
    blocks = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        if blocks and block.startswith("    ") and blocks[-1].startswith("    "):
            blocks[-1] += "\n\n" + block  # code with an empty line in it
        else:
            blocks.append(block)
    for block in blocks:
        lines = block.split("\n")
        if all(line.startswith(("    ", ">>>")) or not line.strip() for line in lines):
            code = inspect.cleandoc(block)
            yield nodes.literal_block(code, code, language="python")
        elif re.match(r"\s*[-*] ", lines[0]):
            items = nodes.bullet_list()
            for item in re.split(r"\n(?=\s*[-*] )", block):
                items += nodes.list_item("", nodes.paragraph("", "", *words(re.sub(r"^\s*[-*] ", "", item))))
            yield items
        elif len(lines) > 1 and all(line.startswith("  ") for line in lines[1:]):
            yield nodes.paragraph("", "", *words(lines[0]))
            rest = inspect.cleandoc("\n" + "\n".join(lines[1:]))
            yield nodes.literal_block(rest, rest, language="none")
        else:
            yield nodes.paragraph("", "", *words(block))


def words(text):
    for k, part in enumerate(re.split(r"``?([^`]+)``?", text)):
        if k % 2:
            yield nodes.literal(part, part)
        else:
            yield from cpp_reference.text_nodes(part)


def described(entity, depth=0):
    description = addnodes.desc(domain="py", objtype=entity.kind, noindex=True, classes=["py", entity.kind])
    short = entity.name.rpartition(".")[2]
    for k, line in enumerate(entity.signature.split("\n")):
        signature = addnodes.desc_signature(line, "", ids=[entity.anchor] if k == 0 else [])
        if k == 0 and depth == 0:
            signature["_toc_name"], signature["_toc_parts"] = short, ()  # in the page's table of contents
        before, name, after = cpp_reference.partition_at_word(line, short)
        signature += [addnodes.desc_addname("", before), addnodes.desc_name("", name), addnodes.desc_addname("", after)]
        description += signature
    description += addnodes.desc_content("", *paragraphs(entity.description) if entity.description else (),
                                         *(described(member, depth + 1) for member in entity.members))
    return description


class PythonModule(Directive):
    optional_arguments = 1

    def run(self):
        package = self.state.document.settings.env.app.config.python_package
        name = self.arguments[0] if self.arguments else ""
        text, entities = modules(package)[name if name != "glissade" else ""]
        return [*(paragraphs(text) if text else ()), *map(described, entities)]


def setup(app):
    app.add_config_value("python_package", "", "env", str)
    app.add_directive("python-module", PythonModule)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
