# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""{cpp-module} NAME: what the public headers of a module declare and say, from Doxygen's XML."""

import re

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx import addnodes

import doxygen_xml

# What is code in a comment: Foo::Bar, kName, call(), snake_case, CamelCase, module/header.h.
CODE = re.compile(r"(?<![\w.])((?:[A-Za-z_]\w*::)+~?[A-Za-z_]\w*(?:\(\))?|k[A-Z]\w+|[A-Za-z_]\w*\(\)|[a-z]+/[a-z_/]+\.h|"
                  r"(?:[a-z]\w*\.)?[A-Za-z]\w*_\w+|(?:[A-Z][a-z0-9]+){2,}[A-Z]*)(?!\w)")


def text_nodes(text):
    text = re.sub(r"\s+", " ", text)
    for k, part in enumerate(CODE.split(text)):
        if part:
            yield nodes.literal(part, part) if k % 2 else nodes.Text(part)


def unescaped(code):
    """Without what Doxyfile's filter put before "<"."""
    return re.sub(r"\\([<>&])", r"\1", code)


def inline(element):
    """Children of a <para>, as inline and block nodes."""
    yield from text_nodes(element.text or "")
    for child in element:
        if child.tag == "computeroutput":
            yield nodes.literal("", unescaped("".join(child.itertext())))
        elif child.tag in ("emphasis", "bold"):
            yield (nodes.emphasis if child.tag == "emphasis" else nodes.strong)("", "".join(child.itertext()))
        elif child.tag == "ref":
            yield from text_nodes("".join(child.itertext()))
        elif child.tag == "ulink":
            yield nodes.reference("", "".join(child.itertext()), refuri=child.get("url"))
        elif child.tag in ("mdash", "ndash", "nonbreakablespace", "zwj"):
            yield nodes.Text({"mdash": "---", "ndash": "--", "zwj": ""}.get(child.tag, " "))
        elif child.tag in ("verbatim", "preformatted"):
            code = unescaped("".join(child.itertext())).strip("\n")
            yield nodes.literal_block(code, code, language="cpp" if re.search(r"[;{}]", code) else "none")
        elif child.tag in ("itemizedlist", "orderedlist"):
            items = nodes.bullet_list() if child.tag == "itemizedlist" else nodes.enumerated_list()
            for item in child.findall("listitem"):
                items += nodes.list_item("", *blocks(item))
            yield items
        elif child.tag in ("simplesect", "parameterlist", "parblock", "blockquote"):
            yield from (node for para in child.iter("para") for node in inline(para))
        else:
            raise ValueError(f"no idea how to show <{child.tag}> of Doxygen")
        yield from text_nodes(child.tail or "")


def blocks(elements):
    """Paragraphs of a description, code blocks and lists between them."""
    for element in elements:
        paragraph = nodes.paragraph()
        for node in inline(element):
            if isinstance(node, (nodes.literal_block, nodes.bullet_list, nodes.enumerated_list)):
                if paragraph.astext().strip():
                    yield paragraph
                yield node
                paragraph = nodes.paragraph()
            else:
                paragraph += node
        if paragraph.astext().strip():
            yield paragraph


def described(entity, depth=0):
    """An entity with its description and its members."""
    description = addnodes.desc(domain="cpp", objtype=entity.kind, noindex=True, classes=["cpp", entity.kind])
    short = entity.name.rpartition("::")[2]
    lines = entity.signature.split("\n")
    signature = addnodes.desc_signature(entity.signature, "", ids=[entity.anchor], is_multiline=len(lines) > 1)
    if depth == 0 and entity.kind in ("class", "struct", "concept"):
        signature["_toc_name"], signature["_toc_parts"] = short, ()  # in the page's table of contents
    for k, line in enumerate(lines):
        target = signature
        if len(lines) > 1:
            target = addnodes.desc_signature_line("", "", add_permalink=k == 0)
            signature += target
        before, name, after = line.rpartition(short) if entity.kind == "typedef" and " = " not in line else \
            partition_at_word(line, short)
        if name:
            target += [addnodes.desc_addname("", before), addnodes.desc_name("", name), addnodes.desc_addname("", after)]
        else:
            target += addnodes.desc_addname("", line)
    content = addnodes.desc_content("", *blocks(entity.description))
    content += [described(member, depth + 1) for member in entity.members]
    description += [signature, content]
    return description


def partition_at_word(line, word):
    found = re.search(rf"(?<![\w~]){re.escape(word)}(?!\w)", line)
    return (line[:found.start()], word, line[found.end():]) if found else (line, "", "")


def header_anchor(header):
    return "header-" + re.sub(r"\W+", "-", header)


class CppModule(Directive):
    required_arguments = 1

    def run(self):
        config = self.state.document.settings.env.app.config
        module, sections = self.arguments[0], []
        for header, entities in doxygen_xml.headers(config.doxygen_xml).items():
            if header.split("/")[1].removesuffix(".h") != module:
                continue
            section = nodes.section(ids=[header_anchor(header)])
            include = f"#include <{header}>"
            section += [nodes.title("", header.removeprefix("glissade/")),
                        nodes.literal_block(include, include, language="cpp"),
                        *blocks(doxygen_xml.file_descriptions(config.doxygen_xml).get(header, [])),
                        *(described(entity) for entity in entities)]
            sections.append(section)
        if not sections:
            raise self.error(f"no header of {module} in {config.doxygen_xml}")
        return sections


def setup(app):
    app.add_config_value("doxygen_xml", "", "env", str)
    app.add_directive("cpp-module", CppModule)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
