"""Reads ``.EXP`` files: the project, and the place of each object in the text. `exp_codec` is the way back."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.codesys23.chart_text import (
    PouNames,
    body_problems,
    called_alone,
    is_chart,
    read_chart,
    read_text_body,
)
from plcopen_sfc.formats.codesys23.exp_outline import (
    GLOBALS,
    OTHER,
    OWN_LINE,
    PRAGMA,
    ExpAction,
    ExpBody,
    ExpObject,
    ExpOutline,
    Span,
    after_comments,
    core,
    open_comment,
    outline_of,
)
from plcopen_sfc.formats.declaration_blocks import head_places, section_places, type_places
from plcopen_sfc.formats.remainder_comments import DAMAGED, OUTDATED, Entry, put_back, read_entries
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import Place, ReadText, block_span, plain_lines
from plcopen_sfc.languages.declarations import Declared, Head, read_declarations, read_interface
from plcopen_sfc.languages.declarations.declaration_comments import comment_text
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.networks.exported_networks import KNOWN_SECTIONS
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, tokenize
from plcopen_sfc.model.actions import STEP_ACTION_ENDINGS
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.model.variables import VariableSection

KINDS = {
    "PROGRAM": PouKind.PROGRAM,
    "FUNCTION_BLOCK": PouKind.FUNCTION_BLOCK,
    "FUNCTION": PouKind.FUNCTION,
}
HEADER = "\n".join(
    (
        "(* @NESTEDCOMMENTS := 'Yes' *)",
        "(* @PATH := '' *)",
        "(* @OBJECTFLAGS := '0, 8' *)",
        "(* @SYMFILEFLAGS := '2048' *)",
    )
)
"""Pragmas of an object without properties of its own."""
DIVIDER = "(* @END_DECLARATION := '0' *)"
ONE_BYTE_PAGES = ("cp1250", "cp1251", "cp1252", "cp1253", "cp1254", "cp1257")
DAMAGED_CHARACTER = re.compile("[\x80-\x9f]")
"""A byte that is no character, as text in one of these code pages has it."""
CODE_PAGE = "code_page"
"""Name of the code page in a comment of this package."""


def footer_of(name: str) -> str:
    """Return the pragmas behind a list of global variables that is connected to no file."""
    lines = ("FILENAME : ''", "FILETIME : 0", "EXPORT : 0", "NUMOFCONNECTIONS : 0", "*)")
    return "\n".join((f"(* @OBJECT_END := '{name}' *)", f"(* @CONNECTIONS := {name}", *lines))


_BOOL = ElementaryType(name=Elementary.BOOL)
_MANY = 20
"""Problems of one body that are reported; the rest mostly follows from these."""

_REMAINDER_CODES = {DAMAGED: "EXP202", OUTDATED: "EXP203"}


def read_export(source: SourceText, file: str | None = None) -> ReadText:
    """Read a file. Never raises: what cannot be read is kept and reported."""
    return _Reader(source, file).run()


class _Reader:
    def __init__(self, source: SourceText, file: str | None) -> None:
        self.source = source
        self.file = file
        self.lines = Lines(source.text)
        self.text = source.text
        self.diagnostics: list[Diagnostic] = []
        self.project = Project(dialect=Dialect.CODESYS)
        self.places: list[Place] = []
        self.others: dict[str, str] = {}

    def run(self) -> ReadText:
        if self.source.guessed:
            message = f"the file names no code page; taken as {self.source.encoding}, which is a guess{self._share()}"
            self._note("EXP200", Severity.WARNING, message, 0)
            self._tell_mixture()
        self._tell_damage()
        outline = outline_of(self.source.text)
        self.text = outline.text
        for problem in outline.problems:
            self._note("EXP101", Severity.ERROR, problem.message, problem.span[0])
        for one in outline.objects:
            if one.kind == "TYPE":
                self._types(one)
            elif one.kind == GLOBALS:
                self._globals(one)
            elif one.kind not in KINDS:
                self._other(one)
        for one in outline.objects:  # last: charts ask for global variables
            if one.kind in KINDS:
                self._pou(one)
        self._tail(outline)
        project = self._with_remainder()
        spans = block_span(("file", ""), (0, len(self.text)), self.places)
        return ReadText(project, spans, self.diagnostics)

    def _tell_damage(self) -> None:
        """Report bytes that are no characters of the code page."""
        is_possible = self.source.encoding in ONE_BYTE_PAGES
        for found in islice(DAMAGED_CHARACTER.finditer(self.text), _MANY) if is_possible else ():
            byte = f"16#{ord(found.group()):02X}"
            message = f"the byte {byte} is no character of the code page {self.source.encoding}; it is kept"
            self._note("EXP205", Severity.WARNING, message, found.start())

    def _tell_mixture(self) -> None:
        """Report a word in another code page than the one that was guessed, such as one that was pasted."""
        guess = self.source.encoding
        for found in _WORD.finditer(self.text) if guess in _GUESSES else ():
            word = found.group()
            if DAMAGED_CHARACTER.search(word):
                continue
            page = _page_of(word.encode(guess))
            if page == "cp1252" and guess == "cp1250":  # no letter of a single word tells them apart
                continue
            if page not in ("", guess):
                shown = word.encode(guess).decode(page, "replace")
                message = (
                    f"{word[:30]!r} is {shown[:30]!r} in {page}: the file mixes code pages, and was read in {guess}"
                )
                self._note("EXP204", Severity.WARNING, message, found.start())
                return

    def _share(self) -> str:
        """Return how many of the letters beyond ASCII speak for the code page that was guessed."""
        letters = sum(map(len, _BEYOND_ASCII.findall(self.text)))
        if self.source.encoding not in _GUESSES or not letters:
            return ""
        if self.source.encoding == "cp1250":
            share = sum(map(len, central_letters(self.source.encode(self.text)[0]))) / letters
            return f": {share:.0%} of its letters beyond ASCII are inside words with ł, ą, š or ő, as in Central Europe"
        runs = _RUNS[self.source.encoding]
        share = sum(len(found.group()) for found in runs.finditer(self.text)) / letters
        if self.source.encoding == "cp1251":
            return f": {share:.0%} of its letters beyond ASCII are in runs, as in Cyrillic words"
        return f": {1 - share:.0%} of its letters beyond ASCII are alone or in pairs, as in words of Western Europe"

    # -- objects

    def _pou(self, one: ExpObject) -> None:
        start = one.declared[0]
        declared = self._declarations(one)
        head = declared.heads[0] if declared.heads else None
        interface = read_interface(declared)
        variables = interface.variables()
        globals_ = [variable for section in self.project.global_variables for variable in section.variables]
        names = PouNames(
            frozenset(action.name.casefold() for action in one.actions),
            frozenset(variable.name.casefold() for variable in variables),
            frozenset(variable.name.casefold() for variable in (*variables, *globals_) if variable.type == _BOOL),
            self._stand_ins(one),
        )
        pou = Pou(
            name=one.name,
            kind=KINDS[one.kind],
            interface=interface,
            comment=head.comment if head is not None else None,
            extension_data=keep(self._header(one)),
        )
        places: list[Place] = self._header_places(one)
        if head is not None:
            places += head_places(declared, start)
        places += section_places(self.text, declared, start, Dialect.CODESYS)
        if one.divider is not None:
            places.append((("divider", ""), one.divider, ()))
        path = f"POU {one.name}"
        if one.body is not None:
            body, inside = self._body(one.body, path, names)
            pou.bodies = [body if body is not None else StBody()]
            places += [*inside, (("end", ""), one.body.end, ())]
            pou.extension_data = keep(kept(pou.extension_data) | self._kept_pragmas(one.body.span))
        for action in one.actions:
            pou.actions.append(self._action(action, path, names, places))
        pou.actions = [action for action in pou.actions if action.name.casefold() not in names.replaced]
        self.project.pous.append(pou)
        self.places.append((("POU", one.name), one.span, block_span(("POU", one.name), one.span, places).spans))

    def _stand_ins(self, one: ExpObject) -> dict[str, str]:
        """Return the entry and exit actions that only call an action, which nothing else of the POU names."""
        found: dict[str, str] = {}
        known = {action.name.casefold(): action.name for action in one.actions}
        for action in one.actions:
            if not action.name.casefold().endswith(tuple(STEP_ACTION_ENDINGS.values())):
                continue
            called = called_alone(self.text, core(self.text, action.body.span))
            word = re.compile(rf"\b{action.name}\b", re.IGNORECASE)
            if ("." in called or called.casefold() in known) and len(word.findall(self.text, *one.span)) == 1:
                found[action.name.casefold()] = called
        return found

    def _action(self, one: ExpAction, path: str, names: PouNames, places: list[Place]) -> Action:
        body, inside = self._body(one.body, f"{path} / action {one.name}", names)
        span = (one.head[0], one.body.end[1])
        inside = [(("head", ""), one.head, ()), *inside, (("end", ""), one.body.end, ())]
        places.append((("action", one.name), span, block_span(("action", one.name), span, inside).spans))
        return Action(name=one.name, body=body or StBody(), extension_data=keep(self._kept_pragmas(one.body.span)))

    def _kept_pragmas(self, span: Span) -> dict[str, str]:
        """Return the pragmas at the start of a body, to be kept."""
        pragmas = "\n".join(plain_lines(found.group()) for found in self._pragmas(span))
        return {"pragmas": pragmas} if pragmas else {}

    def _body(self, one: ExpBody, path: str, names: PouNames) -> tuple[Body | None, list[Place]]:
        pragmas = self._pragmas(one.span)
        places: list[Place] = [(("pragma", found["name"]), found.span(), ()) for found in pragmas]
        span = core(self.text, (pragmas[-1].end() if pragmas else one.span[0], one.span[1]))
        if is_chart(self.text, span):

            def note(code: str, message: str, offset: int) -> None:
                self._note(code, Severity.ERROR, message, offset, path)

            chart = read_chart(self.text, span, names, note)
            return chart.body, places + chart.places
        body = read_text_body(self.text, span)
        for message, offset in body_problems(body, self.text, span):
            self._note("EXP110", Severity.ERROR, message, offset, path)
        return body, places + ([(("body", ""), span, ())] if body is not None else [])

    def _pragmas(self, span: Span) -> list[re.Match[str]]:
        """Return the pragmas at the start of a body."""
        found: list[re.Match[str]] = []
        position = span[0]
        while True:
            start = core(self.text, (position, span[1]))[0]
            pragma = PRAGMA.match(self.text, start, span[1])
            if pragma is None:
                return found
            found.append(pragma)
            position = pragma.end()

    def _types(self, one: ExpObject) -> None:
        declared = self._declarations(one)
        if not declared.types:
            self._other(one)
            return
        first, *others = declared.types  # CoDeSys has one type in an object
        first.extension_data = keep(kept(first.extension_data) | self._header(one))
        self.project.data_types += [first, *others]
        inner = type_places(self.text, declared, one.declared[0])
        places = [*self._header_places(one), (("type", ""), one.declared, inner)]
        if one.divider is not None:
            places.append((("divider", ""), one.divider, ()))
        key = ("type", first.name)
        self.places.append((key, one.span, block_span(key, one.span, places).spans))

    def _globals(self, one: ExpObject) -> None:
        declared = self._declarations(one)
        if not declared.sections:
            self._other(one)
            return
        places: list[Place] = self._header_places(one)
        places += section_places(self.text, declared, one.declared[0], Dialect.CODESYS)
        if one.footer is not None:
            places.append((("footer", ""), one.footer, ()))
        for number, section in enumerate(declared.sections):
            section.name = one.name or None
            if not number:
                section.extension_data = keep(kept(section.extension_data) | self._header(one))
            self.project.global_variables.append(section)
        key = ("global variables", one.name)
        self.places.append((key, one.span, block_span(key, one.span, places).spans))

    def _other(self, one: ExpObject) -> None:
        word = one.name.upper()
        if one.kind == OTHER and word and not (word.startswith("_") or word in KNOWN_SECTIONS):
            message = f"a section that begins with {one.name[:30]} is not known; it is kept as it is"
            self._note("EXP107", Severity.WARNING, message, one.span[0])
        solid = after_comments(self.text, max(one.header[1], one.span[0]), one.span[1])
        if one.kind == OTHER and not word and (opener := open_comment(self.text, *one.span)) is not None:
            self._note(
                "EXP101", Severity.ERROR, "this comment has no end, so that what follows it is a part of it", opener
            )
        elif one.kind == OTHER and not word and solid < one.span[1]:
            line = self.text[solid : one.span[1]].split("\n", 1)[0].strip()[:30]
            self._note("EXP107", Severity.WARNING, f"{line} begins no object; it is kept as it is", solid)
        text = plain_lines(self.text[one.span[0] : one.span[1]])
        name = f"section{len(self.others) + 1}"
        self.others[name] = text
        self.places.append((("other", name), one.span, ()))

    # -- parts of objects

    def _declarations(self, one: ExpObject) -> Declared:
        start, end = one.declared
        declared = read_declarations(self.text[start:end], Dialect.CODESYS)
        for problem in declared.problems[:_MANY]:
            self._note("EXP111", Severity.ERROR, problem.message, start + problem.span[0])
        for item in declared.items:
            if not isinstance(item.thing, Head | VariableSection | None):
                word = self.text[start + item.span[0] : end].split(maxsplit=1)[0].upper()
                message = f"{word} is not allowed in a POU or a list of variables, and is no part of the model"
                self._note("EXP111", Severity.ERROR, message, start + item.span[0])
        return declared

    def _header(self, one: ExpObject) -> dict[str, str]:
        """Return the pragmas of an object where they are not the usual ones; the name of a list is not among them."""
        found = [m for m in PRAGMA.finditer(self.text, *one.header) if m["name"] != "GLOBAL_VARIABLE_LIST"]
        text = "\n".join(plain_lines(m.group()) for m in found)
        texts = {} if text == HEADER else {"header": text}
        if one.kind in (*KINDS, "TYPE") and one.divider is None:
            texts["undivided"] = ""
        if one.kind == GLOBALS and not one.name:
            texts["unlisted"] = ""
        footer = plain_lines(self.text[slice(*one.footer)]) if one.footer is not None else ""
        if one.kind == GLOBALS and footer != footer_of(one.name):
            texts["footer"] = footer
        return texts

    def _header_places(self, one: ExpObject) -> list[Place]:
        start, end = one.header
        return [(("header", ""), one.header, ())] if start < end else []

    # -- behind the objects

    def _tail(self, outline: ExpOutline) -> None:
        if self.others:
            self.project.extension_data = keep(self.others)
        start, end = core(self.text, outline.tail)
        self._tell_cut(start, end)
        if start < end:
            self.project.comment = comment_text(tokenize(self.text[start:end], Dialect.CODESYS).comments)
            self.places.append((("comment", ""), (start, end), ()))

    def _tell_cut(self, start: int, end: int) -> None:
        """Report the end of a file that was cut off between two objects: a comment or pragmas with nothing behind."""
        opener = open_comment(self.text, start, end)
        if opener is not None:
            self._note("EXP101", Severity.ERROR, "the file ends too early: this comment has no end", opener)
        elif (header := PRAGMA.search(self.text, start, end)) is not None:
            message = "the file ends too early: the object is missing that these pragmas begin"
            self._note("EXP101", Severity.ERROR, message, header.start())

    def _with_remainder(self) -> Project:
        entries = self._entries()
        if not entries:
            return self.project
        spans = [comment.span for _, comment in entries]
        self.places.append((("rest", ""), (spans[0][0], spans[-1][1]), ()))
        content = [entry for entry in entries if entry[0].path != (CODE_PAGE,)]
        return put_back(self.project, content, self._remainder_note) if content else self.project

    def _entries(self) -> Sequence[Entry]:
        text = self.source.text
        comments = [
            Comment(CommentKind.BLOCK, _PAIR.sub(_character, m.group()), m.span()) for m in OWN_LINE.finditer(text)
        ]
        return read_entries(comments, OWN_LINE, self._remainder_note)

    # -- findings

    def _remainder_note(self, kind: str, message: str, offset: int) -> None:
        self._note(_REMAINDER_CODES[kind], Severity.WARNING, message, offset)

    def _note(self, code: str, severity: Severity, message: str, offset: int, path: str = "") -> None:
        line, column = self.lines.place(offset)
        self.diagnostics.append(Diagnostic(code, severity, message, Location(self.file, line, column, path or None)))


_RUNS = {"cp1251": re.compile("[\u0400-\u04ff]{3,}"), "cp1252": re.compile("[\xa8\xb8\xc0-\xff]{3,}")}
"""Letters beside each other, as Cyrillic words have them, in two of the code pages that are guessed."""
_GUESSES = (*_RUNS, "cp1250")
_CENTRAL_LETTERS = re.compile(
    rb"(?<=[A-Za-z])[\xc0-\xff]*[\xa3\xa5\xaf\xb3\xb9\xbc\xbe\xbf]+[\xc0-\xff]*(?=[A-Za-z])(?!h\b)"
    rb"|(?<=[A-Za-z])[\x8a\x8d\x8e\x8f\x9a\x9d\x9e\x9f]|[\x8a\x8d\x8e\x8f\x9a\x9d\x9e\x9f](?=[A-Za-z])"
)
"""Letters of Central Europe (1250) in words: in 1252 they are signs such as ³ and £, nothing, or letters of few words.

A unit such as m³h is no word.
"""
_HUNGARIAN_LETTERS = re.compile(rb"[\xf5\xd5\xfb\xdb]")
"""ő and ű in 1250, õ and û in 1252."""
_NOT_HUNGARIAN = re.compile(rb"[\xc3\xe3\xc4\xe4]|[\xd5\xf5][Ee][Ss](?![A-Za-z\xc0-\xff])")
"""Letters of Estonian and Portuguese (ä, ã, -ões), which have õ, too."""
_DOUBLE_ACUTE = re.compile(rb"[\xf5\xd5]")


def central_letters(data: bytes) -> list[bytes]:
    """Return the letters in words that speak for Central Europe.

    French has û as well: it counts where a letter that is ő or õ is there too, and no letter of Estonian or Portuguese.
    """
    found: list[bytes] = _CENTRAL_LETTERS.findall(data)
    if _DOUBLE_ACUTE.search(data) and not _NOT_HUNGARIAN.search(data):
        found += _HUNGARIAN_LETTERS.findall(data)
    return found


_WORD = re.compile(r"(?<![A-Za-z])[A-Za-z]*[^\x00-\x7f][A-Za-z\x80-\uffff]*")
_THREE_LETTERS, _ASCII_LETTERS = re.compile(rb"[\xa8\xb8\xc0-\xff]{3}"), re.compile(rb"(?:[A-Za-z].*){3}")
_BEYOND_ASCII = re.compile(r"[^\x00-\x7f]+")
_PAIR = re.compile(r"\$u(D[89AB][0-9A-F]{2})\$u(D[C-F][0-9A-F]{2})")
"""A character beyond the first 65536 in a comment of this package."""


def _character(pair: re.Match[str]) -> str:
    return bytes.fromhex(pair[1] + pair[2]).decode("utf-16-be")


def _page_of(word: bytes) -> str:
    """Return the code page that a word speaks for: letters beside each other are Cyrillic, among ASCII Western.

    Russian texts have words with one Latin letter that looks like theirs.
    """
    try:
        word.decode()
    except UnicodeDecodeError:
        return "cp1251" if _THREE_LETTERS.search(word) else "cp1252" if _ASCII_LETTERS.search(word) else ""
    return "utf-8"
