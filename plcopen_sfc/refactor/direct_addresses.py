"""Direct addresses of a project in the numbers of another tool: S7 and TwinCAT count bytes, others words."""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding.text_sites import SiteKind, text_sites
from plcopen_sfc.languages.memory_addresses import MemoryAddress, memory_address
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation.literal_translation import translated_address
from plcopen_sfc.languages.translation.translation_context import PartText
from plcopen_sfc.model.dialect import COUNTING_BYTES, Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import ConfigVariable


def renumber_declared(project: Project, source: Dialect, target: Dialect) -> Iterator[tuple[str, Severity, str]]:
    """Give declared variables the same places in `target`; yield path, severity and reason of each note.

    Addresses that S7 does not know stay, and its writers report them: variables of blocks have no addresses there.
    """
    for path, variable in _located(project):
        if variable.address is None or not variable.address.startswith("%"):
            continue
        new = translated_address(variable.address, source, target)
        if new.severity is Severity.ERROR and Dialect.SCL in (source, target):
            continue
        if new.severity is not None and target is not Dialect.SCL:  # tags, of which the writer tells
            yield path, new.severity, _reason(variable.address, new)
        variable.address = new.text


def renumber_in_texts(project: Project, source: Dialect, target: Dialect) -> Iterator[tuple[str, Severity, str]]:
    """Give addresses in texts, neither in SCL, the same places in `target`; yield path, severity and reason of each."""
    for site in text_sites(project):
        is_text = site.is_program_text or site.reading in (SiteKind.INSTRUCTIONS, SiteKind.DECLARATIONS)
        if not is_text or "%" not in site.text:
            continue
        edits: list[Edit] = []
        found: dict[str, tuple[Severity, str]] = {}
        for token in tokenize(site.text, project.dialect).tokens:
            new = translated_address(token.value, source, target) if token.value.startswith("%") else None
            if new is not None and new.severity is not None:
                found[token.value] = new.severity, _reason(token.value, new)
                if new.text != token.value:
                    edits.append(Edit(*token.span, new.text))
        if edits:
            site.put(apply_edits(site.text, edits))
        for severity, reason in found.values() if site.reading is not SiteKind.DECLARATIONS else ():
            yield site.report_path, severity, reason


def bits_of_words(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the path and the text of each address of a bit, where one shows that they are counted in words: above 7.

    CoDeSys 2.3: the controller decides that (``%QX1.14`` of the WAGO 750); CODESYS V3 and TwinCAT count in bytes.
    """
    bits = [(path, text, match) for path, text in _addresses(project) if (match := _BIT.fullmatch(text)) is not None]
    if any(int(match["bit"]) > _LAST_BIT for _, _, match in bits):
        yield from dict.fromkeys((path, text) for path, text, _ in bits)


def overlapping_words(project: Project) -> Iterator[tuple[str, str, list[str], MemoryAddress]]:
    """Yield path, text and memory of each address that others overlap which are no wider, and the texts of these."""
    by_bytes = project.address_dialect in COUNTING_BYTES
    found: dict[MemoryAddress, tuple[str, str]] = {}
    for path, text in _addresses(project):
        memory = memory_address(text, by_bytes=by_bytes)
        if memory is not None:
            found.setdefault(memory, (path, text))
    last: list[MemoryAddress] = []  # those that may overlap what follows
    parts: dict[MemoryAddress, list[str]] = {}
    for memory in sorted(found, key=lambda each: (each.area, each.start, -each.width)):
        last = [each for each in last if each.overlaps(memory)]
        for whole in last:
            parts.setdefault(whole, []).append(found[memory][1])
        last.append(memory)
    for whole, texts in parts.items():
        yield *found[whole], texts, whole


def _addresses(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the path and the text of each address, of declared variables and in programs."""
    yield from ((path, (variable.address or "").strip()) for path, variable in _located(project))
    for table in project.tag_tables:
        yield from ((f"tag table {table.name} / tag {tag.name}", (tag.address or "").strip()) for tag in table.tags)
    for site in text_sites(project):
        if "%" in site.text and site.is_program_text:
            tokens = tokenize(site.text, project.dialect).tokens
            yield from ((site.report_path, token.value) for token in tokens if token.value.startswith("%"))


_BIT = re.compile(r"%[IQM]X?\d{1,9}\.(?P<bit>\d{1,2})", re.IGNORECASE)
_LAST_BIT = 7


def _reason(text: str, new: PartText) -> str:
    return new.reason if new.text == text else f"{text} is {new.text}: {new.reason}"


def _located(project: Project) -> Iterator[tuple[str, Variable | ConfigVariable]]:
    for pou in project.pous:
        yield from ((f"{pou.report_path} / {variable.name}", variable) for variable in pou.variables())
    for section in project.global_sections():
        around = f"{section.name}." if section.name else ""
        yield from ((f"global variable {around}{variable.name}", variable) for variable in section.variables)
    for settings in (project.config_variables, *(each.config_variables for each in project.configurations)):
        for variable in settings.variables if settings is not None else ():
            yield f"VAR_CONFIG {variable.path}", variable
