"""Marks by which the source comes back where something else is written instead of it.

A chart of another tool may hold what TC6 has no element for: an interlock, an event, a value. Where statements do the
same, they are written in place of it, and the element keeps the source in extension data, with a digest of what was
written. A reader puts the source back as long as the digest fits; after an edit the statements count.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from plcopen_sfc.formats.provenance import remember_replaced
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.chart_settings import FlagUse, GraphSettings, SfcFlag, SfcSettings
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.drawing import Drawing
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Configuration
from plcopen_sfc.model.sfc import ActionAssociation, BodyCondition, Condition, SfcNetwork, Step, Transition
from plcopen_sfc.model.variables import SectionKind, VariableSection, sections_of

if TYPE_CHECKING:
    from plcopen_sfc.formats.plcopen.tc6_reading import Fields

REWRITTEN_FIELD = "rewritten"
"""At a step or transition: the fields of the source, and the digest of what was written for them."""
OF_FLAGS, OF_ENDS, OF_BRANCHES = "flags", "ends", "branches"
"""In the mark of an added step or transition: it replaces SFC flags, ends of sequences, or branches that end apart."""
_OF_ALL_TOOLS = frozenset({OF_FLAGS, OF_ENDS, OF_BRANCHES})
"""Marks of what charts of other tools than TIA Portal have, too."""
DRAWING_FIELD = "source_drawing"
"""Field beside a chart with added steps or transitions: the drawing without them."""
ADDED_FIELD = "added"
"""At a block, action, transition object or list of variables that the source does not have: a digest of its content."""
TEXTS_FIELD = "texts"
"""At a body: texts of the source by their fields, each with the digest of what was written for it."""
NO_RESULT_FIELD = "no_result"
"""At an interface: the section by which a function of S7 has no result, and its place."""
SYSTEM_DATA_FIELD = "system_data"
"""At an interface: the variables that TIA Portal declares for a sequencer, with their sections and places there."""

RETAINED_FIELD = "retained"
"""At an interface: the sections of which TIA Portal retains some members, by their place and how many they became."""

TYPES_OF_S5_FIELD = "types_of_s5"
"""At an interface: the variables of types of S5, which are declared with others, with their sections and places."""

_M = TypeVar("_M", bound=Model)

SourceMarks = dict[int, dict[str, Any]]
"""Fields to keep at objects of a project, by their `id()`."""

STEP_FIELDS = ("actions", "entry_action", "main_action", "exit_action")
"""The fields of a step that are written otherwise than in the source."""


def rewritten_step(
    step: Step,
    source: Step,
    uses: Iterable[str] = (),
    permanent: Collection[str] = (),
    logic: Mapping[int, Node] | None = None,
) -> dict[str, Any]:
    """Return the mark of `step`, which is written in place of `source`.

    `uses`: the added actions that it executes, and the added variables in them. `permanent`: the fields of the chart
    with permanent instructions that it executes. `logic`: the elements drawn in the chart that its actions execute, by
    their places in the list of them.
    """
    fields = source.model_dump(mode="json", include=set(STEP_FIELDS), exclude_none=True)
    names = sorted({name.casefold() for name in uses})
    mark = {"source": fields, "digest": _of_step(step), "uses": names}
    return {REWRITTEN_FIELD: mark | ({"permanent": [*permanent]} if permanent else {}) | _of_logic(logic)}


def rewritten_transition(
    transition: Transition,
    source: Transition,
    uses: Iterable[str] = (),
    held: Iterable[tuple[int, str]] = (),
    logic: Mapping[int, Node] | None = None,
) -> dict[str, Any]:
    """Return the mark of `transition`, which is written in place of `source` and reads the added variables `uses`.

    `held`: the ids of steps and the fields of them that the condition executes, such as the minimum time. `logic`: the
    elements drawn in the chart that the condition is wired to, by their places in the list of them.
    """
    fields = source.model_dump(mode="json", include={"condition"}, exclude_none=True)
    names = sorted({name.casefold() for name in uses})
    mark = {"source": fields, "digest": _of_condition(transition.condition), "uses": names}
    return {REWRITTEN_FIELD: mark | {"held": [[*each] for each in held]} | _of_logic(logic)}


def _of_logic(logic: Mapping[int, Node] | None) -> dict[str, Any]:
    items = logic.items() if logic else ()
    drawn = [[at, node.model_dump(mode="json", exclude_defaults=True) | {"kind": node.kind}] for at, node in items]
    return {"logic": drawn} if drawn else {}


def added_element(
    added: Step | Transition,
    uses: Iterable[str],
    instead_of: Mapping[str, Any] | None = None,
    *,
    of: str = "",
) -> dict[str, Any]:
    """Return the mark of a step or transition that the source does not have; `uses` as in `rewritten_step`.

    `instead_of`: transitions and initial steps of the source that the chart lacks, as `replaced_sequences` gives them.
    `of`: what it replaces, other than operating inputs of S7-GRAPH: `OF_FLAGS` of CODESYS, `OF_ENDS` or
    `OF_BRANCHES`.
    """
    digest = _of_step(added) if isinstance(added, Step) else _of_condition(added.condition)
    names = sorted({name.casefold() for name in uses})
    mark: dict[str, Any] = {"source": {}, "digest": digest, "uses": names, "added": True}
    mark |= {of: True} if of else {}
    return {REWRITTEN_FIELD: mark | ({"instead_of": instead_of} if instead_of else {})}


def changed_element(
    added: Step | Transition, mark: Mapping[str, Any], uses: Iterable[str]
) -> dict[str, dict[str, Any]]:
    """Return the mark of a step or transition that was added, and has got actions or another condition since."""
    known = mark[REWRITTEN_FIELD]
    found: dict[str, Any] = added_element(added, [*known["uses"], *uses])[REWRITTEN_FIELD]
    return {REWRITTEN_FIELD: known | {"digest": found["digest"], "uses": found["uses"]}}


def replaced_sequences(source: SfcNetwork, written: SfcNetwork) -> dict[str, Any]:
    """Return the transitions of `source` that `written` lacks, with their places, and the initial steps."""
    left = {transition.id for transition in written.transitions}
    missing = [
        [at, each.model_dump(mode="json", exclude_none=True)]
        for at, each in enumerate(source.transitions)
        if each.id not in left
    ]
    return {"transitions": missing, "initial": [step.id for step in source.steps if step.initial]}


def _read_sequences(mark: Mapping[str, Any]) -> tuple[list[tuple[int, Transition]], set[int]]:
    """Return the transitions of the source in a mark, with their places, and the ids of the initial steps.

    Raises `ValueError` for a mark that is damaged.
    """
    found = mark["instead_of"]
    if not isinstance(found, dict) or not isinstance(found.get("transitions"), list):
        raise ValueError("the transitions of the source are damaged")
    transitions: list[tuple[int, Transition]] = []
    for each in found["transitions"]:
        if not isinstance(each, list) or len(each) != 2 or not isinstance(each[0], int):
            raise ValueError("a transition of the source is damaged")
        transitions.append((each[0], Transition.model_validate(each[1])))
    initial = found.get("initial")
    if not isinstance(initial, list) or not all(isinstance(number, int) for number in initial):
        raise ValueError("the initial steps of the source are damaged")
    return transitions, set(initial)


def _has_sequences(mark: Mapping[str, Any]) -> bool:
    """True if what a mark keeps of the sequences of the source can be read, or it keeps none."""
    try:
        return "instead_of" not in mark or bool(_read_sequences(mark))
    except ValueError:  # that of pydantic is one
        return False


def _put_sequences(chart: SfcNetwork, mark: Mapping[str, Any]) -> None:
    """Put the transitions and initial steps of the source back, in whose place others were written."""
    if "instead_of" not in mark:
        return
    transitions, initial = _read_sequences(mark)
    for at, transition in transitions:
        chart.transitions.insert(at, transition)
    for step in chart.steps:
        step.initial = step.id in initial


def added_part(body: StBody | IlBody) -> dict[str, Any]:
    """Return the mark of an action or transition object that the source does not have."""
    return {ADDED_FIELD: text_digest(body.text)}


def added_pou(pou: Pou) -> dict[str, Any]:
    """Return the mark of a block in structured text that the source does not have."""
    return {ADDED_FIELD: pou_digest(pou)}


def added_section(section: VariableSection) -> dict[str, Any]:
    """Return the mark of a list of variables that the source does not have."""
    return {ADDED_FIELD: _of_section(section)}


def source_mark(name: str, source: Fields, written: Fields) -> dict[str, Any]:
    """Return the mark of an element with the fields `source`, written as `written`; none where they are equal."""
    return {name: {"source": source, "digest": _of_fields(written)}} if source != written else {}


def marked_source(fields: Fields, name: str, written: Fields) -> Fields | None:
    """Return the fields in the source of an element that is `written` in the file: None without mark or after an edit.

    Takes the mark `name` out of the fields of the element.
    """
    found = fields.pop(name, None)
    source = found.get("source") if isinstance(found, dict) and found.get("digest") == _of_fields(written) else None
    return source if isinstance(source, dict) else None


def _of_fields(fields: Fields) -> str:
    return text_digest(json.dumps(fields, sort_keys=True))


def take_marks(chart: Fields) -> dict[int, dict[str, Any]]:
    """Take the marks out of a chart that is being read, by the ids of steps and transitions."""
    found: dict[int, dict[str, Any]] = {}
    for element in (*chart.get("steps", ()), *chart.get("transitions", ())):
        mark = element.pop(REWRITTEN_FIELD, None)
        if isinstance(mark, dict):
            found[element["id"]] = mark
    return found


def drawing_mark(drawing: Drawing) -> dict[str, Any]:
    """Return the mark of a chart that is drawn with more than its source has."""
    return {DRAWING_FIELD: drawing.model_dump(mode="json", exclude_defaults=True)}


def restore_chart(
    chart: SfcNetwork,
    marks: Mapping[int, dict[str, Any]],
    drawing: object,
    edited: Collection[str],
    warn: Callable[[str], None],
) -> set[str]:
    """Put the source back into the elements of `chart` that are as they were written.

    Returns the names, in lower case, of the added parts that the other elements execute.

    `drawing` is that of the source, which counts where nothing of the chart was edited. `edited`: added actions and
    transition objects that were changed since, by their names in lower case. `warn` is told of elements for which the
    source counts no more.
    """
    executed: set[str] = set()
    outdated = _outdated(chart, marks, edited)
    _put_logic(chart, [mark for number, mark in marks.items() if number not in outdated])
    added = {number for number, mark in marks.items() if mark.get("added") and number not in outdated}
    _take_out(chart, added)
    if any(marks[number].get(OF_BRANCHES) for number in added):
        remember_replaced(chart)
    for number in sorted(added):
        _put_sequences(chart, marks[number])
    if any(not (marks[number].keys() & _OF_ALL_TOOLS) for number in added) and chart.graph_settings is None:
        chart.graph_settings = GraphSettings()  # by which a writer adds them again
    if any(marks[number].get(OF_FLAGS) for number in outdated):
        # transitions obey an edge of SFCTip now, which would fire those that replace flags too
        stated = chart.settings.flags if chart.settings is not None else {}
        none = dict.fromkeys((SfcFlag.TIP, SfcFlag.TIP_MODE), FlagUse(use=False, declare=False))
        chart.settings = (chart.settings or SfcSettings()).model_copy(update={"flags": {**stated, **none}})
    if any(marks[number].get("added") and not marks[number].keys() & _OF_ALL_TOOLS for number in outdated):
        if chart.graph_settings not in (None, GraphSettings()):
            warn("the settings of the sequencer of S7-GRAPH")
        chart.graph_settings = None  # the replacement of its operating inputs counts now
    for step in chart.steps:
        mark = marks.get(step.id)
        if step.id in outdated:
            executed |= _uses(mark)
            _forget_permanent(chart, mark)
            warn(f"the actions of the step {step.name}")
        elif mark is not None:
            written = [row.id for row in step.actions]
            _put(step, mark, STEP_FIELDS)
            _draw_source(chart, _counterparts(written, [row.id for row in step.actions]))
    for transition in chart.transitions:
        mark = marks.get(transition.id)
        if transition.id in outdated:
            executed |= _uses(mark)
            _forget_held(chart, mark)
            warn(f"the condition of the transition {chart.label(transition)}")
        elif mark is not None:
            _put(transition, mark, ("condition",))
    if isinstance(drawing, dict) and not outdated:
        chart.drawing = Drawing.model_validate(drawing)
    return executed


def _outdated(chart: SfcNetwork, marks: Mapping[int, dict[str, Any]], edited: Collection[str]) -> set[int]:
    """Return the ids of the elements that are not as they were written, or execute something else that is not.

    Elements with an added variable in common stay together: what an edited condition reads, a step must go on writing.
    """
    written = {step.id: _of_step(step) for step in chart.steps if step.id in marks}
    written |= {each.id: _of_condition(each.condition) for each in chart.transitions if each.id in marks}
    found: set[int] = set()
    names = set(edited)
    while True:
        more = {
            number
            for number, digest in written.items()
            if number not in found
            and (
                not isinstance(marks[number].get("source"), dict)
                or marks[number].get("digest") != digest
                or not _has_sequences(marks[number])
                or not names.isdisjoint(_uses(marks[number]))
            )
        }
        if not more:
            return found
        found |= more
        names = names.union(*(_uses(marks[number]) for number in more))


def _take_out(chart: SfcNetwork, added: set[int]) -> None:
    """Take the added steps and transitions out of a chart; their symbols keep the ids for when they are added again."""
    if added:
        chart.steps = [step for step in chart.steps if step.id not in added]
        chart.transitions = [transition for transition in chart.transitions if transition.id not in added]
        for transition in chart.transitions:
            transition.targets = [target for target in transition.targets if target not in added]


def _forget_held(chart: SfcNetwork, mark: dict[str, Any] | None) -> None:
    """Take out what an edited condition executes of steps: it counts as it is now."""
    held = mark.get("held") if mark is not None else None
    for each in held if isinstance(held, list) else ():
        for step in chart.steps:
            if isinstance(each, list) and len(each) == 2 and each[0] == step.id and each[1] in _HELD_FIELDS:
                setattr(step, each[1], None)


def _forget_permanent(chart: SfcNetwork, mark: dict[str, Any] | None) -> None:
    """Take out the permanent instructions that the actions of an edited step execute."""
    permanent = mark.get("permanent") if mark is not None else None
    for name in ("permanent_pre", "permanent_post"):
        if isinstance(permanent, list) and name in permanent:
            setattr(chart, name, [])


_HELD_FIELDS = ("min_time", "supervision")


def _uses(mark: dict[str, Any] | None) -> set[str]:
    """Return the added parts that an element executes as it was written."""
    names = mark.get("uses") if mark is not None else None
    return set(names) if isinstance(names, list) else set()


def _counterparts(written: Sequence[int], source: Sequence[int]) -> dict[int, int]:
    """Return the row of the source for each written one: itself, or of those that were rewritten the next in order."""
    replacing = (row for row in written if row not in source)
    replaced = (row for row in source if row not in written)
    return dict(zip(replacing, replaced, strict=False))


def _draw_source(chart: SfcNetwork, rows: Mapping[int, int]) -> None:
    """Give written rows the drawing of the rows of the source."""
    for symbol in chart.drawing.symbols if chart.drawing is not None else ():
        for entry in symbol.entries or ():
            if entry.association in rows and rows[entry.association] != entry.association:
                entry.local_id = entry.association if entry.local_id is None else entry.local_id
                entry.association = rows[entry.association]


def _put(thing: Step | Transition, mark: dict[str, Any], names: Iterable[str]) -> None:
    source = type(thing).model_validate({**thing.model_dump(include={"id", "name"}), **mark["source"]})
    for name in names:
        setattr(thing, name, getattr(source, name))


def _put_logic(chart: SfcNetwork, marks: Iterable[dict[str, Any]]) -> None:
    """Draw logic of the source in the chart, under other ids where others have them in the file."""
    drawn: dict[int, Fields] = {}
    for mark in (mark for mark in marks if isinstance(mark.get("logic"), list)):
        drawn |= dict(mark["logic"])
    if not drawn:
        return
    symbols = chart.drawing.symbols if chart.drawing is not None else ()
    used = {each.id for each in (*chart.steps, *chart.transitions, *chart.logic, *symbols)}
    used |= {row.id for _, row in chart.associations()}
    renamed: dict[int, int] = {}
    for node in drawn.values():
        renamed[node["id"]] = node["id"] if node["id"] not in used else max(used) + 1
        used.add(renamed[node["id"]])
    nodes = [_with_ids(drawn[place], renamed) for place in sorted(drawn)]
    chart.logic += SfcNetwork.model_validate({"logic": nodes}).logic
    for mark in marks:
        mark["source"] = _with_ids(mark["source"], renamed)


def _with_ids(fields: Any, renamed: Mapping[int, int]) -> Any:
    """Return the fields of elements and wires with other ids of elements."""
    if isinstance(fields, list):
        return [_with_ids(each, renamed) for each in fields]
    if not isinstance(fields, dict):
        return fields
    ids = {key: renamed.get(fields[key], fields[key]) for key in ("id", "source") if isinstance(fields.get(key), int)}
    return {key: _with_ids(each, renamed) for key, each in fields.items()} | ids


def _fitting(kind: type[_M], fields: Fields) -> _M | None:
    """Return an object with these fields; None where they do not fit, which the reader of the whole tells later."""
    try:
        return kind.model_validate(fields)
    except ValidationError:
        return None


def added_parts(parts: list[Fields]) -> tuple[set[str], set[str]]:
    """Return the names, in lower case, of actions or transition objects that were added, and of those edited since.

    Takes their marks.
    """
    added: set[str] = set()
    edited: set[str] = set()
    for part in parts:
        mark = part.pop(ADDED_FIELD, None)
        body = part.get("body")
        if mark is None:
            continue
        name = str(part["name"]).casefold()
        fits = isinstance(body, dict) and mark == text_digest(str(body.get("text", "")))
        (added if fits else edited).add(name)
    return added, edited


def added_variables(section: Fields) -> set[str]:
    """Return the names, in lower case, of the variables of an added list that is as it was written; else nothing.

    Takes the mark of the list.
    """
    mark = section.pop(ADDED_FIELD, None)
    if mark is None or (written := _fitting(VariableSection, section)) is None or mark != _of_section(written):
        return set()
    return {str(variable["name"]).casefold() for variable in section["variables"]}


def sources_of_section(section: Fields) -> list[Fields] | None:
    """Return the source of an added list of variables that is as it was written; None for any other list.

    Takes the marks of the list.
    """
    mark, source = section.pop(ADDED_FIELD, None), section.pop("list", None)
    if mark is None or (written := _fitting(VariableSection, section)) is None or mark != _of_section(written):
        return None
    return [source] if isinstance(source, dict) else []


def restore_texts(fields: Fields) -> None:
    """Put the texts of the source back into an object that is being read. Takes the mark."""
    texts = fields.pop(TEXTS_FIELD, None)
    for name, kept in texts.items() if isinstance(texts, dict) else ():
        if isinstance(kept, list) and len(kept) == 2 and text_digest(str(fields.get(name, ""))) == kept[1]:
            fields[name] = kept[0]


def restore_no_result(interface: Fields) -> None:
    """Put the section of S7 back into an interface that is being read. Takes the mark."""
    mark = interface.pop(NO_RESULT_FIELD, None)
    if isinstance(mark, list) and len(mark) == 2 and isinstance(mark[0], int) and "return_type" not in interface:
        interface["sections"].insert(mark[0], mark[1])


def restore_system_data(interface: Fields) -> None:
    """Put the variables of a sequencer of S7 back into an interface that is being read. Takes the mark."""
    sections = interface["sections"]
    names = {str(variable["name"]).casefold() for section in sections for variable in section["variables"]}
    for number, place, variable in interface.pop(SYSTEM_DATA_FIELD, None) or ():
        if number < len(sections) and str(variable["name"]).casefold() not in names:
            sections[number]["variables"].insert(place, variable)


def restore_types_of_s5(interface: Fields) -> None:
    """Put variables with types of S5 back into an interface that is being read. Takes the mark."""
    written = interface.pop(TYPES_OF_S5_FIELD, None) or ()
    names = {str(variable["name"]).casefold() for _, _, variable in written}
    sections = interface["sections"]
    if len(names & {str(v["name"]).casefold() for section in sections for v in section["variables"]}) < len(names):
        return  # someone has changed them
    for section in sections:
        section["variables"] = [v for v in section["variables"] if str(v["name"]).casefold() not in names]
    for number, place, variable in written:
        sections[number]["variables"].insert(place, variable)
    if written and sections[-1]["kind"] == SectionKind.IN_OUT and not sections[-1]["variables"]:
        sections.pop()


def restore_retained(interface: Fields) -> None:
    """Join sections of an interface that is being read which hold the members of one in TIA Portal. Takes the mark."""
    sections = interface["sections"]
    for place, count in reversed(interface.pop(RETAINED_FIELD, None) or ()):
        parts = sections[place : place + count]
        if len(parts) == count and len({part["kind"] for part in parts}) == 1:
            joined = {**parts[0], "variables": [variable for part in parts for variable in part["variables"]]}
            joined.pop("retain", None)
            sections[place : place + count] = [joined]


def added_configuration(configuration: Configuration) -> dict[str, Any]:
    """Return the mark of a configuration that the source does not have."""
    return {ADDED_FIELD: list(_executed(configuration))}


def is_added_pou(pou: Fields) -> bool:
    """True if a block is as it was added. Takes its mark."""
    added = pou.pop(ADDED_FIELD, None)
    read = _fitting(Pou, pou) if added is not None else None
    return read is not None and added == pou_digest(read)


def is_added_configuration(configuration: Fields) -> bool:
    """True if a configuration is as it was added, and has nothing else but lists of variables. Takes its mark."""
    added = configuration.pop(ADDED_FIELD, None)
    if added is None or configuration["global_variables"] or configuration.get("access_variables"):
        return False
    written = _fitting(Configuration, configuration)
    return written is not None and added == list(_executed(written))


def _executed(configuration: Configuration) -> Iterator[str]:
    """Yield the programs that resources execute, in a form for a mark."""
    for resource in configuration.resources:
        yield from (instance.name for instance in resource.instances)
        for task in resource.tasks:
            settings = task.settings
            kind = (settings.kind, settings.interval, settings.event) if settings is not None else ()
            words = (task.name, task.priority, task.interval, *kind, *(instance.name for instance in task.instances))
            yield " ".join(str(word) for word in words if word is not None)


def text_digest(text: str) -> str:
    """Return a short digest of a text; blanks at its ends and ends of lines do not matter."""
    # 48 bits: enough to tell an edit, and short beside the text of a small action.
    return hashlib.sha256("\n".join(text.split("\r\n")).strip().encode()).hexdigest()[:12]


def _of_step(step: Step) -> str:
    rows = [_of_row(row) for row in step.actions]
    actions = [_plain(action) for action in (step.entry_action, step.main_action, step.exit_action)]
    return text_digest(json.dumps([rows, actions]))


def _of_row(row: ActionAssociation) -> list[str | None]:
    parts = [row.qualifier.value, row.target, _plain(row.body), row.duration or None, row.indicator or None]
    return [*parts, "negated"] if row.negated else parts


def _plain(body: object) -> str | None:
    if isinstance(body, StBody | IlBody):
        return text_digest(body.text)
    return body if isinstance(body, str) or body is None else type(body).__name__


def _of_condition(condition: Condition | None) -> str:
    match condition:
        case Expression():
            text = condition.text
        case NamedCondition() | BodyCondition():
            text = condition.name
        case _:
            text = ""
    return text_digest(json.dumps([text, condition is not None and condition.negated]))


def _of_section(section: VariableSection) -> str:
    return text_digest(json.dumps(_plain_fields(section), sort_keys=True))


def pou_digest(pou: Pou) -> str:
    """Return a digest of a block in structured text: of its interface and its statements."""
    sections = [_plain_fields(section) for section in sections_of(pou.interface)]
    rest = [len(pou.actions), len(pou.transitions), len(pou.methods)]
    return text_digest(json.dumps([pou.name, pou.kind, sections, [*map(_plain, pou.bodies)], rest], sort_keys=True))


def _plain_fields(thing: Model) -> Any:
    return thing.model_dump(mode="json", exclude_defaults=True, exclude={"comment", "extension_data", "object_id"})
