"""Every piece of structured text in the corpus, with the kind of text it is, its dialect and where it is."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

from lxml import etree
from pydantic import BaseModel

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import CORPUS, corpus_files
from tests.languages.st_simaticml import scl_text


class TextKind(StrEnum):
    """The role of a text."""

    STATEMENTS = "statements"
    EXPRESSION = "expression"
    CONDITION = "condition"
    DECLARATIONS = "declarations"


@dataclass(frozen=True)
class CorpusText:
    """A text of the corpus. `file` is relative to the corpus; `place` says where in the file."""

    kind: TextKind
    dialect: Dialect
    text: str
    file: str
    place: str

    def __str__(self) -> str:
        return f"{self.file}, {self.place}"


Found = tuple[TextKind, str, str]
"""A kind, a text and its place."""


@cache
def corpus_texts() -> tuple[CorpusText, ...]:
    """All texts, in the order of the files; equal texts occur as often as in the corpus."""
    return tuple(_all_texts())


def distinct(texts: Iterable[CorpusText]) -> list[CorpusText]:
    """The first of each group of texts that say the same in the same dialect."""
    first: dict[tuple[TextKind, Dialect, str], CorpusText] = {}
    for each in texts:
        first.setdefault((each.kind, each.dialect, each.text), each)
    return list(first.values())


def _all_texts() -> Iterator[CorpusText]:
    sources: list[tuple[str, str, Dialect, Callable[[Path], Iterable[Found]]]] = [
        ("plcopen", ".xml", Dialect.IEC, _of_project),
        ("codesys", ".xml", Dialect.CODESYS, _of_project),
        ("grafcet", ".xml", Dialect.IEC, _of_project),
        ("iectext", ".xml", Dialect.IEC, _of_project),
        ("twincat", ".tcpou", Dialect.TWINCAT, _of_twincat),
        ("codesys23", ".exp", Dialect.CODESYS, _of_export),
        ("iectext", ".sfc", Dialect.IEC, _of_iec_text),
        ("iectext", ".txt", Dialect.IEC, _of_iec_text),
        ("iectext", ".test", Dialect.IEC, _of_iec_text),
        ("simaticml", ".xml", Dialect.SCL, _of_simaticml),
        ("simaticml", ".scl", Dialect.SCL, _of_scl_source),
        ("simaticml", ".s7dcl", Dialect.SCL, _of_simatic_sd),
        ("l5x", ".l5x", Dialect.IEC, _of_l5x),
        ("schneider", ".xml", Dialect.IEC, _of_schneider),
    ]
    for folder, suffix, dialect, texts in sources:
        for path in corpus_files(folder):
            if path.suffix.lower() == suffix:
                file = path.relative_to(CORPUS).as_posix()
                yield from (CorpusText(kind, dialect, text, file, place) for kind, text, place in texts(path))


# -- PLCopen XML, of which CODESYS and TwinCAT have theirs ------------------------------------------------------------

_FIELDS: dict[type[BaseModel], dict[str, TextKind]] = {
    m.StBody: {"text": TextKind.STATEMENTS},
    m.Expression: {"text": TextKind.CONDITION},
    m.Block: {"code": TextKind.STATEMENTS, "instance": TextKind.EXPRESSION},
    m.ActionAssociation: dict.fromkeys(("target", "value", "duration", "indicator"), TextKind.EXPRESSION),
    m.Step: dict.fromkeys(
        ("entry_action", "main_action", "exit_action", "min_time", "max_time", "warning_time"), TextKind.EXPRESSION
    ),
    m.SimpleValue: {"text": TextKind.EXPRESSION},
    m.EnumValue: {"value": TextKind.EXPRESSION},
    m.Dimension: {"lower": TextKind.EXPRESSION, "upper": TextKind.EXPRESSION},
    m.StringType: {"length": TextKind.EXPRESSION},
    m.Task: {"interval": TextKind.EXPRESSION, "single": TextKind.EXPRESSION},
    m.Interface: {"declaration": TextKind.DECLARATIONS},
    m.VariableSection: {"declaration": TextKind.DECLARATIONS},
    m.DataTypeDeclaration: {"declaration": TextKind.DECLARATIONS},
    m.InputVariable: {"expression": TextKind.EXPRESSION},
    m.OutputVariable: {"expression": TextKind.EXPRESSION},
    m.InOutVariable: {"expression": TextKind.EXPRESSION},
    m.InputPin: {"expression": TextKind.EXPRESSION},
    m.OutputPin: {"expression": TextKind.EXPRESSION},
    m.Contact: {"variable": TextKind.EXPRESSION},
    m.Coil: {"variable": TextKind.EXPRESSION},
}


def _of_project(path: Path) -> Iterator[Found]:
    try:
        project = sfc.load(path)
    except SfcError:
        return  # no project: XML of another kind, or not well-formed
    project.read_all()
    yield from _of_model(project, "")


def _is_condition(text: str, owner: str) -> bool:
    """True if a body is the condition of a transition, which may also be an assignment to the transition."""
    last = owner.rpartition("/")[2]
    return last.startswith(("BodyCondition", "NamedTransition")) and ":=" not in text.strip().removeprefix(":=")


def _of_model(item: Any, place: str) -> Iterator[Found]:
    if isinstance(item, BaseModel):
        name = getattr(item, "name", None) or getattr(item, "id", None)
        here = f"{place}/{type(item).__name__}" + (f" {name}" if name is not None else "")
        for field, kind in _FIELDS.get(type(item), {}).items():
            text = getattr(item, field)
            if isinstance(text, str) and text:
                condition = isinstance(item, m.StBody) and _is_condition(text, place)
                yield TextKind.CONDITION if condition else kind, text, f"{here}.{field}"
        for field in type(item).model_fields:
            yield from _of_model(getattr(item, field), here)
    elif isinstance(item, list | tuple):
        for number, member in enumerate(item):
            yield from _of_model(member, f"{place}[{number}]")
    elif isinstance(item, dict):
        for key, member in item.items():
            yield from _of_model(member, f"{place}[{key}]")


# -- TwinCAT ----------------------------------------------------------------------------------------------------------

_NAME = "{38391c6d-6d4a-42f8-8ee7-9f45e5adafa8}"
_STEP_ACTIONS = {
    "{700a583f-b4d4-43e4-8c14-629c7cd3bec8}",
    "{a6b08bd8-b696-47e3-9cbf-7408b61c9ff8}",
    "{a2621e18-7de3-4ea6-ae6d-89e9e0b7befd}",
}


def _of_twincat(path: Path) -> Iterator[Found]:
    root = _tree(path)
    for element in root.iter("Declaration", "ST"):
        owner = element.getparent() if element.tag == "Declaration" else element.getparent().getparent()
        if not (element.text or "").strip():
            continue
        place = f"line {element.sourceline}, {owner.tag} {owner.get('Name', '')}"
        if element.tag == "Declaration":
            yield TextKind.DECLARATIONS, element.text, place
        else:
            is_condition = owner.tag == "Transition" and ":=" not in element.text
            yield TextKind.CONDITION if is_condition else TextKind.STATEMENTS, element.text, place
    for attribute in root.iterfind(".//l2[@n='Attributes']/o"):
        what = attribute.getparent().getparent()
        kind = what.get("t") or what.getparent().get("cet") or ""
        identifier = attribute.findtext("v[@n='AttributeId']", "").strip()
        value = (attribute.findtext("o[@n='Value']/v[@n='Value']") or "").strip('"')
        named = identifier == _NAME and kind in {"SFCTransition", "SFCActionAssociation"}
        if value and (named or identifier in _STEP_ACTIONS):
            is_condition = kind == "SFCTransition"
            yield (
                TextKind.CONDITION if is_condition else TextKind.EXPRESSION,
                value,
                f"line {attribute.sourceline}, {kind}",
            )
    for operand in root.iter("v"):
        if operand.get("n") == "Operand" and (text := (operand.text or "").strip('"')):
            yield TextKind.EXPRESSION, text, f"line {operand.sourceline}, operand"


# -- text files -------------------------------------------------------------------------------------------------------


def _read(path: Path, encoding: str = "utf-8-sig") -> str:
    return path.read_bytes().decode(encoding)


def _matches(pattern: str, text: str, kind: TextKind, what: str) -> Iterator[Found]:
    for found in re.finditer(pattern, text, re.IGNORECASE | re.DOTALL | re.MULTILINE):
        if body := found.group(1).strip():
            yield kind, body, f"line {text.count(chr(10), 0, found.start(1)) + 1}, {what}"


_CONDITION = r"^\s*TRANSITION\b[^:]*?(?:\(\s*PRIORITY\s*:=[^)]*\)[^:]*?)?:=(.*?);?\s*END_TRANSITION\b"
_ACTION = r"^\s*ACTION\s+\w+\s*:?(.*?)\bEND_ACTION\b"


def _of_export(path: Path) -> Iterator[Found]:
    """CoDeSys V2.3. Bodies of CFC hold expressions in their elements."""
    text = _read(path, "cp1251")
    marker = re.search(r"\(\* @END_DECLARATION := '0' \*\)", text)
    assert marker is not None
    yield TextKind.DECLARATIONS, text[: marker.start()], "declaration"
    if "_CFC_BODY" in text:
        # a comment is an element of its own type, and its text is no expression
        pattern = r"^_TYPE: _(?:INPUT|OUTPUT)\s*^_TEXT: ([^\r\n]*)"
        yield from _matches(pattern, text, TextKind.EXPRESSION, "element of CFC")
    elif re.search(r"^INITIAL_STEP\b", text, re.MULTILINE):
        yield from _matches(r"^(?:INITIAL_)?STEP \w+:(.*?)^END_STEP", text, TextKind.STATEMENTS, "step")
        yield from _matches(_CONDITION, text, TextKind.CONDITION, "transition")
    else:
        body = re.compile(r"(.*?)^END_(?:PROGRAM|FUNCTION_BLOCK|FUNCTION)\b", re.DOTALL | re.MULTILINE)
        found = body.match(text, marker.end())
        assert found is not None
        yield TextKind.STATEMENTS, found.group(1), "body"
    yield from _matches(_ACTION, text, TextKind.STATEMENTS, "action")


def _of_iec_text(path: Path) -> Iterator[Found]:
    text = _read(path)
    yield from _matches(_ACTION, text, TextKind.STATEMENTS, "action")
    yield from _matches(_CONDITION, text, TextKind.CONDITION, "transition")
    yield from _matches(r"\b(VAR(?:_\w+)?\b.*?\bEND_VAR\b)", text, TextKind.DECLARATIONS, "variables")


def _of_scl_source(path: Path) -> Iterator[Found]:
    text = _read(path)
    blocks = r"^(?:FUNCTION_BLOCK|FUNCTION|ORGANIZATION_BLOCK)\b"
    yield from _matches(rf"({blocks}.*?)^BEGIN\b", text, TextKind.DECLARATIONS, "head of a block")
    end = r"^END_(?:FUNCTION_BLOCK|FUNCTION|ORGANIZATION_BLOCK)\b"
    yield from _matches(rf"^BEGIN\b(.*?){end}", text, TextKind.STATEMENTS, "block")


def _of_simatic_sd(path: Path) -> Iterator[Found]:
    network = r"""S7_Language := "SCL"[^}]*\}\s*NETWORK\b(.*?)^\s*END_NETWORK\b"""
    yield from _matches(network, _read(path), TextKind.STATEMENTS, "network")


# -- other XML --------------------------------------------------------------------------------------------------------


def _tree(path: Path) -> Any:
    try:
        return etree.parse(path).getroot()
    except etree.XMLSyntaxError:
        return etree.Element("nothing")  # a template with placeholders, a download that failed


def _of_simaticml(path: Path) -> Iterator[Found]:
    root = _tree(path)
    for element in root.iter("{*}StructuredText"):
        if text := scl_text(element):
            yield TextKind.STATEMENTS, text, f"line {element.sourceline}, network"
    for element in root.iter("{*}StartValue"):
        if element.text:
            yield TextKind.EXPRESSION, element.text, f"line {element.sourceline}, start value"


def _of_l5x(path: Path) -> Iterator[Found]:
    for content in _tree(path).iter("STContent"):
        lines = [(line.text or "").strip("\r\n") for line in content.iterchildren("Line")]
        if text := "\n".join(lines):
            owner = content.getparent().tag
            kind = TextKind.CONDITION if owner == "Condition" else TextKind.STATEMENTS
            yield kind, text, f"line {content.sourceline}, {owner}"


def _of_schneider(path: Path) -> Iterator[Found]:
    root = _tree(path)
    for element in root.iter("STSource"):
        if element.text:
            yield TextKind.STATEMENTS, element.text, f"line {element.sourceline}, section"
    for element in root.iterfind(".//transitionCondition/variableName"):
        if element.text:
            yield TextKind.CONDITION, element.text, f"line {element.sourceline}, condition"
