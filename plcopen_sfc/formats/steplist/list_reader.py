"""Tables of a step list to a project. `list_writer` is the way back."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, StructureError, nearest
from plcopen_sfc.formats.format_interface import ReadResult
from plcopen_sfc.formats.steplist.list_tables import (
    COLUMNS,
    ListTable,
    Sheet,
    TableKind,
    TableRow,
    cell_name,
    tables_in,
    unread_rows,
)
from plcopen_sfc.languages.declarations import read_declarations
from plcopen_sfc.languages.memory_addresses import INTERNATIONAL
from plcopen_sfc.languages.translation.literal_translation import translated_address
from plcopen_sfc.languages.translation.translation_context import PartText
from plcopen_sfc.model import times
from plcopen_sfc.model.actions import STEP_ACTIONS, ActionEvent, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcBody, SfcNetwork, Step, Supervised, Transition
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.whole_numbers import whole_number

KINDS = {"PROGRAM": PouKind.PROGRAM, "FUNCTION_BLOCK": PouKind.FUNCTION_BLOCK}
"""Words before the name of a program."""
SECTIONS = {
    "VAR": SectionKind.LOCAL,
    "VAR_TEMP": SectionKind.TEMP,
    "VAR_INPUT": SectionKind.INPUT,
    "VAR_OUTPUT": SectionKind.OUTPUT,
    "VAR_IN_OUT": SectionKind.IN_OUT,
    "VAR_EXTERNAL": SectionKind.EXTERNAL,
    "VAR_GLOBAL": SectionKind.GLOBAL,
}
"""Words in the column Section."""
MEMORY = ("constant", "retain", "persistent")
"""Words behind them: ``VAR RETAIN``."""
"""Words in the column Qualifier for the step actions of CODESYS."""
NOWHERE = "(end)"
"""Text in the column Next: no step follows."""
DEFAULT_PROGRAM = "Main"

_TIME_FIELDS = {"Min time": "min_time", "Max time": "max_time", "Warning time": "warning_time"}
_TRUE = {"x", "X", "1", "TRUE", "True", "true", "yes", "ja", "wahr", "WAHR"}
_FALSE = {"", "0", "FALSE", "False", "false", "no", "nein", "FALSCH"}
_MARKS = ("Initial", "Interlocked")
_TRANSITION = ("Transition", "Condition", "Next", "Priority", "Simultaneous", "Transition comment")
_OF_TRANSITIONS = {
    "Transition": "name",
    "Condition": "condition",
    "Priority": "priority",
    "Transition comment": "comment",
}
_OF_STEPS = ("Number", "Initial", "Comment", *_TIME_FIELDS, "Interlock", "Supervision")
_ACTION = ("Qualifier", "Action", "Time", "Event", "Interlocked")
_OF_ASSOCIATIONS = ("Time", "Event", "Interlocked")
_VARIABLE = re.compile(r"[^\s:;,]+")
_NAME = re.compile(r"\w+(?:\.\w+)*")
_ASSIGNED = re.compile(r"(?P<target>[\w.\[\]]+)\s*:=\s*(?P<value>[^;]+)")
_QUALIFIERS = {qualifier.value.upper(): qualifier for qualifier in Qualifier}
COUNTED = re.compile(r"%[IQM][WD]\d", re.IGNORECASE)
"""The begin of addresses whose numbers are those of bytes in S7, and of words or double words in IEC 61131-3."""


def read_list(sheets: Sequence[Sheet], file: str | None) -> ReadResult:
    """Read the tables in the sheets of a file. Raises `StructureError` where there are none."""
    tables = list(tables_in(sheets))
    if not tables:
        hint = "A step list has a row with the headings Step, Action, Condition, Next; see docs/formats/xlsx.md."
        where = Location(file, 1 if any(sheet.lines for sheet in sheets) else None)
        raise StructureError("no sheet has the headings of a step list", location=where, hint=hint)
    return _Reader(tables, sheets, file).run()


@dataclass
class _Leaving:
    """A transition whose steps are found when all steps are known."""

    transition: Transition
    given: dict[str, TableRow] = field(default_factory=dict)
    following: list[tuple[TableRow, str]] = field(default_factory=list)


@dataclass
class _Program:
    """A program while its rows are read."""

    pou: Pou
    chart: SfcNetwork
    ids: Iterator[int] = field(default_factory=lambda: count(1))
    leaving: list[_Leaving] = field(default_factory=list)
    groups: dict[str, _Leaving] = field(default_factory=dict)
    row: TableRow | None = None


class _Reader:
    def __init__(self, tables: Sequence[ListTable], sheets: Sequence[Sheet], file: str | None) -> None:
        self._tables = tables
        self._sheets = sheets
        self._file = file
        self._table = tables[0]
        self._sheet = sheets[0]
        self._project = Project()
        self._programs: dict[str, _Program] = {}
        self._found: list[Diagnostic] = []

    def run(self) -> ReadResult:
        # the steps first: the variables of an I/O list are of the programs in them
        order = {TableKind.STEPS: self._steps, TableKind.ACTIONS: self._actions, TableKind.VARIABLES: self._variables}
        for table in sorted(self._tables, key=lambda each: [*order].index(each.kind)):
            self._table, self._sheet = table, table.sheet
            order[table.kind]()
            for at, heading in table.unknown:
                known = [column.heading for column in COLUMNS[table.kind]]
                near = nearest(heading, known)
                self._note("LST110", f"the column {heading!r} is not read{near}", table.start, at, Severity.WARNING)
        for sheet in self._sheets:
            self._unread(sheet)
        return ReadResult(self._project, self._found)

    def _unread(self, sheet: Sheet) -> None:
        """Note the rows of a sheet that are outside of its tables."""
        self._sheet = sheet
        for row in unread_rows(sheet):
            if row.is_data:
                message = "this row is of no table, as an empty row above it ends the table: take the empty row out"
                self._note("LST112", message, row.place, row.column)
            else:
                message = "this row is of no table, and is not read"
                self._note("LST112", message, row.place, row.column, Severity.WARNING)

    # -- findings

    def _note(self, code: str, message: str, row: int, column: int, severity: Severity = Severity.ERROR) -> None:
        place = Location(self._file, self._line(row), column + 1, self._cell(row, column))
        self._found.append(Diagnostic(code, severity, message, place))

    def _line(self, row: int) -> int:
        lines = self._sheet.lines
        return lines[row] if lines else row + 1

    def _cell(self, row: int, column: int) -> str:
        name = self._sheet.name
        return f"{name}!{cell_name(row, column)}" if name else f"line {self._line(row)}, column {column + 1}"

    def _wrong(self, code: str, message: str, row: TableRow, heading: str) -> None:
        self._note(code, message, row.place, self._table.columns.get(heading, 0))

    def _refuse_cells(self, row: TableRow, headings: Sequence[str], why: str) -> None:
        """Note the cells of a row that are not read, as they have no meaning there."""
        for heading in headings:
            text = row[heading]
            if text and not (heading in _MARKS and text in _FALSE):
                severity = Severity.WARNING if heading == "Comment" else Severity.ERROR
                message = f"{heading} {text!r} is not read in this row: {why}"
                self._note("LST113", message, row.place, self._table.columns.get(heading, 0), severity)

    # -- steps

    def _program(self, row: TableRow, before: _Program | None) -> _Program:
        text = row["Program"]
        if not text and before is not None:
            return before
        word, _, name = text.rpartition(" ")
        kind = KINDS.get(word.strip().upper())
        if word and kind is None:
            self._wrong(
                "LST101", f"{text!r} is no program: write its name, or FUNCTION_BLOCK and its name", row, "Program"
            )
        name = name or DEFAULT_PROGRAM
        found = self._programs.get(name.casefold())
        if found is None:
            pou = Pou(name=name, kind=kind or PouKind.PROGRAM, bodies=[SfcBody()])
            self._project.pous.append(pou)
            found = self._programs[name.casefold()] = _Program(pou, pou.chart or SfcNetwork())
        return found

    def _steps(self) -> None:
        program: _Program | None = None
        step: Step | None = None
        started: list[_Program] = []
        for row in self._table.rows:
            other = self._program(row, program)
            if other is not program:
                program, step = other, None
                started.append(program)
            if row["Step"]:
                step = self._step(program, row)
            elif step is None:
                self._wrong(
                    "LST102", "this row is of no step: its column Step is empty, as in all rows above", row, "Step"
                )
                continue
            else:
                self._refuse_cells(row, _OF_STEPS, f"write it into the first row of the step {step.name}")
            if row.has_any(*_ACTION):
                self._action(program, step, row)
            if row.has_any(*_TRANSITION):
                self._transition(program, step, row)
        for each in started:
            self._connect(each)
            if each.chart.steps and not each.chart.initial_steps:
                each.chart.steps[0].initial = True

    def _step(self, program: _Program, row: TableRow) -> Step:
        name = row["Step"]
        steps = program.chart.steps
        if any(step.name.casefold() == name.casefold() for step in steps):
            self._wrong("LST103", f"{program.pou.name} has a step {name} already", row, "Step")
        step = Step(id=next(program.ids), name=name, number=self._number(row, "Number"))
        step.initial = self._is_marked(row, "Initial")
        step.comment = row.texts.get("Comment") or None
        for heading, attribute in _TIME_FIELDS.items():
            setattr(step, attribute, self._time(row, heading))
        for heading, attribute in (("Interlock", "interlock"), ("Supervision", "supervision")):
            if row[heading]:
                setattr(step, attribute, Supervised(condition=row[heading]))
        steps.append(step)
        return step

    def _action(self, program: _Program, step: Step, row: TableRow) -> None:
        text, word = row["Action"], row["Qualifier"]
        if word.casefold() in STEP_ACTIONS:
            done = text if _NAME.fullmatch(text) else StBody(text=text)
            setattr(step, f"{word.casefold()}_action", done)
            self._refuse_cells(row, _OF_ASSOCIATIONS, f"the {word.casefold()} action of a step has none")
            return
        association = ActionAssociation(id=next(program.ids))
        try:
            association.qualifier = _QUALIFIERS[word.upper()] if word else Qualifier.N
        except KeyError:
            near = nearest(word, [*_QUALIFIERS, *STEP_ACTIONS])
            self._wrong("LST104", f"{word!r} is no qualifier of actions{near}", row, "Qualifier")
        if row["Event"]:
            try:
                association.event = ActionEvent(row["Event"].upper())
            except ValueError:
                self._wrong("LST104", f"{row['Event']!r} is no event{nearest(row['Event'], ActionEvent)}", row, "Event")
        association.interlock = self._is_marked(row, "Interlocked")
        association.duration = self._time(row, "Time")
        if association.qualifier.needs_duration and not row["Time"]:
            self._wrong("LST105", f"the qualifier {association.qualifier} needs a time", row, "Time")
        assigned = _ASSIGNED.fullmatch(text)
        if assigned is not None:
            association.target, association.value = assigned["target"], assigned["value"].strip()
        elif text.endswith(";"):
            association.body = StBody(text=text)
        elif text:
            association.target = text
        else:
            self._wrong("LST106", "there is a qualifier or a time, and no action", row, "Action")
        step.actions.append(association)

    def _transition(self, program: _Program, step: Step, row: TableRow) -> None:
        group = row["Simultaneous"].casefold()
        known = program.groups.get(group) if group else None
        if known is None:
            known = _Leaving(Transition(id=next(program.ids)))
            program.leaving.append(known)
            if group:
                program.groups[group] = known
        self._give(known, row)
        if step.id not in known.transition.sources:
            known.transition.sources.append(step.id)
        known.following.append((row, step.name))

    def _give(self, known: _Leaving, row: TableRow) -> None:
        """Give a transition what a row tells of it; the rows of a simultaneous group are one transition."""
        for heading, field_name in _OF_TRANSITIONS.items():
            first = known.given.setdefault(heading, row) if row[heading] else row
            if first is not row and row[heading] != first[heading]:
                where = self._cell(first.place, self._table.columns[heading])
                message = f"rows of one simultaneous group are one transition: this differs from {where}"
                self._wrong("LST107", message, row, heading)
            elif row[heading]:
                plain = row.texts[heading] if heading == "Transition comment" else row[heading]
                value = self._number(row, heading) if heading == "Priority" else plain
                setattr(known.transition, field_name, value)

    def _connect(self, program: _Program) -> None:
        steps = program.chart.steps
        ids = {step.name.casefold(): step.id for step in reversed(steps)}
        by_number = {str(step.number): step.id for step in steps if step.number is not None}
        for leaving in program.leaving:
            targets = leaving.transition.targets
            texts = [(row, name) for row, name in leaving.following if row["Next"]]
            for row, _ in texts:
                for name in filter(None, map(str.strip, row["Next"].split(","))):
                    target = ids.get(name.casefold(), by_number.get(name))
                    if target is None and name != NOWHERE:
                        known = [step.name for step in steps]
                        self._wrong("LST108", f"there is no step {name}{nearest(name, known)}", row, "Next")
                    elif target is not None and target not in targets:
                        targets.append(target)
            if not texts:  # the step below
                row, name = leaving.following[-1]
                place = next(at for at, step in enumerate(steps) if step.name == name)
                if place + 1 < len(steps):
                    targets.append(steps[place + 1].id)
                else:
                    message = f"no step is below the last one: write the step that follows, or {NOWHERE}"
                    self._wrong("LST108", message, row, "Next")
            program.chart.transitions.append(leaving.transition)
        self._check_priorities(program)
        program.leaving.clear()

    def _check_priorities(self, program: _Program) -> None:
        """Note the transitions without a priority that compete with one that has one: they would be tried last."""
        numbered = {
            source for each in program.leaving if "Priority" in each.given for source in each.transition.sources
        }
        for each in program.leaving:
            sources = numbered.intersection(each.transition.sources) if "Priority" not in each.given else ()
            for step in (step for step in program.chart.steps if step.id in sources):
                message = f"a transition of {step.name} has a priority, and this one has none: each of a step has one"
                self._wrong("LST111", message, each.following[0][0], "Priority")
                break

    # -- other tables

    def _actions(self) -> None:
        program: _Program | None = None
        for row in self._table.rows:
            program = self._program(row, program or self._first())
            if not row["Action"]:
                self._wrong("LST106", "statements without the name of their action", row, "Action")
                continue
            if program.pou.find_action(row["Action"]) is not None:
                self._wrong("LST103", f"{program.pou.name} has an action {row['Action']} already", row, "Action")
            action = Action(name=row["Action"], body=StBody(text=row.texts.get("Statements", "")))
            action.comment = row.texts.get("Comment") or None
            program.pou.actions.append(action)

    def _first(self) -> _Program | None:
        return next(iter(self._programs.values()), None)

    def _variables(self) -> None:
        program: _Program | None = None
        rows = self._table.rows
        lists = {row["Program"].casefold() for row in rows if row["Section"].upper().startswith("VAR_GLOBAL")}
        lists -= {"", *self._programs}
        for row in rows:
            declared = self._variable(row)
            if declared is None:
                continue
            name = row["Program"].rpartition(" ")[2].casefold()
            if name in lists and row["Section"] and declared.kind is not SectionKind.GLOBAL:
                message = f"{row['Program']} is a list of global variables in other rows, which has no {row['Section']}"
                self._wrong("LST109", message, row, "Section")
                continue
            owner = self._programs.get(name)
            if declared.kind is SectionKind.GLOBAL and owner is None:
                declared.name = row["Program"] or None  # the name of a list of CODESYS
                sections = self._project.global_variables
            else:
                program = self._program(row, program or self._first())
                interface = program.pou.interface = program.pou.interface or Interface()
                sections = interface.sections
            known = {v.name.casefold() for each in sections if each.name == declared.name for v in each.variables}
            if row["Variable"].casefold() in known:
                self._wrong("LST103", f"the variable {row['Variable']} is declared already", row, "Variable")
            section = next((each for each in sections if _head(each) == _head(declared)), None)
            if section is None:
                sections.append(declared)
            else:
                section.variables += declared.variables

    def _variable(self, row: TableRow) -> VariableSection | None:
        """Return the variable of a row in a section of its own."""
        first, *memory = row["Section"].upper().split() or [""]
        kind = SECTIONS.get(first)
        if (first and kind is None) or any(word.casefold() not in MEMORY for word in memory):
            near = nearest(first, SECTIONS)
            self._wrong("LST109", f"{row['Section']!r} is no section of variables{near}", row, "Section")
            return None
        found = _address(row["Address"])
        if found.severity is Severity.ERROR:
            self._wrong("LST109", f"this address cannot be written for other tools: {found.reason}", row, "Address")
            return None
        address = found.text
        if kind is None:
            kind = SectionKind.GLOBAL if address else SectionKind.LOCAL
        at = f" AT {address}" if address else ""
        initial = f" := {row['Initial value']}" if row["Initial value"] else ""
        declared = read_declarations(f"VAR x{at} : {row['Type'] or 'BOOL'}{initial}; END_VAR")
        variables = [each for section in declared.sections for each in section.variables]
        if not _VARIABLE.fullmatch(row["Variable"]):
            self._wrong("LST109", f"{row['Variable']!r} is no name of a variable", row, "Variable")
            return None
        if declared.problems or len(variables) != 1:
            why = declared.problems[0].message if declared.problems else "a row declares one variable"
            heading = next((each for each in ("Type", "Address", "Initial value") if _is_odd(each, row)), "Type")
            self._wrong("LST109", f"this is no declaration: {why}", row, heading)
            return None
        variables[0].name = row["Variable"]
        variables[0].comment = row.texts.get("Comment") or None
        flags = {word: word.upper() in memory for word in MEMORY}
        return VariableSection(kind=kind, variables=variables, **flags)

    # -- cells

    def _number(self, row: TableRow, heading: str) -> int | None:
        if not row[heading]:
            return None
        number = whole_number(row[heading])
        if number is None:
            self._wrong("LST105", f"{row[heading]!r:.40} is no whole number of at most 18 digits", row, heading)
        return number

    def _is_marked(self, row: TableRow, heading: str) -> bool:
        if row[heading] not in _TRUE | _FALSE:
            self._wrong("LST105", f"{row[heading]!r} is neither x nor empty", row, heading)
        return row[heading] in _TRUE

    def _time(self, row: TableRow, heading: str) -> str | None:
        text = row[heading]
        if not text:
            return None
        compact = "T#" + text.replace(" ", "").replace(",", ".")
        if text[0].isdecimal() and not times.objection(compact):
            return compact
        why = times.objection(text)
        if why:
            self._wrong("LST105", f"{text!r}: {why}; a time has a unit, such as 2s or T#1m30s", row, heading)
        return None if why else text


def _head(section: VariableSection) -> tuple[object, ...]:
    return section.kind, section.name, *(getattr(section, word) for word in MEMORY)


def _address(text: str) -> PartText:
    """Return an address as IEC 61131-3 has it.

    Without ``%`` it is one of S7, which counts bytes: ``E0.0`` is ``%I0.0``, ``EW4`` is ``%IW2``.
    """
    if not text or text.startswith("%"):
        return PartText(text)
    address = "%" + INTERNATIONAL.get(text[0].upper(), text[0].upper()) + text[1:].upper()
    return translated_address(address, Dialect.SCL, Dialect.IEC) if COUNTED.match(address) else PartText(address)


def _is_odd(heading: str, row: TableRow) -> bool:
    """True if this cell alone makes a declaration wrong."""
    kind = row["Type"] or "BOOL" if heading != "Address" else "BOOL"
    at = f" AT {_address(row['Address']).text}" if heading == "Address" and row["Address"] else ""
    initial = f" := {row['Initial value']}" if heading == "Initial value" and row["Initial value"] else ""
    return bool(read_declarations(f"VAR x{at} : {kind}{initial}; END_VAR").problems)
