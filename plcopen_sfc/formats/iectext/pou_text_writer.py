"""Writes programs, function blocks, functions, the actions and methods in them, and the parts of their charts.

The readers are `pou_text_reader`, and `chart_text_reader` for steps with their associations, and transitions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import count

from pydantic import BaseModel

from plcopen_sfc.formats.iectext.chart_text_reader import (
    association_fields,
    body_fields,
    guarded_call,
    guarded_statement,
    ids_within,
    named_condition,
    unnegated,
)
from plcopen_sfc.formats.iectext.text_declarations import write_interface
from plcopen_sfc.formats.iectext.text_outline import KEYWORDS, PartKind, outline
from plcopen_sfc.formats.iectext.text_printing import (
    TextPrinter,
    comment_lines,
    drawn_changes,
    foreign_pragmas,
    is_lifted_body,
    is_text_body,
    missing,
    note_changes,
    pragma,
    pragmas,
    split,
)
from plcopen_sfc.formats.iectext.text_source import (
    INDENT,
    TextBlock,
    format_comment,
    indented,
    keep_data,
    keep_text,
    kept_texts,
)
from plcopen_sfc.formats.text_patch import Key, WrittenBlock, numbered_blocks
from plcopen_sfc.languages.declarations.kept_texts import texts_from
from plcopen_sfc.languages.networks import shown_body, shown_condition, shown_named_condition
from plcopen_sfc.languages.pragmas import Fields, Numbered, RemainderEntry, Segment, changes, plain_fields
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.actions import STEP_ACTIONS, Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou, PouKind
from plcopen_sfc.model.sfc import (
    ActionAssociation,
    Body,
    BodyCondition,
    Condition,
    SfcBody,
    SfcNetwork,
    Step,
    Transition,
)
from plcopen_sfc.report import Outcome

_STEP_QUALIFIERS = {"entry": "P1", "main": "N", "exit": "P0"}
WriteAction = Callable[[str, Body, str], str]
"""Writes an action in place: its name, its body, the indentation."""


@dataclass(slots=True)
class ChartTextWriter:
    """Writes one chart of the POU or action at `path`. `objects` are the transition objects of the POU."""

    printer: TextPrinter
    chart: SfcNetwork
    path: str
    objects: list[NamedTransition]
    write_action: WriteAction
    indent: str = INDENT
    names: dict[int, str] = field(default_factory=dict)
    names_by_id: dict[int, str] = field(default_factory=dict)
    explicit: frozenset[int] = frozenset()
    unused: list[int] = field(default_factory=list)
    unique: bool = True
    late: list[RemainderEntry] = field(default_factory=list)
    named: frozenset[str] = frozenset()
    labels: dict[int, str] = field(init=False)

    def __post_init__(self) -> None:
        """Transitions are called by their labels in the report."""
        self.labels = self.chart.labels()

    def blocks(self) -> Iterator[tuple[Key, str]]:
        """Yield the steps and transitions, each with a key that stays when it is renamed."""
        self._choose_names()
        self.named = frozenset(one.name.casefold() for one in self.objects)
        rest = plain_fields(self.chart, leave=frozenset({"steps", "transitions"}))
        ids = self._ids()
        self.unique = len(set(ids)) == len(ids)
        if not self.unique or any(True for _ in ids_within(rest)) or self._has_big_parts():
            self.explicit = frozenset(ids)
        else:
            self.explicit, self.unused = _explicit_ids(ids)
        if self.explicit:
            self.printer.note(Outcome.EXTENSION_DATA, "ids", self.path, "IEC text knows names only")
        transitions = list(self.chart.transitions)
        shown: set[int] = set()
        known = {step.id for step in self.chart.steps}
        for index, step in enumerate(self.chart.steps):
            yield ("step", str(step.id)), self.step(index, step)
            shown.add(step.id)
            last = index + 1 == len(self.chart.steps)
            while transitions and (last or set(transitions[0].sources) & known <= shown):
                yield ("transition", str(transitions[0].id)), self.transition(transitions.pop(0))
        for transition in transitions:
            yield ("transition", str(transition.id)), self.transition(transition)

    def _choose_names(self) -> None:
        taken: set[str] = set()
        for index, step in enumerate(self.chart.steps):
            name = step.name
            if not self.printer.is_name(name) or name.casefold() in taken:
                own = self.printer.used
                self.printer.used = own | taken | {s.name.casefold() for s in self.chart.steps}
                name = self.printer.new_name(name or "Step")
                self.printer.used = own | {name.casefold()}
            taken.add(name.casefold())
            self.names[index] = name
            self.names_by_id.setdefault(step.id, name)

    def _ids(self) -> list[int]:
        ids = [i for s in self.chart.steps for i in (s.id, *(a.id for a in s.actions))]
        ids += [t.id for t in self.chart.transitions]
        return ids

    def _has_big_parts(self) -> bool:
        parts = [*self.chart.steps, *self.chart.transitions, *(a for _, a in self.chart.associations())]
        return any(
            part.extension_data is not None
            or (isinstance(part, Transition) and _is_drawn(part.condition))
            or (isinstance(part, Step) and any(map(_is_drawn, part.conditions.values())))
            for part in parts
        )

    # -- steps --------------------------------------------------------------------------------------------------------

    def step(self, index: int, step: Step) -> str:
        """``STEP name: associations END_STEP``, and the actions in place that belong to it."""
        path = f"{self.path} / step {step.name}"
        self.printer.note(Outcome.KEPT, "step", path)
        in_place: list[tuple[str, Body]] = []
        lift = lifter(self.printer, self.names[index], in_place)
        leave = frozenset({"id", "actions", *(f"{kind}_action" for kind in STEP_ACTIONS)})
        intended = plain_fields(step, lift, leave)
        if step.id in self.explicit:
            intended["id"] = step.id
        read_back: Fields = {"name": self.names[index]} | ({"initial": True} if step.initial else {})
        text = comment_lines(intended, read_back, self.indent) + foreign_pragmas(intended, read_back, self.indent)
        inner = self.indent + INDENT
        near = self._near(read_back, intended, ("steps", Numbered(step.id)), path)
        lines = ""
        for kind, value in step.step_actions.items():
            lines += self._step_action(kind, value, in_place, self.names[index], inner)
            self.printer.note(Outcome.TRANSLATED, f"{kind} action", path, "an association with a pragma")
        for number, association in enumerate(step.actions):
            lines += self._association(association, number, in_place, index, path)
        keyword = "INITIAL_STEP" if step.initial else "STEP"
        text += f"{self.indent}{keyword} {self.names[index]}:{_beside(near, inner)}{lines}{self.indent}END_STEP\n"
        return text + self._actions(in_place)

    def _actions(self, in_place: list[tuple[str, Body]]) -> str:
        return "".join("\n" + self.write_action(name, body, self.indent) for name, body in in_place)

    def _near(self, read_back: Fields, intended: Fields, place: tuple[Segment, ...], path: str) -> list[RemainderEntry]:
        """Return the changes to write beside an element; those too big for it are left for the end of the unit."""
        near, late = split(changes(read_back, intended))
        note_changes(self.printer, (*near, *late), path, leave=("id", "target", "body", *_BEYOND))
        if self.unique and all(one.id in self.explicit for one in place if isinstance(one, Numbered)):
            self.late += [RemainderEntry(("chart", *place, *change.path), change.value) for change in late]
        else:
            near += late
        return sorted(near, key=lambda change: change.path[0] != "id")

    def _step_action(
        self, kind: str, value: str | Body, in_place: list[tuple[str, Body]], step: str, inner: str
    ) -> str:
        if isinstance(value, str):
            target = value
        else:
            target = self.printer.new_name(f"{step}_{kind}")
            in_place.append((target, value))
        qualifier = _STEP_QUALIFIERS[kind]
        wanted = {"target": target} | ({"qualifier": qualifier} if qualifier != Qualifier.N else {})
        shown, read_back = self._call(wanted)
        return f"{inner}{shown};{_beside(list(changes(read_back, wanted | {'step_action': kind})), inner + INDENT)}"

    def _association(
        self, association: ActionAssociation, number: int, in_place: list[tuple[str, Body]], index: int, path: str
    ) -> str:
        """Return the line of an association in its step.

        `wanted` are the fields that the line has, `read_back` those that a reader gets from it, and `intended` those
        of the association: the pragmas beside the line have the difference of the last two.
        """
        inner = self.indent + INDENT
        step, name = self.chart.steps[index], self.names[index]
        body = association.body
        alone = body is not None and association.target is None and is_text_body(body)
        intended = plain_fields(
            association, lifter(self.printer, name, in_place), frozenset({"id", "body"} if alone else {"id"})
        )
        if association.id in self.explicit:
            intended["id"] = association.id
        wanted: Fields = {k: intended[k] for k in ("target", "qualifier", "duration", "indicator") if k in intended}
        if association.qualifier is Qualifier.R0:
            wanted["qualifier"] = Qualifier.R
        if alone and body is not None:
            wanted["target"] = self.printer.new_name(f"{name}_action_{number + 1}")
            in_place.append((wanted["target"], body))
        beyond = [key for key in _BEYOND if key in intended] + (["step"] if step.negated else [])
        if association.qualifier in _OF_GRAPH:
            beyond.append("qualifier")
        place = f"{path} / {association.target or wanted.get('target', '')}"
        guarded = None
        if beyond == ["condition"]:
            guarded = self._guarded(association, step)
        elif beyond == ["qualifier"] and association.qualifier is Qualifier.CALL:
            guarded = self._called(association, step)
        if guarded is not None:
            if alone and body is not None:
                in_place.pop()
                intended["body"] = plain_fields(body)
            wanted["target"] = self.printer.new_name(f"{name}_{association.target or 'call'}")
            wanted.pop("qualifier", None)
            in_place.append((wanted["target"], guarded))
            self.printer.note(Outcome.TRANSLATED, "action", place, "in an action; the association in pragmas")
        elif beyond:
            wanted["target"] = missing(self.printer, association.target or name)
            for key in beyond:
                self.printer.note_placeholder(key, place, wanted["target"])
        shown, read_back = self._call(wanted)
        if guarded is not None:
            read_back["body"] = {"body_of": read_back.pop("target")}
        elif alone and beyond:
            intended["body"] = {"body_of": in_place[-1][0]}
        elif alone:
            intended["body"] = read_back["body"] = {"body_of": read_back.pop("target")}
        self.printer.note(Outcome.KEPT, "association", f"{path} / {association.target or wanted.get('target', '')}")
        comment = intended.get("comment")
        beside = format_comment(comment, inner) if isinstance(comment, str) else None
        if beside is not None:
            read_back["comment"] = comment
        near = self._near(read_back, intended, ("steps", Numbered(step.id), "actions", Numbered(association.id)), path)
        return f"{inner}{shown};" + (f" {beside}" if beside else "") + _beside(near, inner + INDENT)

    def _guarded(self, association: ActionAssociation, step: Step) -> Body | None:
        """Return a body that does the same as the qualifier N with a variable under a condition.

        It is executed once more when the step is left (IEC 61131-3, 6.7.4.6), which makes the variable FALSE.
        """
        target, condition = association.target or "", association.condition
        plain = association.qualifier in (Qualifier.N, Qualifier.NONE) and association.body is None
        if not plain or not self.printer.is_name(target) or target.casefold() in self.printer.actions:
            return None
        if not isinstance(condition, Expression) or not self.printer.is_expression(condition.text.strip()):
            return None
        return StBody(text=guarded_statement(target, step.name, condition.text, negated=condition.negated))

    def _called(self, association: ActionAssociation, step: Step) -> Body | None:
        """Return a body for the call of a row of S7-GRAPH, in each cycle in which its step is active."""
        if not isinstance(association.body, StBody) or association.target is not None or association.duration:
            return None
        statements = association.body.text.strip()
        text = guarded_call(step.name, statements)
        _, comes_back = self.printer.code(text)
        return StBody(text=text) if comes_back and "\n" not in statements else None

    def _call(self, wanted: Fields) -> tuple[str, Fields]:
        """``target(qualifier, time, indicator)`` as far as it can be written, and the fields read from that."""
        qualifier = wanted.get("qualifier", "N")
        for keys in (("duration", "indicator"), ("duration",), ("indicator",), ()):
            arguments = [] if qualifier == Qualifier.NONE else [qualifier, *(wanted[k] for k in keys if k in wanted)]
            shown = f"{wanted.get('target', '')}({', '.join(arguments)})"
            read_back = self._taken(shown)
            if read_back is not None and read_back.get("target") == wanted.get("target"):
                return shown, read_back
        shown = self.printer.new_name(wanted.get("target") or "Action")
        shown += "()" if qualifier == Qualifier.NONE else f"({qualifier})"
        return shown, self._taken(shown) or {}

    def _taken(self, shown: str) -> Fields | None:
        found = tokenize(shown, self.printer.dialect, KEYWORDS)
        if found.problems or found.comments or "\r" in shown or "\x00" in shown:
            return None
        if any(t.type == "SEMICOLON" or t.type in KEYWORDS for t in found.tokens):
            return None
        return association_fields(shown, found.tokens)

    # -- transitions --------------------------------------------------------------------------------------------------

    def transition(self, transition: Transition) -> str:
        """``TRANSITION name (PRIORITY := n) FROM (..) TO (..) := condition; END_TRANSITION``."""
        path = f"{self.path} / transition {self.labels[transition.id]}"
        self.printer.note(Outcome.KEPT, "transition", path)
        in_place: list[tuple[str, Body]] = []
        name = transition.name if self.printer.is_name(transition.name) else ""
        intended = plain_fields(transition, leave=frozenset({"id", "condition"}))
        if transition.id in self.explicit:
            intended["id"] = transition.id
        read_back: Fields = {"name": name} if name else {}
        text = comment_lines(intended, read_back, self.indent) + foreign_pragmas(intended, read_back, self.indent)
        head = f"{self.indent}TRANSITION" + (f" {name}" if name else "")
        if transition.priority is not None and transition.priority >= 0:
            head += f" (PRIORITY := {transition.priority})"
            read_back["priority"] = transition.priority
        head += self._side("FROM", "sources", transition, read_back) + self._side(
            "TO", "targets", transition, read_back
        )
        condition, shown = self._condition(transition, intended, in_place)
        near = self._near(read_back | shown, intended, ("transitions", Numbered(transition.id)), path)
        return f"{text}{head}{_beside(near, self.indent + INDENT)}{condition}{self.indent}END_TRANSITION\n" + (
            self._actions(in_place)
        )

    def _side(self, keyword: str, side: str, transition: Transition, read_back: Fields) -> str:
        ids = getattr(transition, side)
        by_id = self.names_by_id
        names = [by_id[i] for i in ids if i in by_id]
        if names:
            read_back[side] = [i for i in ids if i in by_id]
        for name in texts_from(keyword.lower(), transition.extension_data):
            if self.printer.is_name(name):
                names.append(name)
                keep_text(read_back, keyword.lower(), name)
        return f" {keyword} {names[0]}" if len(names) == 1 else f" {keyword} ({', '.join(names)})"

    def _condition(
        self, transition: Transition, intended: Fields, in_place: list[tuple[str, Body]]
    ) -> tuple[str, Fields]:
        """Return the lines of the condition and the fields read from them; those of the model go into `intended`."""
        condition = transition.condition
        if condition is None:
            return "", {}
        inner = self.indent + INDENT
        wish = transition.name or "Transition"
        intended_condition = plain_fields(condition)
        if isinstance(condition, BodyCondition) and isinstance(condition.body, StBody):
            text = condition.body.text.strip().removesuffix(";")
            if self.printer.is_expression(text):
                condition = Expression(text=text, negated=condition.negated)
        if isinstance(condition, Expression | NamedCondition):
            intended["condition"] = intended_condition
            text = (condition.text if isinstance(condition, Expression) else condition.name).strip()
            if not self.printer.is_expression(text):
                return self._nothing_right(transition, inner)
            read_back: Fields = {"kind": "expression", "text": text}
            if condition.negated:
                shown = f"NOT {text}" if self.printer.is_name(text) else f"NOT ({text})"
                back: Fields = {"text": shown}
                unnegated(back)
                if back["text"] != text:
                    return self._nothing_right(transition, inner)
                text = shown
            return f"{inner}:= {text};\n", {"condition": named_condition(text, self.named) or read_back}
        if isinstance(condition, BodyCondition) and getattr(condition.body, "language", "") in ("ST", "IL"):
            text = condition.body.text  # type: ignore[union-attr]
            lines, comes_back = self.printer.code(text)
            if comes_back and lines.whole() == lines.text and lines.text:
                tokens = tokenize(text, self.printer.dialect, KEYWORDS).tokens
                intended["condition"] = plain_fields(condition)
                shown = f"{inner}:\n{indented(text, inner + INDENT)}\n"
                return shown, {"condition": {"kind": "body", "body": body_fields(text, tokens)}}
        if self.unique and _is_drawn(condition):
            return self._drawn(transition, inner), {}
        intended["condition"] = plain_fields(condition, lifter(self.printer, wish, in_place))
        return self._nothing_right(transition, inner)

    def _drawn(self, transition: Transition, inner: str) -> str:
        """Return the lines that show a drawn condition; the drawing is at the end of the unit."""
        path = f"{self.path} / transition {self.labels[transition.id]}"
        found = shown_condition(self.chart, transition, self.printer.dialect, self.objects)
        shown, lines = "", ""
        # statements give the condition to the name of the transition; without one no reader would know it
        if found is not None and found[1] and is_plain(transition.name):
            code, comes_back = self.printer.code(found[0])
            if comes_back and code.whole() == code.text:
                shown, lines = code.text, f"{inner}:\n{indented(code.text, inner + INDENT)}\n"
        elif found is not None and not found[1] and self.printer.is_expression(found[0]):
            shown, lines = found[0], f"{inner}:= {found[0]};\n"
        if lines:
            self.printer.note(Outcome.TRANSLATED, "condition", path, "shown as text; the drawing in pragmas")
        else:
            lines, read_back = self._nothing_right(transition, inner)
            shown = read_back["condition"]["text"]
        place = ("chart", "transitions", Numbered(transition.id))
        self.late += drawn_changes(plain_fields(transition.condition) if transition.condition else {}, shown, place)
        return lines

    def _nothing_right(self, transition: Transition, inner: str) -> tuple[str, Fields]:
        """Return a condition that does not compile: without one the transition would be always true."""
        text = missing(self.printer, self.labels[transition.id])
        path = f"{self.path} / transition {self.labels[transition.id]}"
        self.printer.note_placeholder("condition", path, text)
        return f"{inner}:= {text};\n", {"condition": {"kind": "expression", "text": text}}


def lifter(printer: TextPrinter, wish: str, in_place: list[tuple[str, Body]]) -> Callable[[BaseModel], Fields | None]:
    """Return what makes bodies inside an element actions in place that it refers to, named after `wish`."""

    def lift(thing: BaseModel) -> Fields | None:
        if not is_lifted_body(thing):
            return None
        name = printer.new_name(f"{wish}_body")
        in_place.append((name, thing))  # type: ignore[arg-type]
        return {"body_of": name}

    return lift


def _is_drawn(condition: Condition | None) -> bool:
    """True if a condition is a drawing, which is written at the end of the unit."""
    if isinstance(condition, BodyCondition):
        return condition.body.language not in ("ST", "IL")
    return isinstance(condition, WiredCondition)


_BEYOND = ("event", "value", "negated", "kind", "condition", "forcing")
"""Fields of an association that decide when it acts, or its effect, and that no text expresses."""
_OF_GRAPH = frozenset("CALL ON OFF CS CU CD CR TL TD TR TF DL".split())
"""Qualifiers that IEC 61131-3 does not have. R0 is R."""
_MOST_GAPS = 8


def _explicit_ids(ids: list[int]) -> tuple[frozenset[int], list[int]]:
    """Return the ids that must be written, and the numbers without an owner: readers give free numbers in order."""
    given = set(ids)
    explicit: set[int] = set()
    unused: list[int] = []
    following = 0
    for one in ids:
        # a file has gaps where its bars and blocks had numbers; a short one is listed once for the whole chart
        gap = list(range(following, one)) if following < one <= following + _MOST_GAPS else []
        if one == following or (gap and given.isdisjoint(gap)):
            unused += gap
            following = one + 1
        else:
            explicit.add(one)
    taken = explicit | set(unused)
    numbers = (number for number in count() if number not in taken)
    # the rule of the reader: ids are left out only if it gives each element the one it has
    fits = all(one in explicit or one == next(numbers) for one in ids)
    return (frozenset(explicit), unused) if fits and len(unused) <= _MOST_GAPS else (frozenset(ids), [])


def _beside(near: list[RemainderEntry], indent: str) -> str:
    """Return an id before the element on its line, other pragmas below."""
    if not near or near[0].path[0] not in ("id", "step_action"):
        return "\n" + pragmas(near, indent)
    return f" {pragma(near[0])}\n" + pragmas(near[1:], indent)


POU_KEYWORDS = {
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
    return _Unit(printer, pou, POU_KEYWORDS[pou.kind], path, indent="", objects=pou.transitions).piece()


def _names(pou: Pou) -> list[str]:
    """Return every name in the POU that an action in place must not take."""
    names = [each.name for each in (*pou.parts, *pou.variables())]
    for _, _, body in pou.named_bodies():
        if isinstance(body, SfcBody):
            names += [step.name for step in body.chart.steps]
            names += [a.target for _, a in body.chart.associations() if a.target is not None]
            for step in body.chart.steps:
                names += [a for a in step.step_actions.values() if isinstance(a, str)]
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
        self.lift = lifter(printer, thing.name, self.in_place)

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
            intended["bodies"] = [plain_fields(other, self.lift) for other in bodies[1:]]
        properties = self._properties(intended, read_back)
        near, late = split([*(extra or []), *changes(read_back, intended)])
        note_changes(self.printer, (*near, *late), self.path, leave=("body", "in_place"))
        late += self.late
        top += pragmas(near, self.indent)
        pieces = [WrittenBlock(("head", ""), (top + head).rstrip("\n"))]
        pieces += sections
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
        for _, text, data in (kept for kept in kept_texts(intended) if kept[0] == "property"):
            found = outline(f"FUNCTION_BLOCK x\n{text}\nEND_FUNCTION_BLOCK\n", self.printer.dialect)
            parts = found.parts[0].parts if len(found.parts) == 1 and not found.problems else []
            if len(parts) == 1 and parts[0].kind is PartKind.PROPERTY and parts[0].end - parts[0].start == len(text):
                texts.append(text)
                keep_data(read_back, data)
        return texts

    def _inner(self, keyword: str, thing: Action | Method | NamedTransition) -> WrittenBlock:
        path = f"{self.path} / {keyword.lower()} {thing.name}"
        self.printer.note(Outcome.KEPT, keyword.lower(), path)
        return _Unit(self.printer, thing, keyword, path, indent=self.inner, objects=self.objects).piece()

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
            self.printer.note_placeholder("body", self.path, name)
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
        body = {key: value for key, value in intended.get("body", {}).items() if key != "text"}
        intended["body"] = body | ({"text": lines.text} if lines.text else {})
        intended["layout"] = {edge: getattr(lines, edge) for edge in _EDGES if getattr(lines, edge)}
        read_back["layout"] = {}
        if not lines.text:
            return []
        if self.keyword == "TRANSITION":
            is_il = isinstance(getattr(self.thing, "body", None), IlBody)
            if not is_il and self.printer.is_expression(lines.text):
                read_back["body"]["language"] = "ST"  # `NOT a OR b` begins as instruction list does
                return [WrittenBlock(("body", ""), f"{self.inner}:= {lines.text};")]
            return [WrittenBlock(("body", ""), f"{self.inner}:\n{indented(lines.text, self.inner + INDENT)}")]
        return [WrittenBlock(("body", ""), indented(lines.text, self.inner), apart=not self.alone, block=True)]

    def _chart(self, body: SfcBody, intended: Fields, read_back: Fields) -> list[WrittenBlock]:
        chart = body.chart
        rest = frozenset({"steps", "transitions"})
        intended["chart"] = plain_fields(chart, self.lift, rest)
        if not chart.steps and not any(t.sources or t.targets for t in chart.transitions):
            intended["chart"] = plain_fields(chart, self.lift)
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
