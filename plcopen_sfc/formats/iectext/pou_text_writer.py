"""Writes programs, function blocks, functions, and the actions and methods in them. The reader is `pou_text_reader`."""

from __future__ import annotations

from pydantic import BaseModel

from plcopen_sfc.formats.iectext.chart_text_reader import body_fields
from plcopen_sfc.formats.iectext.chart_text_writer import ChartTextWriter
from plcopen_sfc.formats.iectext.drawings_in_pragmas import drawn_changes
from plcopen_sfc.formats.iectext.text_declarations import write_interface
from plcopen_sfc.formats.iectext.text_outline import KEYWORDS, PartKind, outline
from plcopen_sfc.formats.iectext.text_printing import (
    TextPrinter,
    comment_lines,
    foreign_pragmas,
    is_text_body,
    missing,
    note_changes,
    nothing_right,
    pragmas,
    split,
)
from plcopen_sfc.formats.iectext.text_source import INDENT, TextBlock, indented, unwrapped
from plcopen_sfc.formats.text_patch import WrittenBlock, numbered_blocks
from plcopen_sfc.languages.networks import shown_body, shown_named_condition
from plcopen_sfc.languages.pragmas import Fields, RemainderEntry, changes, plain_fields
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.body import Body, FbdBody, LdBody, SfcBody
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou, PouKind
from plcopen_sfc.report import Outcome

_KEYWORDS = {
    PouKind.PROGRAM: "PROGRAM",
    PouKind.FUNCTION_BLOCK: "FUNCTION_BLOCK",
    PouKind.FUNCTION: "FUNCTION",
    PouKind.ORGANIZATION_BLOCK: "PROGRAM",
}
_PARTS = frozenset({"bodies", "body", "actions", "transitions", "methods", "interface"})


def write_pou(printer: TextPrinter, pou: Pou) -> WrittenBlock:
    """Write a program, function block or function."""
    printer.used = {name.casefold() for name in _names(pou)}
    printer.actions = frozenset(action.name.casefold() for action in pou.actions)
    path = f"POU {pou.name}"
    printer.note(Outcome.KEPT, "POU", path)
    return _Unit(printer, pou, _KEYWORDS[pou.kind], path, indent="", objects=pou.transitions).piece()


def _names(pou: Pou) -> list[str]:
    """Return every name in the POU that an action in place must not take."""
    parts: list[Action | NamedTransition | Method] = [*pou.actions, *pou.transitions, *pou.methods]
    names = [*(part.name for part in parts), *(variable.name for variable in pou.variables())]
    for _, _, body in pou.named_bodies():
        if isinstance(body, SfcBody):
            names += [step.name for step in body.chart.steps]
            names += [a.target for _, a in body.chart.associations() if a.target is not None]
            for step in body.chart.steps:
                names += [a for a in (step.entry_action, step.main_action, step.exit_action) if isinstance(a, str)]
    return names


class _Unit:
    """Writes one container: a POU, or an action, a method or a transition object in it."""

    def __init__(
        self,
        printer: TextPrinter,
        thing: Pou | Action | Method | NamedTransition,
        keyword: str,
        path: str,
        *,
        indent: str,
        objects: list[NamedTransition],
    ) -> None:
        self.printer = printer
        self.thing = thing
        self.keyword = keyword
        self.path = path
        self.indent = indent
        self.inner = indent + INDENT
        self.objects = objects
        self.alone = True
        self.late: list[RemainderEntry] = []
        self.in_place: list[tuple[str, Body]] = []

    def piece(self, extra: list[RemainderEntry] | None = None) -> WrittenBlock:
        """Return the text of the container; `extra` are more changes for its pragmas."""
        thing = self.thing
        name = thing.name if self.printer.is_name(thing.name) else self.printer.new_name(thing.name)
        intended = plain_fields(thing, leave=_PARTS)
        read_back: Fields = {"name": name}
        if isinstance(thing, Pou):
            read_back["kind"] = "program" if thing.kind is PouKind.ORGANIZATION_BLOCK else str(thing.kind)
        top = comment_lines(intended, read_back, self.indent) + foreign_pragmas(intended, read_back, self.indent)
        bodies = thing.bodies if isinstance(thing, Pou) else [thing.body] if thing.body is not None else []
        interface = getattr(thing, "interface", None)
        head, sections = write_interface(
            self.printer, self.keyword, name, interface, indent=self.indent, intended=intended, read_back=read_back
        )
        self.alone = "\n" not in head and not sections
        body = self._body(bodies[0] if bodies else None, intended, read_back)
        if len(bodies) > 1:
            intended["bodies"] = [plain_fields(other, self._lift) for other in bodies[1:]]
        properties = self._properties(intended, read_back)
        near, late = split([*(extra or []), *changes(read_back, intended)])
        note_changes(self.printer, (*near, *late), self.path, leave=("body", "in_place"))
        late += self.late
        top += pragmas(near, self.indent)
        pieces = [WrittenBlock(("head", ""), (top + head).rstrip("\n"))]
        pieces += [WrittenBlock(("section", ""), text) for text in sections]
        pieces += [WrittenBlock(("property", ""), self.inner + text, apart=True) for text in properties]
        pieces += [self._inner("METHOD", method) for method in getattr(thing, "methods", [])]
        pieces += body
        pieces += [write_in_place(self, other, part_body) for other, part_body in self.in_place]
        pieces += [self._inner("TRANSITION", transition) for transition in getattr(thing, "transitions", [])]
        pieces += [self._inner("ACTION", action) for action in getattr(thing, "actions", [])]
        if late:
            pieces.append(WrittenBlock(("late", ""), pragmas(late, self.inner).rstrip("\n"), apart=True))
        pieces.append(WrittenBlock(("end", ""), f"{self.indent}END_{self.keyword}"))
        return WrittenBlock((self.keyword.lower(), thing.name), blocks=numbered_blocks(pieces), apart=True)

    def _properties(self, intended: Fields, read_back: Fields) -> list[str]:
        """Properties, which the model has no place for, as they were read."""
        texts: list[str] = []
        for data in intended.get("carried", {}).get("data", []):
            kept = unwrapped(data.get("content", ""))
            if kept is None or kept[0] != "property":
                continue
            found = outline(f"FUNCTION_BLOCK x\n{kept[1]}\nEND_FUNCTION_BLOCK\n", self.printer.dialect)
            parts = found.parts[0].parts if len(found.parts) == 1 and not found.problems else []
            if len(parts) == 1 and parts[0].kind is PartKind.PROPERTY and parts[0].end - parts[0].start == len(kept[1]):
                texts.append(kept[1])
                read_back.setdefault("carried", {}).setdefault("data", []).append(data)
        return texts

    def _inner(self, keyword: str, thing: Action | Method | NamedTransition) -> WrittenBlock:
        path = f"{self.path} / {keyword.lower()} {thing.name}"
        self.printer.note(Outcome.KEPT, keyword.lower(), path)
        return _Unit(self.printer, thing, keyword, path, indent=self.inner, objects=self.objects).piece()

    def _lift(self, thing: BaseModel) -> Fields | None:
        if not is_text_body(thing):
            return None
        name = self.printer.new_name(f"{self.thing.name}_body")
        self.in_place.append((name, thing))  # type: ignore[arg-type]
        return {"body_of": name}

    # -- bodies -------------------------------------------------------------------------------------------------------

    def _body(self, body: Body | None, intended: Fields, read_back: Fields) -> list[WrittenBlock]:
        """Return the lines of the main body; `read_back` gets the fields of the text, `intended` those of the model."""
        read_back["body"] = {"language": "ST"}
        if body is None:
            return []
        if isinstance(body, SfcBody):
            intended["body"] = plain_fields(body, leave=frozenset({"chart"}))
            return self._chart(body, intended, read_back)
        if body.language in ("ST", "IL"):
            intended["body"] = plain_fields(body)
            text: str = body.text
            lines, comes_back = self.printer.code(text)
            if comes_back:
                return self._statements(lines, intended, read_back)
            return []
        shown = self._shown(body) if isinstance(body, FbdBody | LdBody) else None
        if shown is not None:
            self.printer.note(Outcome.TRANSLATED, "body", self.path, "shown as text; the drawing in pragmas")
            name = ""
        else:
            name = missing(self.printer, self.thing.name)
            self.printer.note(Outcome.NOT_EXECUTED, "body", self.path, nothing_right(name))
        lines = shown or TextBlock(name if self.keyword == "TRANSITION" else f"{name} := TRUE;")
        self.late += drawn_changes(plain_fields(body), lines.text, ())
        pieces = self._statements(lines, intended, read_back)
        intended["body"] = read_back["body"]
        return pieces

    def _shown(self, body: FbdBody | LdBody) -> TextBlock | None:
        """Return the lines of structured text for a drawn body."""
        if isinstance(self.thing, NamedTransition):
            found = shown_named_condition(self.thing, self.printer.dialect)
            text = found[0] if found is not None else None
            if found is not None and not found[1]:
                return TextBlock(found[0]) if self.printer.is_expression(found[0]) else None
        else:
            text = shown_body(body, self.printer.dialect)
        lines, comes_back = self.printer.code(text or "")
        return lines if text is not None and comes_back and lines.whole() == lines.text else None

    def _statements(self, lines: TextBlock, intended: Fields, read_back: Fields) -> list[WrittenBlock]:
        tokens = tokenize(lines.text, self.printer.dialect, KEYWORDS).tokens
        read_back["body"] = body_fields(lines.text, tokens)
        intended["body"] = _without_text(intended.get("body", {})) | ({"text": lines.text} if lines.text else {})
        intended["layout"] = {edge: getattr(lines, edge) for edge in _EDGES if getattr(lines, edge)}
        read_back["layout"] = {}
        if not lines.text:
            return []
        if self.keyword == "TRANSITION":
            if read_back["body"]["language"] == "ST" and self.printer.is_expression(lines.text):
                return [WrittenBlock(("body", ""), f"{self.inner}:= {lines.text};")]
            return [WrittenBlock(("body", ""), f"{self.inner}:\n{indented(lines.text, self.inner + INDENT)}")]
        return [WrittenBlock(("body", ""), indented(lines.text, self.inner), apart=not self.alone, block=True)]

    def _chart(self, body: SfcBody, intended: Fields, read_back: Fields) -> list[WrittenBlock]:
        chart = body.chart
        rest = frozenset({"steps", "transitions"})
        intended["chart"] = plain_fields(chart, self._lift, rest)
        if not chart.steps and not any(t.sources or t.targets for t in chart.transitions):
            intended["chart"] = plain_fields(chart, self._lift)
            return []
        read_back["body"] = {"language": "SFC"}
        read_back["chart"] = {}
        writer = ChartTextWriter(self.printer, chart, self.path, self.objects, self._action_in_place, self.inner)
        pieces = [WrittenBlock(key, text.rstrip("\n"), apart=True) for key, text in writer.blocks()]
        self.late += writer.late
        if writer.unused:
            intended["chart"]["unused_ids"] = writer.unused
        return pieces

    def _action_in_place(self, name: str, body: Body, indent: str) -> str:
        return write_in_place(self, name, body, indent).whole() + "\n"


def write_in_place(unit: _Unit, name: str, body: Body, indent: str | None = None) -> WrittenBlock:
    """Write an action for a body that belongs to a step, a transition or the chart."""
    action = Action(name=name, body=body)
    path = f"{unit.path} / {name}"
    inner = _Unit(
        unit.printer, action, "ACTION", path, indent=unit.inner if indent is None else indent, objects=unit.objects
    )
    return inner.piece([RemainderEntry(("in_place",), True)])


_EDGES = ("after", "before", "margin")


def _without_text(body: Fields) -> Fields:
    return {key: value for key, value in body.items() if key != "text"}
