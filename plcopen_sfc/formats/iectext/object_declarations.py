"""Declarations of objects of CODESYS V3 and TwinCAT 3: structured text without the end of its unit.

`iectext` reads and writes whole units. So a declaration is put into one for it: the END that belongs to it is added,
and taken away again.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.iectext.iectext_codec import IecTextCodec
from plcopen_sfc.formats.text_patch import patch_text
from plcopen_sfc.languages.declarations.kept_texts import unwrapped
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Method, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport

_TEXT = IecTextCodec()
_DIALECT = "{plcopen_sfc project.dialect := 'codesys'} "
_KEYWORDS = frozenset({"PROGRAM", "FUNCTION_BLOCK", "FUNCTION", "INTERFACE"})
_BEGINNING = re.compile(rf"\b(?:{'|'.join(sorted(_KEYWORDS))}|(?:VAR|TYPE)\w*)\b", re.IGNORECASE)
_HOLDER = "FUNCTION_BLOCK methods\n"
_END = "\nEND_"
PROPERTY = "property"
"""Place of a property in the text that is kept of it."""


class Unit(NamedTuple):
    """Texts around a declaration that make a whole unit of it."""

    head: str = _DIALECT
    tail: str = "\n"

    def around(self, text: str) -> str:
        """Return the unit with this declaration."""
        return f"{self.head}{text}{self.tail}"

    def inside(self, whole: str) -> str | None:
        """Return the declaration in a unit; None where the unit has another form."""
        if not (whole.startswith(self.head) and whole.endswith(self.tail)):
            return None
        return whole[len(self.head) : len(whole) - len(self.tail)]


def unit_of(declaration: str) -> Unit:
    """Return the unit that a declaration of a POU, an interface, a type or of variables begins."""
    for found in _BEGINNING.finditer(declaration):
        tokens = tokenize(declaration[: found.end()], Dialect.CODESYS, _KEYWORDS).tokens
        keyword = tokens[-1].value.upper() if tokens else ""
        if keyword == found.group().upper():  # and no word of a comment
            return Unit(tail=f"{_END}{keyword}\n") if keyword in _KEYWORDS else Unit()
    return Unit()


METHOD = Unit(f"{_DIALECT}{_HOLDER}", f"{_END}METHOD{_END}FUNCTION_BLOCK\n")
"""The unit for the declaration of a method."""


def read(unit: str, file: str | None) -> ReadResult:
    """Return the project in a unit."""
    return _TEXT.read(unit.encode(), file=file)


def bare(thing: Pou | Method) -> Project:
    """Return a project that has nothing but the declaration of a POU or a method."""
    if isinstance(thing, Method):
        method = Method(
            name=thing.name, interface=_interface(thing), comment=thing.comment, extension_data=_declared(thing)
        )
        method.body = StBody()  # without one a pragma would say so
        pou = Pou(name="methods", kind=PouKind.FUNCTION_BLOCK, methods=[method])
    else:
        pou = Pou(name=thing.name, kind=thing.kind, interface=_interface(thing), comment=thing.comment)
        pou.extension_data = _declared(thing)
    pou.bodies = [StBody()]
    return Project(pous=[pou], dialect=Dialect.CODESYS)


def _interface(thing: Pou | Method) -> Interface | None:
    """Return a copy of the interface, without variables of SFC flags that the tool declares itself."""
    if thing.interface is None:
        return None
    found = thing.interface.model_copy(deep=True)
    if isinstance(thing, Pou) and found.declaration is not None:
        implicit = {name for name in thing.implicit_flags() if not re.search(rf"\b{name}\b", found.declaration)}
        for section in found.sections:
            section.variables = [each for each in section.variables if each.name not in implicit]
    return found


def _declared(thing: Pou | Method) -> ExtensionData | None:
    """Return the kept parts of the declaration: pragmas, and words such as ABSTRACT."""
    kept = [
        (unwrapped(data.content), data)
        for data in (thing.extension_data.data if thing.extension_data is not None else ())
    ]
    found = [data for text, data in kept if text is not None and text[0] != PROPERTY]
    return ExtensionData(data=found) if found else None


def declaration_of(declared: Project, source: str | None) -> str:
    """Return the declaration of what `declared` has alone: `source`, where there is one, with what differs in it."""
    method = bool(declared.pous and declared.pous[0].methods)
    if source is not None:
        unit = METHOD if method else unit_of(source)
        if _is_declared_by(read(unit.around(source), None).project, declared):
            return source
        found = unit.inside(_patched(unit.around(source), declared))
        if found is not None and "{plcopen_sfc" in found:
            found = _TEXT.as_tool_sees(found.encode()).decode()
        if found is not None and _meaning(unit.around(found)) == _meaning(_DIALECT + _written(declared)):
            return found
    text = _written(declared)
    if method:
        lines = text.splitlines()
        start = next(i for i, line in enumerate(lines) if i > 0 and line.strip())  # behind the line of the holder
        end = next(i for i, line in enumerate(lines) if line.split()[:1] == ["END_METHOD"])
        margin = len(lines[start]) - len(lines[start].lstrip())
        return "\n".join(line[margin:] for line in lines[start:end]) + "\n"
    return _OWN_END.sub("", text).rstrip() + "\n"  # of a type what its text lacks leaves empty lines at the end


_OWN_END = re.compile(r"\s*\n\s*END_(?:PROGRAM|FUNCTION_BLOCK|FUNCTION)\s*\Z")
_OWN_HEAD = re.compile(r"\{plcopen_sfc (?:format|project\.dialect)\b[^}]*\}\s*")


def _is_declared_by(known: Project, declared: Project) -> bool:
    """True if a project that was read from a declaration has nothing otherwise than `declared`."""
    pous = [bare(pou.methods[0] if new.methods else pou) for pou, new in zip(known.pous, declared.pous, strict=False)]
    if [each.pous for each in pous] != [[pou] for pou in declared.pous]:
        return False
    return (known.data_types, known.global_variables) == (declared.data_types, declared.global_variables)


def _patched(whole: str, declared: Project) -> str:
    """Return the unit `whole` with what `declared` declares otherwise."""
    before, after = (read(whole, None).project for _ in range(2))
    after.data_types, after.global_variables = declared.data_types, declared.global_variables
    for old, new in zip(after.pous, declared.pous, strict=False):
        if not new.methods:
            _declare(old, new)
        for method, edited in zip(old.methods, new.methods, strict=False):
            _declare(method, edited)
    _, source, spans = _TEXT.located(whole.encode())
    report = ConversionReport()
    blocks = [_TEXT.to_blocks(project, WriteOptions(), report) for project in (before, after)]
    return patch_text(source, spans, *blocks)


def _declare(old: Pou | Method, new: Pou | Method) -> None:
    old.name, old.interface, old.comment, old.extension_data = new.name, new.interface, new.comment, new.extension_data
    if isinstance(old, Pou) and isinstance(new, Pou):
        old.kind = new.kind


def _meaning(unit: str) -> object:
    """Return the declarations of a unit, without our pragmas in it."""
    found = read(_DIALECT + _without_own(unit), None).project
    return found.model_dump(exclude_none=True)


def _written(project: Project) -> str:
    return _without_own(_TEXT.write(project, WriteOptions(), ConversionReport()).decode())


def _without_own(text: str) -> str:
    """Return a text without pragmas of this package, which mean nothing to the tool."""
    return _OWN_HEAD.sub("", _TEXT.as_tool_sees(text.encode()).decode())
