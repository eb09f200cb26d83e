# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What Doxygen has read, by header: entities with a name, a signature and a description."""

import dataclasses
import functools
import pathlib
import re
import xml.etree.ElementTree as xml

NOT_SHOWN = {"friend"}


@dataclasses.dataclass
class Entity:
    kind: str            # struct, class, concept, enum, enumvalue, function, variable, typedef, define
    name: str            # as one writes it in the library's namespace: SolveOptions::max_iterations
    signature: str
    header: str          # glissade/minimizer/options.h
    line: int
    description: list = dataclasses.field(default_factory=list)  # <para> elements
    members: list = dataclasses.field(default_factory=list)

    @property
    def anchor(self):
        return "cpp-" + re.sub(r"[^\w.]+", "-", self.name.replace("::", ".")).strip("-")


def text_of(element):
    return " ".join("".join(element.itertext()).split()) if element is not None else ""


def as_written(code):
    """Doxygen spaces types out: Result< Foo > & is Result<Foo>&."""
    code = re.sub(r"\s*<\s*", "<", code)
    code = re.sub(r"\s+>", ">", code)
    code = re.sub(r"\s+([&*]+)(?=[\s\w,)>]|$)", r"\1 ", code)
    code = re.sub(r"([&*])\s+(?=[,)>]|$)", r"\1", code)
    return re.sub(r"\boperator<", "operator <", re.sub(r"  +", " ", code)).strip()


def without_namespace(name):
    return re.sub(r"^glissade(::|$)", "", as_written(name))


def template_of(element):
    parameters = element.find("templateparamlist")
    if parameters is None:
        return ""
    shown = []
    for parameter in parameters.findall("param"):
        name, default = text_of(parameter.find("declname")), text_of(parameter.find("defval"))
        if text_of(parameter.find("type")) == "int" and not name and default == "0":
            return ""  # template <int = 0>: a function that is compiled where it is used
        shown.append(" ".join(filter(None, [text_of(parameter.find("type")), name,
                                            f"= {default}" if default else ""])))
    return f"template <{as_written(', '.join(shown))}>\n"


def description_of(element):
    return [para for part in ("briefdescription", "detaileddescription")
            for para in element.findall(f"{part}/*")]


def signature_of(member, kind, name):
    short = text_of(member.find("name"))
    kind_of_type, initializer = as_written(text_of(member.find("type"))), member.find("initializer")
    value = "".join(initializer.itertext()).strip() if initializer is not None else ""
    if kind == "function":
        arguments = as_written(text_of(member.find("argsstring")))
        arguments = re.sub(r"(?<=\w)=(?=\S)", " = ", arguments)
        before = "static " if member.get("static") == "yes" and "::" in name else ""
        return f"{template_of(member)}{before}{kind_of_type} {short}{arguments}".replace(" ()", "()").strip()
    if kind == "typedef":
        return f"{template_of(member)}using {short} = {kind_of_type}"
    if kind == "enum":
        return f"enum class {short}" if member.get("strong") == "yes" else f"enum {short}"
    if len(value) > 80:
        value = ""
    return f"{template_of(member)}{kind_of_type} {short}{text_of(member.find('argsstring'))} {value}".strip()


def member_entity(member):
    kind = member.get("kind")
    location = member.find("location")
    name = without_namespace(text_of(member.find("qualifiedname")) or text_of(member.find("name")))
    entity = Entity(kind, name, signature_of(member, kind, name), location.get("file"),
                    int(location.get("line")), description_of(member))
    for value in member.findall("enumvalue"):
        short = text_of(value.find("name"))
        entity.members.append(Entity("enumvalue", f"{name}::{short}",
                                     f"{short} {text_of(value.find('initializer'))}".strip(),
                                     entity.header, entity.line, description_of(value)))
    return entity


def is_shown(member):
    name, documented = text_of(member.find("name")), bool(description_of(member))
    if member.get("prot") not in ("public", "protected") or member.get("kind") in NOT_SHOWN:
        return False
    if name.startswith(("GLISSADE_INTERNAL", "@")) or "static_assert" in name:
        return False
    # Constructors, destructors and assignments that say nothing are what one expects.
    return documented or not (name.startswith(("~", "operator=")) or
                              member.get("kind") == "function" and not text_of(member.find("type")))


def members_of(compound):
    found = [member_entity(member) for member in compound.iter("memberdef") if is_shown(member)]
    return sorted(found, key=lambda entity: entity.line)


def compound_entity(compound, kind):
    location = compound.find("location")
    name = without_namespace(text_of(compound.find("compoundname")))
    bases = [f"{base.get('prot')} {without_namespace(text_of(base))}" for base in compound.findall("basecompoundref")
             if "internal" not in text_of(base)]
    if kind == "concept":
        # As it stands in the header, its lines indented anew.
        signature = "".join(compound.find("initializer").itertext()).replace("glissade::", "").strip()
        first, _, rest = signature.partition("concept ")
        rest = re.sub(r"\s*\n\s*", "\n    ", re.sub(r" +", " ", rest))
        signature = f"{as_written(first).replace('template<', 'template <')}\nconcept {rest}"
    else:
        signature = f"{template_of(compound)}{kind} {name.rpartition('::')[2] if '<' not in name else name}"
        signature += f" : {', '.join(bases)}" if bases else ""
    return Entity(kind, name, signature, location.get("file"), int(location.get("line")),
                  description_of(compound), [] if kind == "concept" else members_of(compound))


@functools.cache
def headers(folder):
    """{header: entities in their order}; nested types stand among the members of their class."""
    compounds, free = [], []
    for path in sorted(pathlib.Path(folder).glob("*.xml")):
        if path.name in ("index.xml", "Doxyfile.xml"):
            continue
        compound = xml.parse(path).getroot().find("compounddef")
        kind = compound.get("kind")
        if "internal" in text_of(compound.find("compoundname")) or compound.get("prot") == "private":
            continue
        if kind in ("struct", "class", "concept"):
            compounds.append(compound_entity(compound, kind))
        elif kind == "namespace" and text_of(compound.find("compoundname")).startswith("glissade"):
            free += members_of(compound)
    owners = {entity.name: entity for entity in compounds}
    top = []
    for entity in compounds:
        owner = owners.get(entity.name.rpartition("::")[0])
        if owner is not None and "<" not in entity.name:
            owner.members.append(entity)
            owner.members.sort(key=lambda member: member.line)
        elif "<" not in entity.name or entity.description:
            top.append(entity)
    by_header = {}
    for entity in sorted(top + free, key=lambda e: (e.header, e.line)):
        by_header.setdefault(entity.header, []).append(entity)
    return by_header


@functools.cache
def file_descriptions(folder):
    """{header: what it says of itself by \\file}."""
    compounds = [xml.parse(path).getroot().find("compounddef") for path in pathlib.Path(folder).glob("*_8h.xml")]
    return {compound.find("location").get("file"): description_of(compound) for compound in compounds}
