"""Charts in ``.EXP`` files: steps with their action in place, and transitions that name their steps.

::

    STEP Fill:
    Valve := TRUE;
    END_STEP
    (* @SFCMAXTIME := 't#20s' *)
    (* @SFCMINTIME := '' *)
    (* @SFCCOMMENT := '' *)
    TRANSITION FROM Fill TO (Mix,Heat):=
    Level > 80
    END_TRANSITION

Seen in exports: this, with ST. By analogy, as no export is at hand that has it: bodies in other languages with the
markers that POUs have, associations as in IEC 61131-3 (``Fill(N);``, ``Drain(D,t#2s);``), and the entry and exit action
of a step as actions of the POU, ``Fill_entry`` and ``Fill_exit``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

from plcopen_sfc.formats.codesys23.exp_outline import (
    PRAGMA,
    Span,
    after_comments,
    core,
    find_end,
    is_in_comment,
    open_comment,
    without_comments,
)
from plcopen_sfc.formats.text_patch import Key, Place, WrittenBlock, block_span, plain_lines
from plcopen_sfc.languages.binding import shared_scans
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.il import OPERATORS, is_il
from plcopen_sfc.languages.il_problems import instruction_problems
from plcopen_sfc.languages.networks import shown_body, shown_condition
from plcopen_sfc.languages.networks.exported_networks import EXPORTS
from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.parsing import parse_expression, statement_problems
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import STEP_ACTION_ENDINGS, Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.text import plain
from plcopen_sfc.report import ORDER_OF_ACTIONS, Cause, CauseKind, ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

SOURCE = EXPORTS
"""Source of the bodies that are kept as they are."""
Note = Callable[[str, str, int], None]
"""Takes a finding: the code of an error, its message, and the offset."""

_ELEMENT = re.compile(r"[ \t]*(?:(INITIAL_STEP|STEP)[ \t]+(\w+)[ \t]*:|TRANSITION\b(?!\s*:=))", re.IGNORECASE)
_NEXT_ELEMENT = re.compile(
    r"(?:^|(?<=\*\))|(?<=\bEND_STEP)|(?<=\bEND_TRANSITION))[ \t]*(?:INITIAL_STEP|STEP|TRANSITION)\b",
    re.MULTILINE | re.IGNORECASE,
)
"""A word at the start of a line, or behind a comment or the element before it, where an element may begin."""
_FIRST_WORD_OF_CHART = re.compile(r"[ \t]*(?:INITIAL_STEP|STEP|TRANSITION)\b", re.IGNORECASE)
_NAMES = r"(\w+|\(\s*\w+(?:\s*,\s*\w+)*\s*\))"
_TRANSITION = re.compile(
    r"[ \t]*TRANSITION\s+(?:(?!FROM\b)(\w+)\s*)?(?:\(\s*PRIORITY\s*:=\s*(\d+)\s*\)\s*)?"
    rf"FROM\s*{_NAMES}\s*TO\s*{_NAMES}\s*:=",
    re.IGNORECASE,
)
_QUALIFIERS = {word: Qualifier(word) for word in ("N", "R", "S", "L", "D", "P", "SD", "DS", "SL")}
"""Qualifiers of the library Iecsfc.lib."""
_MOST_ASSOCIATIONS = 9
_ASSOCIATION = re.compile(
    rf"\s*([\w.]+)\s*\(\s*({'|'.join(_QUALIFIERS)})\s*(?:,\s*([^,();]+?)\s*)?\)\s*;", re.IGNORECASE
)
_CALL = re.compile(r"([\w.]+)\(\);")
"""Call of an action: of the POU, or of an instance, which has no methods in CoDeSys 2.3."""
_STEP_PRAGMAS = {"SFCMAXTIME": "max_time", "SFCMINTIME": "min_time", "SFCCOMMENT": "comment"}
_STEP_PRAGMA = re.compile(r"\s*(\(\*[ \t]*@(SFC\w+)[ \t]*:=[ \t]*(?:'((?:[^*]|\*(?!\)))*?)'|[^*\n]*?)[ \t]*\*\))")
"""A pragma behind a step; the third group is its text, which is missing where a quote is."""
_FIRST_WORD = re.compile(r"(?:\w+\s*:\s*)?(\w+)")
_MARKED = re.compile(r"\s*_[A-Z]+_BODY\b")


def is_chart(text: str, span: Span) -> bool:
    """True if the body in `span` is a chart."""
    start = after_comments(text, *span)
    if _FIRST_WORD_OF_CHART.match(text, start, span[1]) is None:  # no look at the comments of a program
        return False
    return _ELEMENT.match(without_comments(text, (start, span[1])), start, span[1]) is not None


def read_text_body(text: str, span: Span) -> sfc.Body | None:
    """Return the body in `span`, which is no chart: in a language by its marker, or instructions, or statements."""
    content = plain_lines(text[span[0] : span[1]])
    if not content:
        return None
    if _MARKED.match(content):
        return OpaqueBody(source=SOURCE, content=content)
    first = _FIRST_WORD.match(content, after_comments(content, 0, len(content)))
    # a look at the first word: most bodies are in ST, and to find the tokens of all costs as much as reading the rest
    may_be_il = first is not None and first[1].upper() in OPERATORS
    if may_be_il and is_il(tokenize(content, Dialect.CODESYS).tokens):
        return IlBody(text=content)
    return StBody(text=content)


_MANY = 20


def body_problems(body: sfc.Body | None, text: str, span: Span) -> Iterator[tuple[str, int]]:
    """Yield the faults of syntax in a body that was read from `span` of `text`, each with its offset in `text`."""
    match body:
        case StBody(text=content):
            problems: Sequence[Problem] = statement_problems(content, Dialect.CODESYS)
        case IlBody(text=content):
            problems = instruction_problems(content, Dialect.CODESYS)
        case _:
            return
    has_pairs = "\r\n" in text[span[0] : span[1]]
    for problem in problems[:_MANY]:
        offset = problem.span[0]
        yield problem.message, span[0] + offset + (content[:offset].count("\n") if has_pairs else 0)


def called_alone(text: str, span: Span) -> str:
    """Return the action that the text in `span` calls and nothing else; empty where it does something else."""
    found = _CALL.fullmatch(text, *span)
    return found[1] if found is not None else ""


def body_text(body: sfc.Body | None) -> str:
    """Return the text of a body: drawn ones as structured text, none where there is no text for it."""
    match body:
        case StBody(text=text) | IlBody(text=text):
            return text
        case FbdBody() | LdBody():
            return shown_body(body, Dialect.CODESYS) or ""
        case OpaqueBody(source=source, content=content) if source == SOURCE:
            return content
        case _:
            return ""


# -- reading


@dataclass(slots=True)
class ReadChart:
    """Chart that was read: its body, and the places of its parts."""

    body: sfc.SfcBody
    places: list[Place] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class PouNames:
    """Names in a POU, in lower case, that tell step actions, and associations from calls.

    `booleans` are its variables of type BOOL, and the global ones. `stand_ins` are actions that do nothing but to call
    another, with the name of that; steps put those into `replaced` that they have as entry or exit action.
    """

    actions: frozenset[str]
    variables: frozenset[str]
    booleans: frozenset[str]
    stand_ins: Mapping[str, str]
    replaced: set[str] = field(default_factory=set)

    def are_associated(self, target: str, qualifier: str) -> bool:
        """True if ``target(qualifier);`` is an association, and no call of a function with a variable."""
        name = target.casefold()
        executed = "." in name or name in self.actions or name in self.booleans
        return executed or qualifier.casefold() not in self.variables


def read_chart(text: str, span: Span, names: PouNames, note: Note) -> ReadChart:
    """Read the chart in `span`."""
    return _ChartReader(text, span, names, note).run()


class _ChartReader:
    def __init__(self, text: str, span: Span, names: PouNames, note: Note) -> None:
        self.text = text
        self.span = span
        self.headers = without_comments(text, span)
        self.in_headers: list[Span] = []
        self.names = names
        self.note = note
        self.chart = sfc.SfcNetwork()
        self.found = ReadChart(sfc.SfcBody(chart=self.chart))
        self.ends: list[tuple[sfc.Transition, tuple[list[str], list[str]], int]] = []
        self.starts: list[int] = []
        self.next_id = 1

    def run(self) -> ReadChart:
        position, limit = self.span
        comments: list[Span] = []
        while True:
            solid = after_comments(self.text, position, limit)
            if self.text[position:solid].strip():
                start = position + len(self.text[position:solid]) - len(self.text[position:solid].lstrip())
                span = (start, start + len(self.text[start:solid].rstrip()))
                if open_comment(self.text, *span) is None:  # else the file was cut off in it
                    comments.append(span)
            if solid >= limit:
                break
            element = _ELEMENT.match(self.headers, solid, limit)
            following = self._next_element(element.end() if element is not None else solid + 1)
            if element is None:
                self.note("EXP104", "this belongs to no step and to no transition", solid)
                position = following
            elif element[1]:
                position = self._step(element, following)
            else:
                position = self._transition(solid, element.end(), following)
        self._connect()
        if every := [*comments, *self.in_headers]:
            self.found.body.comment = "\n".join(plain_lines(self.text[start:end]) for start, end in every)
            place = comments[0] if comments else (self.span[0], self.span[0])
            self.found.places.append((("comments", ""), place, ()))
        return self.found

    def _next_element(self, position: int) -> int:
        for found in _NEXT_ELEMENT.finditer(self.text, position, self.span[1]):
            is_element = _ELEMENT.match(self.headers, found.start(), self.span[1]) is not None
            if is_element and not is_in_comment(self.text, position, found.start()):
                return found.start()
        return self.span[1]

    def _keep_comments(self, start: int, end: int) -> None:
        """Keep the comments in the header of an element."""
        while True:
            start = next((at for at in range(start, end) if self.text[at] != self.headers[at]), end)
            if start == end:
                return
            behind = after_comments(self.text, start, end)
            behind = start + len(self.text[start:behind].rstrip())
            self.in_headers.append((start, behind))
            start = behind

    def _number(self) -> int:
        self.next_id += 1
        return self.next_id - 1

    def _end(self, start: int, limit: int, word: str, what: str, opener: int) -> Span:
        end = find_end(self.text, start, limit, word)
        if end is None:
            self.note("EXP102", f"{word} of {what} is missing", opener)
            stop = core(self.text, (start, limit))[1]
            return (stop, stop)
        return end

    def _step(self, element: re.Match[str], following: int) -> int:
        name = element[2]
        step = sfc.Step(id=self._number(), name=name, initial=element[1].upper() == "INITIAL_STEP")
        start = element.start(1)
        self._keep_comments(start, element.end())
        end = self._end(element.end(), following, "END_STEP", f"the step {name}", start)
        places: list[Place] = [(("head", ""), (start, element.end()), ())]
        inside = core(self.text, (element.end(), end[0]))
        associations = self._associations(inside)
        if associations:
            step.actions = associations
            places.append((("associations", ""), inside, ()))
        elif inside[0] < inside[1]:
            called = called_alone(self.text, inside)
            if "." in called or called.casefold() in self.names.actions:
                step.main_action = called
            else:
                step.main_action = read_text_body(self.text, inside)
                self._check(step.main_action, inside)
            places.append((("body", ""), inside, ()))
        places.append((("end", ""), end, ()))
        position = end[1]
        others: list[str] = []
        given: dict[str, str] = {}
        while (pragma := _STEP_PRAGMA.match(self.text, position, following)) is not None:
            place, value = _STEP_PRAGMAS.get(pragma[2].upper()), plain_lines(pragma[3] or "")
            if pragma[3] is None:
                self.note("EXP108", f"{pragma[2]} of the step {name} has no text in quotes", pragma.start(1))
            elif place is None:
                others.append(pragma[1])
            elif value:
                given[place] = value
            places.append((("pragma", pragma[2].upper()), pragma.span(1), ()))
            position = pragma.end(1)
        step = step.model_copy(update=given)  # no assignment validates: times in files may be invalid
        step.extension_data = keep({"pragmas": "\n".join(others)} if others else {})
        for attribute, ending in STEP_ACTION_ENDINGS.items():
            own = f"{name}{ending}"
            if own.casefold() in self.names.stand_ins:
                self.names.replaced.add(own.casefold())
                setattr(step, attribute, self.names.stand_ins[own.casefold()])
            elif own.casefold() in self.names.actions:
                setattr(step, attribute, own)
        self.chart.steps.append(step)
        self.starts.append(start)
        key: Key = ("step", name)
        self.found.places.append((key, (start, position), block_span(key, (start, position), places).spans))
        return position

    def _check(self, body: sfc.Body | None, inside: Span) -> None:
        for message, offset in body_problems(body, self.text, inside):
            self.note("EXP110", message, offset)

    def _associations(self, inside: Span) -> list[sfc.ActionAssociation]:
        """Return the associations that a step consists of; empty where it has an action in place."""
        found: list[sfc.ActionAssociation] = []
        position, first = inside[0], self.next_id
        while position < inside[1]:
            one = _ASSOCIATION.match(self.text, position, inside[1])
            if one is None or not self.names.are_associated(one[1], one[2]):
                self.next_id = first
                return []
            qualifier = _QUALIFIERS[one[2].upper()]
            found.append(sfc.ActionAssociation(id=self._number(), qualifier=qualifier, target=one[1], duration=one[3]))
            position = one.end()
        return found

    def _transition(self, start: int, behind: int, following: int) -> int:
        header = _TRANSITION.match(self.headers, start, following)
        end = self._end(header.end() if header else behind, following, "END_TRANSITION", "this transition", start)
        if header is None:
            message = "a transition is TRANSITION FROM steps TO steps := condition END_TRANSITION"
            self.note("EXP103", message, start)
            return end[1]
        self._keep_comments(start, header.end())
        transition = sfc.Transition(id=self._number(), name=header[1] or "")
        transition.priority = whole_number(header[2])
        inside = _condition_core(self.text, (header.end(), end[0]))
        transition.condition = _read_condition(self.text, inside)
        if isinstance(transition.condition, sfc.BodyCondition):
            self._check(transition.condition.body, inside)
        sides = (re.findall(r"\w+", header[3]), re.findall(r"\w+", header[4]))
        self.ends.append((transition, sides, start))
        self.chart.transitions.append(transition)
        key = _transition_key(*sides)
        places: list[Place] = [(("head", ""), (start, header.end()), ()), (("end", ""), end, ())]
        if transition.condition is not None:
            places.insert(1, (("body", ""), inside, ()))
        self.found.places.append((key, (start, end[1]), block_span(key, (start, end[1]), places).spans))
        return end[1]

    def _connect(self) -> None:
        known = {step.name.casefold(): step.id for step in reversed(self.chart.steps)}
        for place, step in zip(self.starts, self.chart.steps, strict=True):
            if known[step.name.casefold()] != step.id:
                self.note("EXP106", f"another step of this chart is called {step.name} too", place)
        for transition, (sources, targets), start in self.ends:
            for name in dict.fromkeys((*sources, *targets)):
                if name.casefold() not in known:
                    self.note("EXP105", f"no step of this chart is called {name}", start)
            transition.sources = [known[name.casefold()] for name in sources if name.casefold() in known]
            transition.targets = [known[name.casefold()] for name in targets if name.casefold() in known]
            missing = {
                side: ",".join("" if name.casefold() in known else name for name in names)
                for side, names in (("sources", sources), ("targets", targets))
            }
            missing = {side: names for side, names in missing.items() if names.strip(",")}
            if missing:
                transition.extension_data = keep(missing)


def _condition_core(text: str, span: Span) -> Span:
    start, end = core(text, span)
    while start < end and text[start] in " \t":
        start += 1
    if text[start:end].endswith(";") and not parse_expression(text[start : end - 1], Dialect.CODESYS).problems:
        end -= 1
    return start, end


def _read_condition(text: str, span: Span) -> sfc.Condition | None:
    content = plain_lines(text[span[0] : span[1]])
    # before instructions, of which some are expressions too: NOT Full
    if content and not _MARKED.match(content) and not parse_expression(content, Dialect.CODESYS).problems:
        return Expression(text=content)
    body = read_text_body(text, span)
    return sfc.BodyCondition(body=body) if body is not None else None


# -- writing


class ChartNames:
    """Names in a POU that its charts are written with, and the actions that are `added` for what has no other place."""

    def __init__(self, pou: Pou, report: ConversionReport) -> None:
        self._pou, self.objects = pou, pou.transitions
        self.added: list[Action] = []
        self._report = report
        self._used = {action.name.casefold() for action in pou.actions}

    def action(self, wish: str, content: str | sfc.Body | None, path: str) -> str:
        """Return the action with this content: the one that it names, or one that is added and called like `wish`."""
        if isinstance(content, str) and content.casefold() == wish.casefold():
            return content
        name = self.associated(wish, content)
        if name != wish:
            self._report.add(Outcome.NOT_EXECUTED, "step action", path, f"{wish} is another action of the POU")
        return name

    def associated(self, wish: str, content: str | sfc.Body | None) -> str:
        """Return the action that is added for an association, called like `wish` where no other one is."""
        name = take_name(wish, self._used)
        body = StBody(text=f"{content}();") if isinstance(content, str) else content
        self.added.append(Action(name=name, body=body))
        return name

    def note_order(self, chart: sfc.SfcNetwork, main_names: Mapping[int, str], path: str) -> None:
        """Report where main actions that are associations, `main_names`, make another order of a scan.

        CoDeSys 2.3 executes associations in the order of their names.
        """

        def moved(row: tuple[sfc.Step, sfc.ActionAssociation]) -> shared_scans.Place | None:
            step, association = row
            is_main = association.qualifier is Qualifier.N and all(association is not each for each in step.actions)
            return shared_scans.place_of_name(main_names[step.id]) if is_main and step.id in main_names else None

        for told in shared_scans.changed_places(chart, self._pou, Dialect.CODESYS, moved) if main_names else ():
            why = f"CoDeSys 2.3 executes the actions of a scan by their names: {told}"
            self._report.add(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, path, why)

    def check_other(self, name: str, path: str) -> None:
        """Report an action of the POU that a step executes by its name, though the source has none at this step."""
        if name.casefold() in self._used:
            why = "CoDeSys 2.3 executes an action of this name at the step: rename the action or the step"
            self._report.add(Outcome.NOT_EXECUTED, "action", f"{path} / action {name}", why)

    def leave_out(self, association: sfc.ActionAssociation, path: str) -> None:
        """Report an association that the text does not have."""
        why = f"CoDeSys 2.3 has no qualifier {association.qualifier}: it is not executed"
        self._report.add(Outcome.NOT_EXECUTED, "action", f"{path} / action {association.target or 'in place'}", why)

    def is_variable(self, association: sfc.ActionAssociation) -> bool:
        """True if an association drives a variable, and executes no action of the POU."""
        target = (association.target or "").casefold()
        return bool(target) and association.body is None and target not in self._used

    def note_pulse(self, association: sfc.ActionAssociation, path: str) -> None:
        """Report P1 with a variable, which P is too: they differ in the last execution of an action only."""
        place = f"{path} / action {association.target}"
        self._report.add(Outcome.TRANSLATED, "qualifier P1", place, "P, which is the same with a variable")

    def note_call(self, text: str, path: str) -> None:
        """Report a body in place that only calls an action of the POU: a step that has this action has this text."""
        if called_alone(text, core(text, (0, len(text)))).casefold() in self._used:
            why = "the main action, an action of the POU"
            self._report.add(Outcome.TRANSLATED, "action", f"{path} / action in place", why)

    def note(self, what: str, path: str, also: str = "") -> None:
        """Report something in a form that no export was seen to have."""
        why = f"{also}in a form that no known export shows; see it after the import"
        self._report.add(Outcome.TRANSLATED, what, path, why)

    def note_associations(self, count: int, path: str, *, initial: bool) -> None:
        """Report an IEC step, with so many associations."""
        self.note(
            "action associations", path, "an IEC step, for which the library Iecsfc.lib has to be in the project: "
        )
        if initial:
            why = "the initial step takes none, says a textbook: if it is refused, put a step with TRUE behind it"
            self._report.add(Outcome.TRANSLATED, "action associations", path, why)
        if count > _MOST_ASSOCIATIONS:
            why = f"CoDeSys 2.3 takes {_MOST_ASSOCIATIONS} associations at a step, and this one has {count}"
            self._report.add(Outcome.NOT_EXECUTED, "action associations", path, why)

    def missing(self, what: str, path: str) -> str:
        """Return a condition that does not compile: an empty one might be always true."""
        name = re.sub(r"\W+", "_", f"NOT_EXECUTED_{what}").strip("_")
        why = f"no text expresses it; the undeclared name {name} is in its place, so that the text does not compile"
        self._report.add(Outcome.NOT_EXECUTED, "condition", path, why, Cause(CauseKind.PLACEHOLDER, name))
        return name


def chart_blocks(body: sfc.SfcBody, names: ChartNames, path: str) -> Iterator[WrittenBlock]:
    """Yield the blocks of a chart: each step, and before it the transitions up to the one that leads to it."""
    chart = body.chart
    if plain(body.comment):
        yield WrittenBlock(("comments", ""), plain(body.comment), verbatim=True)
    waiting = [each for each in _in_order(chart) if all(_sides(chart, each))]
    labels = chart.labels()
    main_names = _main_names(chart)
    names.note_order(chart, main_names, path)
    written: set[int] = set()

    def transition_blocks(count: int) -> Iterator[WrittenBlock]:
        for transition in waiting[:count]:
            yield _transition_block(chart, transition, names, f"{path} / transition {labels[transition.id]}")
        del waiting[:count]

    for step in chart.steps:
        ready = takewhile(lambda each: written.issuperset(each[1].sources), enumerate(waiting, 1))
        yield from transition_blocks(next((count for count, each in ready if step.id in each.targets), 0))
        yield _step_block(step, names, f"{path} / step {step.name}", main_names.get(step.id, ""))
        written.add(step.id)
    yield from transition_blocks(len(waiting))


def _in_order(chart: sfc.SfcNetwork) -> list[sfc.Transition]:
    """Return the transitions with competing ones in the order in which they are tried, which is that of the text."""
    found = list(chart.transitions)
    for step in chart.steps:
        competing = chart.outgoing(step)
        places = sorted(index for index, each in enumerate(found) if any(each is other for other in competing))
        for place, transition in zip(places, competing, strict=True):
            found[place] = transition
    return found


def _main_names(chart: sfc.SfcNetwork) -> dict[int, str]:
    """Return the names of the main actions of steps with associations, by the ids of the steps.

    Those of bodies in place come before all others, in the order of the steps: CoDeSys 2.3 executes associated actions
    by their names.
    """
    steps = [step for step in chart.steps if step.actions and step.main_action is not None]
    found = {step.id: step.main_action for step in steps if isinstance(step.main_action, str)}
    names = {step.id: f"{step.name}_active" for step in steps if step.id not in found}
    others = {name.casefold() for step in chart.steps for name in (*_associated(step), found.get(step.id, "")) if name}
    in_order = [name.casefold() for name in names.values()]
    if in_order != sorted(in_order) or (names and min(others) <= in_order[-1]):
        width = len(str(len(names) - 1))
        names = {step: f"A{number:0{width}}_{name}" for number, (step, name) in enumerate(names.items())}
    return found | names


def _associated(step: sfc.Step) -> Iterator[str]:
    """Yield the names of the actions that a step is written with."""
    for number, each in enumerate(step.actions, 1):
        yield each.target or f"{step.name}_action{number}"


def _step_block(step: sfc.Step, names: ChartNames, path: str, main_name: str) -> WrittenBlock:
    """Return the block of a step; `main_name` is that of its main action if it has associations, too."""
    word = "INITIAL_STEP" if step.initial else "STEP"
    blocks = [WrittenBlock(("head", ""), f"{word} {step.name}:")]
    if associations := [*_associations(step, names, path, main_name)]:
        names.note_associations(len(associations), path, initial=step.initial)
        blocks.append(WrittenBlock(("associations", ""), "\n".join(associations)))
    elif text := f"{step.main_action}();" if isinstance(step.main_action, str) else body_text(step.main_action):
        if not isinstance(step.main_action, str):
            names.note_call(text, path)
        blocks.append(WrittenBlock(("body", ""), text, verbatim=True))
    for attribute, ending in STEP_ACTION_ENDINGS.items():
        content = getattr(step, attribute)
        if content is not None:
            names.note("step action", path)
            names.action(f"{step.name}{ending}", content, path)
        else:
            names.check_other(f"{step.name}{ending}", path)
    blocks.append(WrittenBlock(("end", ""), "END_STEP"))
    for pragma, field_name in _STEP_PRAGMAS.items():
        value = plain(getattr(step, field_name)) or ""
        blocks.append(WrittenBlock(("pragma", pragma), f"(* @{pragma} := '{_in_pragma(value)}' *)"))
    for other in kept(step.extension_data).get("pragmas", "").split("\n"):
        if (found := PRAGMA.match(other)) is not None:
            blocks.append(WrittenBlock(("pragma", found["name"].upper()), other))
    return WrittenBlock(("step", step.name), blocks=tuple(blocks))


def _associations(step: sfc.Step, names: ChartNames, path: str, main_name: str) -> Iterator[str]:
    """Yield the associations of a step, the last its main action if it has both."""
    for each, called in zip(step.actions, _associated(step), strict=True):
        if each.qualifier is Qualifier.P1 and names.is_variable(each):
            names.note_pulse(each, path)
            yield f"{each.target}(P);"
            continue
        if each.qualifier not in _QUALIFIERS.values() and each.qualifier is not Qualifier.NONE:
            names.leave_out(each, path)
            continue
        target = each.target or names.associated(called, each.body)
        qualifier = Qualifier.N if each.qualifier is Qualifier.NONE else each.qualifier
        yield f"{target}({qualifier}{f',{each.duration}' if each.duration else ''});"
    if main_name:
        main = step.main_action
        yield f"{main_name if main == main_name else names.associated(main_name, main)}(N);"


def _in_pragma(value: str) -> str:
    """Return a text without what begins or ends comments; apostrophes stay, as the text ends with the comment."""
    return re.sub(r"\(\*|\*\)", " ", value)


def _transition_block(chart: sfc.SfcNetwork, transition: sfc.Transition, names: ChartNames, path: str) -> WrittenBlock:
    sources, targets = _sides(chart, transition)
    name = f"{transition.name} " if re.fullmatch(r"[^\W\d]\w*", transition.name) else ""
    head = f"TRANSITION {name}FROM {_listed(sources)} TO {_listed(targets)}:= "
    blocks = [WrittenBlock(("head", ""), head)]
    if text := _condition_text(chart, transition, names, path):
        blocks.append(WrittenBlock(("body", ""), text, verbatim=isinstance(transition.condition, sfc.BodyCondition)))
    blocks.append(WrittenBlock(("end", ""), "END_TRANSITION"))
    return WrittenBlock(_transition_key(sources, targets), blocks=tuple(blocks))


def _sides(chart: sfc.SfcNetwork, transition: sfc.Transition) -> tuple[list[str], list[str]]:
    """Return the names of the steps before and behind a transition, also those that the chart does not have."""
    called = {step.id: step.name for step in chart.steps}
    missing = kept(transition.extension_data)

    def names(side: str, ids: list[int]) -> list[str]:
        found = [called[each] for each in ids if each in called]
        for place, name in enumerate(missing.get(side, "").split(",")):
            if name:
                found.insert(place, name)
        return found

    return names("sources", transition.sources), names("targets", transition.targets)


def _transition_key(sources: list[str], targets: list[str]) -> Key:
    return ("transition", f"{','.join(sources)} -> {','.join(targets)}")


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"({','.join(names)})"


def _condition_text(chart: sfc.SfcNetwork, transition: sfc.Transition, names: ChartNames, path: str) -> str:
    match transition.condition:
        case None:
            return ""
        case Expression(text=text, negated=negated):
            return f"NOT ({text})" if negated else text
        case sfc.BodyCondition(body=StBody() | IlBody() | OpaqueBody(source="codesys23") as body):
            return body_text(body)
        case _:
            found = shown_condition(chart, transition, Dialect.CODESYS, names.objects)
            if found is None or found[1]:
                return names.missing(chart.label(transition), path)
            return found[0]
