"""Reads ``Graph``, the program of an S7-GRAPH block, into a chart. The writer is `graph_writer`."""

from __future__ import annotations

import copy
from contextlib import suppress

from lxml import etree

from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD
from plcopen_sfc.formats.simaticml.added_elements import AddedMark, is_added, mark_of
from plcopen_sfc.formats.simaticml.element_reader import (
    ASSOCIATION,
    TRUTHS,
    DocumentReading,
    Fields,
    NotUnderstoodError,
    child_named,
    children,
    comment_fields,
    keep_attribute,
    keep_element,
    local,
    merge_fields,
    read_comment,
    read_comments,
    read_languages,
)
from plcopen_sfc.formats.simaticml.lad_fbd_networks import read_flgnet_body
from plcopen_sfc.formats.simaticml.replaced_elements import (
    WRITTEN,
    chart_digest,
    condition_digest,
    edited_fields,
    forget_edited_exclusions,
    forget_edited_times,
    is_calling,
    warn_of_edit,
)
from plcopen_sfc.formats.simaticml.row_tokens import read_action
from plcopen_sfc.formats.simaticml.sequence_rules import ElementRef
from plcopen_sfc.formats.simaticml.sequence_topology import TopologyReader, added_in, usual_order
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.whole_numbers import canonical_number

_SUPERVISIONS = [("AlarmSupervisionCategory", number, 0, None) for number in range(1, 9)]
_FIRST = ("AlarmInterlockCategory", "AlarmWarningCategory")
_CATEGORIES = {
    "AlarmInterlockCategory": 1,
    "AlarmSubcategory1Interlock": 0,
    "AlarmSubcategory2Interlock": 0,
    "AlarmCategorySupervision": 1,
    "AlarmSubcategory1Supervision": 0,
    "AlarmSubcategory2Supervision": 0,
    "AlarmWarningCategory": 2,
    "AlarmSubcategory1Warning": 0,
    "AlarmSubcategory2Warning": 0,
}
USUAL_CATEGORIES = (
    [*_SUPERVISIONS, *((name, number, None, None) for name, number in _CATEGORIES.items() if name in _FIRST)],
    [*_SUPERVISIONS, *((name, number, None, None) for name, number in _CATEGORIES.items())],
)
"""Alarm categories (name, id, display class, text) that TIA Portal writes: up to Graph v2, and from v4 on."""
ALL_CATEGORIES = 4
"""Number of the schema of GRAPH that has all of them."""
CONTROLLED = "controls"
"""Field in our comments that names the action which an added permanent instruction controls."""
CONNECTIONS = "Connections"
"""Extension attribute of a sequence: the order of its connections, where it is not the one that our writer gives."""


def read_graph(ctx: DocumentReading, element: etree._Element, late: Fields) -> Fields:
    """Read ``Graph``. `late`: what the attributes of the block tell about its chart."""
    return _ChartReader(ctx).read(element, late)


class _ChartReader:
    def __init__(self, ctx: DocumentReading) -> None:
        self.ctx = ctx
        self._last = 0
        self.chart: Fields = {"steps": [], "transitions": [], "sequences": [], "permanent_pre": []}
        self.chart["permanent_post"] = []
        self.topology = TopologyReader(ctx, self.new_id)
        self._connections: list[tuple[Fields, etree._Element]] = []
        self._named: list[tuple[str, str, etree._Element]] = []
        self._networks: dict[int, Fields] = {}
        """Conditions of the networks, for the transitions whose source is kept instead."""
        self._sourced: set[int] = set()
        """Transitions with a condition in a comment of this package, valid or outdated."""
        self._excluded: dict[int, Fields] = {}
        """Steps that a comment of this package excludes, as the file has them."""
        self._unwritten: set[int] = set()
        """Actions that only comments of this package hold."""
        self._edited: list[int] = []
        """Steps whose rows were edited."""
        self._controlled: set[str] = set()
        """Actions of which the networks count that control them, and not what comments keep of their associations."""
        self._elements: dict[int, etree._Element] = {}
        """Elements of the steps of which comments keep something."""

    def new_id(self) -> int:
        """Return the next id."""
        self._last += 1
        return self._last

    def read(self, element: etree._Element, late: Fields) -> Fields:
        """Read the whole block."""
        chart = self.chart
        self._root = element
        categories: list[Fields] = []
        for child in children(element):
            kind = local(child)
            if kind == "PreOperations":
                chart["permanent_pre"] = self._operations(child)
            elif kind == "PostOperations":
                chart["permanent_post"] = self._operations(child)
            elif kind == "Sequence":
                self._sequence(child)
            elif kind == "AlarmsSettings":
                categories = _categories(chart, child)
            else:
                keep_element(chart, child)
        _keep_attributes(chart, element)
        self._structure()
        # after all connections: a condition that counts ends the minimum times of the steps that its transition leaves
        self._forget_controlled()
        self._forget_edited()
        self._check_names()
        read_comments(self.ctx, element, chart)
        settings = dict(late.get("graph_settings", {}))
        if [tuple(category.values()) for category in categories] not in USUAL_CATEGORIES:
            settings["alarm_categories"] = categories
        source, written = chart.pop(SOURCE_CHART_FIELD, None), chart.pop(WRITTEN, None)
        if isinstance(source, dict):
            if written == chart_digest(element) and not is_calling(element, self.ctx.edited_copies):
                return {**source, "graph_settings": settings or None}
            warn_of_edit(self.ctx, "the chart", element)
        return {**chart, **late, "graph_settings": settings or None}

    def _forget_edited(self) -> None:
        """Forget the fields that comments keep of steps that were edited, or whose transitions were."""
        found = forget_edited_exclusions(self.chart, self._excluded, self._networks, self._sourced, self._edited)
        kept = [("exclusion of the step", number) for number in found]
        there = {row["id"] for step in self.chart["steps"] for row in step["actions"]}
        for symbol in self.chart.get("drawing", {}).get("symbols", ()):
            if "entries" in symbol:
                symbol["entries"] = [entry for entry in symbol["entries"] if entry["association"] in there]
        found = forget_edited_times(self.chart, self._networks, self._sourced)
        for what, number in (*kept, *(("minimum time", number) for number in found)):
            element = self._elements[number]
            self.ctx.place.append(f"step {element.get('Name', '')}")
            warn_of_edit(self.ctx, f"the {what}", element)
            self.ctx.place.pop()

    def _forget_controlled(self) -> None:
        """Forget the associations of actions whose control was edited in this file."""
        for step in self.chart["steps"] if self._controlled else ():
            step["actions"] = [
                row
                for row in step["actions"]
                if row["id"] not in self._unwritten
                or control_label(step["name"], row.get("target")) not in self._controlled
            ]
        for name in sorted(self._controlled):
            warn_of_edit(self.ctx, f"the action {name}", self._root)

    def _check_names(self) -> None:
        """Steps and transitions are members of the block: no two members have the same name."""
        taken: dict[str, str] = {}
        for kind, name, element in self._named:
            key = name.casefold()
            type_name = self.ctx.types.get(f"#{key}")
            if key in taken:
                self.ctx.error("SFC109", f"a {taken[key]} has the name {name!r} of a {kind} already", element)
            elif type_name is not None and not type_name.startswith(_OWN_TYPES):
                self.ctx.error("SFC114", f"a variable of the block has the name {name!r} of a {kind} too", element)
            taken.setdefault(key, kind)

    def _structure(self) -> None:
        """Read the connections of steps and transitions, when all of these are known."""
        try:
            for sequence, element in self._connections:
                refs = list(self.topology.found.symbols)
                links = self.topology.connections(element)
                if links != usual_order(links, refs):
                    keep_attribute(sequence, CONNECTIONS, " ".join(map(str, links)))
            self.topology.finish(self.chart)
        except NotUnderstoodError as error:
            self.ctx.error("SFC102", f"the connections of the chart are kept but not understood: {error}", element)
            self.chart.pop("drawing", None)
            for sequence, connections in self._connections:
                keep_element(sequence, connections)
                parent = connections.getparent()
                for child in parent if parent is not None else ():
                    if local(child) == "Branches":
                        keep_element(sequence, child)

    def _operations(self, element: etree._Element) -> list[Fields]:
        found: list[Fields] = []
        shell = _shell(element)
        _keep_attributes(self.chart, element)
        for child in children(element):
            if local(child) != "PermanentOperation":
                shell.append(copy.deepcopy(child))
                continue
            if self.ctx.trusting and not self.ctx.edited_controls and is_added(child):
                continue
            fields: Fields = {"body": read_flgnet_body(self.ctx, child)}
            _keep_attributes(fields, child, "ProgrammingLanguage")
            for part in children(child):
                if not _text(fields, part, "Title", "title") and not _is_network(child, part):
                    keep_element(fields, part)
            read_comments(self.ctx, child, fields)
            controlled = fields.pop(CONTROLLED, None)
            if isinstance(controlled, str):
                self._controlled.add(controlled)
            found.append(fields)
        _keep_shell(self.chart, shell)
        return found

    def _sequence(self, element: etree._Element) -> None:
        sequence: Fields = {"steps": []}
        self.chart["sequences"].append(sequence)
        self.topology.added |= added_in(element)
        _keep_attributes(sequence, element)
        for child in children(element):
            kind = local(child)
            if kind in _LISTS:
                _keep_attributes(sequence, child)
            if kind == "Steps":
                for step in self._known(sequence, child, "Step"):
                    self._step(step, sequence)
            elif kind == "Transitions":
                for transition in self._known(sequence, child, "Transition"):
                    self._transition(transition)
            elif kind == "Branches":
                self._branches(sequence, child)
            elif kind == CONNECTIONS:
                self._connections.append((sequence, child))
            elif not _text(sequence, child, "Title", "title") and not _text(sequence, child, "Comment", "comment"):
                keep_element(sequence, child)
        read_comments(self.ctx, element, sequence)

    def _known(self, sequence: Fields, element: etree._Element, name: str) -> list[etree._Element]:
        """Return the children `name` without those that our writer added; any other child is kept."""
        shell = _shell(element)
        found: list[etree._Element] = []
        for child in children(element):
            if local(child) != name:
                shell.append(copy.deepcopy(child))
            elif not self._is_added(name[0], child):
                found.append(child)
        _keep_shell(sequence, shell)
        return found

    def _is_added(self, kind: str, element: etree._Element) -> bool:
        number = canonical_number(element.get("Number"))
        return number is not None and ElementRef(kind, number) in self.topology.added

    def _branches(self, sequence: Fields, element: etree._Element) -> None:
        for child in children(element):
            try:
                self.topology.branch(child)
            except NotUnderstoodError:
                self.ctx.error("SFC102", "a branch is damaged", child)
                keep_element(sequence, child)

    def _begin(self, kind: str, element: etree._Element) -> tuple[Fields, dict[str, str]]:
        """Begin a step or a transition: return its first fields, and its attributes besides those."""
        left = attributes(element)
        number = canonical_number(left.pop("Number", None))
        fields: Fields = {"id": self.new_id(), "name": left.pop("Name", ""), "number": number}
        self.ctx.place.append(f"{kind} {fields['name']}")
        self._named.append((kind, fields["name"], element))
        if left.get("IsMissing") == "false":
            del left["IsMissing"]
        return fields, left

    def _end(self, fields: Fields, kind: SymbolKind, element: etree._Element) -> None:
        """End a step or a transition, which branches and connections name by its number."""
        is_step = kind is SymbolKind.STEP
        if fields["number"] is None:
            message = "a step has no usable number" if is_step else "a transition has no usable number"
            self.ctx.error("SFC107", message, element)
        else:
            letter = "S" if is_step else "T"
            self.topology.add(ElementRef(letter, fields["number"]), kind, fields["id"], element)
        self.ctx.place.pop()

    def _step(self, element: etree._Element, sequence: Fields) -> None:
        fields, left = self._begin("step", element)
        fields["actions"] = []
        if left.get("Init", "false") in TRUTHS:
            fields["initial"] = TRUTHS[left.pop("Init", "false")]
        fields["max_time"] = left.pop("MaximumStepTime", None)
        fields["warning_time"] = left.pop("WarningTime", None)
        edited: list[str] = []
        for child in children(element):
            kind = local(child)
            if kind in ("Actions", "Supervisions", "Interlocks"):
                _keep_attributes(fields, child)
            if kind == "Actions":
                edited += self._actions(fields, child)
            elif kind in ("Supervisions", "Interlocks"):
                self._supervised(fields, child, kind[:-1])
            elif not _text(fields, child, "StepName", "title") and not _text(fields, child, "Comment", "comment"):
                keep_element(fields, child)
        for name, value in left.items():
            keep_attribute(fields, name, value)
        kept: Fields = {}
        read_comments(self.ctx, element, kept)
        if fields["max_time"] is not None:  # a comment has only times that are no literal: this was set since
            kept.pop("max_time", None)
        if edited and not kept.get("exclude"):
            warn_of_edit(self.ctx, "the actions", element)
        self._keep(fields, kept, element, edited)
        self.chart["steps"].append(fields)
        sequence["steps"].append(fields["id"])
        self._end(fields, SymbolKind.STEP, element)
        if fields["actions"]:
            self.topology.add_actions(fields["id"], [action["id"] for action in fields["actions"]])

    def _keep(self, fields: Fields, kept: Fields, element: etree._Element, edited: list[str]) -> None:
        """Put back the fields of a step that a comment keeps, but for the `edited` ones."""
        if not kept:
            return
        number = fields["id"]
        self._elements[number] = element
        if kept.get("exclude"):
            native = [row for row in fields["actions"] if row["id"] not in self._unwritten]
            self._excluded[number] = {**copy.deepcopy(fields), "actions": copy.deepcopy(native)}
            self._edited += [number] if edited else []
        merge_fields(fields, {name: value for name, value in kept.items() if name not in edited})

    def _actions(self, step: Fields, element: etree._Element) -> list[str]:
        """Read the rows of a step. Returns the fields of it in comments that do not count, as the rows were edited."""
        shell = _shell(element)
        rows = children(element)
        notes: dict[etree._Element, Fields] = {comment: {} for comment in element.iterchildren(etree.Comment)}
        for comment, note in notes.items():
            read_comment(self.ctx, comment, note)
        edited = [name for note in notes.values() for name in edited_fields(note, element, self.ctx.edited_copies)]
        for row in element:
            if not isinstance(row.tag, str):
                association = notes.get(row, {}).get(ASSOCIATION)  # one without a row
                if association is not None:
                    step["actions"].append({**association, "id": self.new_id()})
                    self._unwritten.add(self._last)
            elif local(row) != "Action":
                shell.append(copy.deepcopy(row))
            elif self.ctx.trusting and not edited and is_added(row):
                continue
            elif row is not rows[-1] or len(row) or row.attrib:  # the last row of the editor is an empty one
                action = {"id": self.new_id(), **read_action(row)}
                read_comments(self.ctx, row, action)
                association = action.pop(ASSOCIATION, None)
                step["actions"].append(action if association is None or edited else {**association, "id": action["id"]})
        _keep_shell(step, shell)
        return edited

    def _supervised(self, step: Fields, element: etree._Element, kind: str) -> None:
        shell = _shell(element)
        for child in children(element):
            name = kind.lower()
            if local(child) != kind or name in step:
                shell.append(copy.deepcopy(child))
                continue
            fields: Fields = {"condition": self._condition(child)}
            _keep_attributes(step, child, "ProgrammingLanguage")
            unknown = [
                part
                for part in children(child)
                if not _is_network(child, part)
                and not _text(fields, part, "Title", "title")
                and not _text(fields, part, "AlarmText", "alarm")
            ]
            _replace_condition(self.ctx, child, fields)
            for part in unknown:
                shell.append(copy.deepcopy(part))
            step[name] = fields if fields != {"condition": None} else None
        _keep_shell(step, shell)

    def _condition(self, element: etree._Element) -> Fields | None:
        """Return the condition of a transition, interlock or supervision; None for the empty network of LAD."""
        body = read_flgnet_body(self.ctx, element)
        if body["language"] == "LD" and body["networks"] and "extension_data" not in body:
            nodes = body["networks"][0]["nodes"]
            if len(nodes) == _EMPTY and "extension_data" not in body["networks"][0] and nodes[1]["kind"] == "coil":
                return None
        name = RESULT_OF.get(local(element), "")
        if "networks" in body and not any(
            node["kind"] == "coil" and node["variable"] == name for net in body["networks"] for node in net["nodes"]
        ):
            self.ctx.error("SFC115", f"the network of a {local(element).lower()} does not end in {name}", element)
        return {"kind": "body", "name": name, "body": body}

    def _transition(self, element: etree._Element) -> None:
        fields, left = self._begin("transition", element)
        left.pop("ProgrammingLanguage", None)
        condition = self._condition(element) or {"kind": "expression", "text": "TRUE"}
        fields["condition"] = condition
        for child in children(element):
            texts = (("TransitionName", "title"), ("Comment", "comment"))
            if not _is_network(element, child) and not any(_text(fields, child, name, field) for name, field in texts):
                keep_element(fields, child)
        for name, value in left.items():
            keep_attribute(fields, name, value)
        if _replace_condition(self.ctx, element, fields):
            self._sourced.add(fields["id"])
        if fields["condition"] is not condition:
            self._networks[fields["id"]] = condition
        self.chart["transitions"].append(fields)
        self._end(fields, SymbolKind.TRANSITION, element)


RESULT_OF = {"Transition": "TrCoil", "Interlock": "IlCoil", "Supervision": "SvCoil"}
"""Coil in which the network of each of them ends."""
_OWN_TYPES = ("G7_StepPlus", "G7_TransitionPlus")
"""Prefixes of the types of the members that TIA Portal declares for steps and transitions."""
_EMPTY = 2
"""Elements of an empty network of LAD: the power rail and the coil."""


_LISTS = ("Steps", "Transitions", "Branches", CONNECTIONS)


def _keep_attributes(owner: Fields, element: etree._Element, *known: str) -> None:
    """Keep the attributes of an element that belongs to an object: ``@Actions@Unknown``."""
    for name, value in attributes(element).items():
        if name not in known:
            keep_attribute(owner, f"@{local(element)}@{name}", value)


def _is_network(owner: etree._Element, element: etree._Element) -> bool:
    """True if `element` is the network that is read; a second one is kept."""
    return local(element) == "FlgNet" and element is child_named(owner, "FlgNet")


def _text(fields: Fields, element: etree._Element, name: str, field: str) -> bool:
    """Read a text in several languages; False where it is none."""
    if local(element) != name or field in fields or element.attrib:
        return False
    text = read_languages(element)
    if text is None:
        return False
    fields[field] = text
    return True


def _replace_condition(ctx: DocumentReading, element: etree._Element, fields: Fields) -> bool:
    """Put back the fields that comments keep; a kept condition replaces the network drawn for it.

    True if a comment of this package keeps one, valid or outdated.
    """
    kept: Fields = {}
    read_comments(ctx, element, kept)
    digest = kept.pop(WRITTEN, None)
    is_kept = "condition" in kept
    if is_kept:
        condition = kept.pop("condition")
        if digest is None or digest == condition_digest(element, RESULT_OF[local(element)]):
            fields["condition"] = condition
        else:
            kept.pop("exclude", None)  # the excluded condition has been programmed since
            warn_of_edit(ctx, f"the condition of the {local(element).lower()}", element)
    merge_fields(fields, kept)
    return is_kept


def _shell(element: etree._Element) -> etree._Element:
    """Return an empty element for the parts of `element` that are not understood."""
    return etree.Element(element.tag, nsmap=element.nsmap)  # type: ignore[arg-type]  # lxml-stubs: str keys only


def _keep_shell(owner: Fields, shell: etree._Element) -> None:
    """Keep the content of a shell with the object that the element belongs to."""
    if len(shell):
        keep_element(owner, shell)


def _categories(chart: Fields, element: etree._Element) -> list[Fields]:
    """Read ``AlarmsSettings``."""
    found: list[Fields] = []
    shell = _shell(element)
    _keep_attributes(chart, element)
    for child in children(element):
        if local(child) == "AlarmSupervisionCategories":
            _keep_attributes(chart, child)
        entries = children(child) if local(child) == "AlarmSupervisionCategories" else [child]
        for entry in entries:
            fields = _category(entry)
            if fields is None:
                shell.append(copy.deepcopy(entry))
            else:
                found.append(fields)
    _keep_shell(chart, shell)
    return found


def _category(element: etree._Element) -> Fields | None:
    left = attributes(element)
    number, display = canonical_number(left.pop("Id", None)), left.pop("DisplayClass", None)
    tokens = children(element)
    if number is None or left or len(tokens) > 1 or (display is not None and canonical_number(display) is None):
        return None
    text = None
    if tokens:
        if local(tokens[0]) != "Token" or set(tokens[0].attrib) != {"Text"}:
            return None
        text = tokens[0].get("Text")
    return {"name": local(element), "id": number, "display_class": canonical_number(display), "text": text}


def control_label(step: str, target: str | None) -> str:
    """Return the name of a controlled action for people: that of the action, or of the step that has it in place."""
    return target.replace("#", "").replace('"', "") if target is not None else f"{step}_action"


def are_controls_edited(block: etree._Element) -> bool:
    """True if a network that controls an action was edited since it was added, or a chart with SFC flags."""
    for each in block.iter("{*}PermanentOperation"):
        if mark_of(each) is AddedMark.EDITED and _kept(each).get(CONTROLLED) is not None:
            return True
    for graph in block.iter("{*}Graph"):
        kept = _kept(graph)
        if SOURCE_CHART_FIELD in kept and kept.get(WRITTEN) != chart_digest(graph):
            return True
    return False


def _kept(element: etree._Element) -> Fields:
    """Return the fields in the comments of this package at an element, as far as they can be read."""
    found: Fields = {}
    for comment in element.iterchildren(etree.Comment):
        with suppress(ValueError, RecursionError):  # the reader of the element reports that it is damaged
            found |= comment_fields(comment)
    return found
