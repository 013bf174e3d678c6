"""Attributes of declarations in CODESYS and TwinCAT (``{attribute 'no_init'}``): in the declaration or beside it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from plcopen_sfc.languages.declarations.conditional_declarations import CONDITION
from plcopen_sfc.languages.declarations.kept_texts import kept, texts_from, with_kept
from plcopen_sfc.languages.st.lexer import CommentKind, tokenize
from plcopen_sfc.languages.words import IEC_KEYWORDS
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import StructType, Variable
from plcopen_sfc.model.variables import Interface

_ATTRIBUTE = re.compile(r"\{attribute\s+'(?P<name>[^']*)'(?:\s*:=\s*'(?P<value>[^']*)')?\s*\}", re.IGNORECASE)


def attribute_pragmas(attributes: Sequence[tuple[str, str]]) -> str:
    """Return attributes, by name with their values, as the pragmas before a declaration of CODESYS, a line each."""
    values = [f" := '{value}'" if value else "" for _, value in attributes]
    return "\n".join(f"{{attribute '{name}'{text}}}" for (name, _), text in zip(attributes, values, strict=True))


def pragma_attributes(pragmas: str) -> list[tuple[str, str]] | None:
    """Return the names and values of attributes in pragmas; None where one of the lines is something else."""
    found = [_ATTRIBUTE.fullmatch(line.strip()) for line in pragmas.splitlines()]
    named = [(each["name"], each["value"] or "") for each in found if each is not None]
    return named if named and len(named) == len(found) else None


def acting_attributes(thing: Element, typed: Sequence[str] = ()) -> list[str]:
    """Return the attributes of what is declared that change what a machine does; `typed` as in `attributes_of`.

    A condition before a declaration is one, ``{IF defined (X)}``: where it is not met, nothing is declared.
    """
    lines = [line.strip() for text in attributes_of(thing, typed) for line in text.splitlines()]
    named = [each for line in lines for each in pragma_attributes(line) or ()]
    found = [f"{name} := {value}" if value else name for name, value in named if name.casefold() in _ACTING]
    return found + [line for line in lines if (condition := CONDITION.match(line)) is not None and not condition["end"]]


def attributes_of(thing: Element, typed: Sequence[str] = ()) -> Sequence[str]:
    """Return the attributes of what is declared, as pragmas: those `typed` in its declaration, or those beside it."""
    if typed:
        return typed
    texts = kept(thing.extension_data)
    return [texts.get("pragmas", texts.get("attributes", "")), *texts_from("pragma", thing.extension_data)]


_ACTING = frozenset(
    """call_after_init call_after_global_init_slot call_after_online_change_slot call_before_global_exit_slot
    call_on_type_change global_init_slot init_on_onlchange initialize_on_call instance-path is_connected no_init no-init
    noinit no_virtual_actions pack_mode parameterstringof relative_offset tccallafteroutputupdate tcinitonreset tclinkto
    tcrpcenable tcswapdword tcswapword""".split()
)
"""Attributes of CODESYS and TwinCAT that change what is initialised, called, connected, or where members are."""


def typed_attributes(declaration: str | None) -> Mapping[str, Sequence[str]]:
    """Return the attributes in the text of a declaration, by the variable before which they are, "" for the head."""
    found: dict[str, list[str]] = {}
    if "{" not in (declaration or ""):
        return found
    read = tokenize(declaration or "", Dialect.CODESYS)
    for comment in read.comments:
        if comment.kind is CommentKind.PRAGMA:
            behind = next((token for token in read.tokens if token.span[0] >= comment.span[1]), None)
            is_name = behind is not None and behind.type == "NAME" and behind.value.upper() not in IEC_KEYWORDS
            name = behind.value.casefold() if behind is not None and is_name else ""
            found.setdefault(name, []).append(comment.text)
    return found


def keep_typed_attributes(project: Project) -> None:
    """Keep the attributes in typed declarations of `project`, which a translation leaves out, beside what has them."""
    for owner, declaration, variables in _declarations(project):
        typed = typed_attributes(declaration)
        for thing in (owner, *variables) if typed else ():
            pragmas = typed.get("" if thing is owner else getattr(thing, "name", "").casefold(), ())
            texts = kept(thing.extension_data)
            if pragmas and "pragmas" not in texts:
                thing.extension_data = with_kept(thing.extension_data, texts | {"pragmas": "\n".join(pragmas)})


def _declarations(project: Project) -> Iterator[tuple[Element, str | None, Sequence[Variable]]]:
    """Yield what is declared as a whole, with the text of its declaration and the variables in that."""
    for pou in project.pous:
        named: list[tuple[Element, Interface | None]] = [(pou, pou.interface)]
        named += [(method, method.interface) for method in pou.methods]
        for thing, interface in named:
            if interface is not None:
                yield thing, interface.declaration, interface.variables()
    for section in project.global_sections():
        yield section, section.declaration, section.variables
    for declared in project.data_types:
        members = declared.type.members if isinstance(declared.type, StructType) else []
        yield declared, declared.declaration, members
