"""Start values of the inputs of timers and counters in SCL: calls pass them, as S7 cannot declare them.

CODESYS and IEC 61131-3 let an instance start with values of its inputs::

    fbTick : TON := (PT := T#1s);        #fbTick(IN := #run, PT := T#1s);

Such a value counts in the calls that do not pass the input, until something else writes it. Where all calls in a block
leave the input out, each of them passes the value; where all of them pass the input, the value has no effect.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, walk
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, standard_block
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, SimpleValue, StructValue, Variable


@dataclass(frozen=True, slots=True)
class PassedValues:
    """Arguments of the calls of an instance: `values` by the names of inputs, which no call passes in the source.

    Empty where all calls pass them in the source.
    """

    instance: str
    values: dict[str, str]


@dataclass
class _Uses:
    """The uses of an instance in the texts of its block."""

    passed: list[set[str]] = field(default_factory=list)
    """The inputs that each call in a text passes."""
    drawn: list[set[str]] = field(default_factory=list)
    """The inputs that are connected at each box."""
    members: set[str] = field(default_factory=set)
    others: bool = False


class InstanceStarts:
    """The start values of the instances of timers and counters in a project in SCL."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._found: dict[tuple[str, str], dict[str, PassedValues]] = {}

    def of(self, pou: Pou) -> dict[str, PassedValues]:
        """Return the arguments of the calls in a block, by the names of the instances in lower case.

        Instances whose start values cannot be passed are left out.
        """
        key = _place(pou)
        if key not in self._found:
            wanted = {
                variable.name.casefold(): PassedValues(variable.name, values) for variable, values in _started(pou)
            }
            self._found[key] = self._passed(pou, wanted) if wanted else {}
        return self._found[key]

    def completed(self, text: str, pou: Pou) -> tuple[str, list[str]]:
        """Return statements of a block whose calls pass the start values, and the instances that they call."""
        found = self.of(pou)
        edits: list[Edit] = []
        called: list[str] = []
        for call in walk(parse_statements(text, Dialect.SCL).tree) if found else ():
            name = _instance(call.callee) if isinstance(call, n.Call) else ""
            if not isinstance(call, n.Call) or call.span is None or name not in found or not found[name].values:
                continue
            passed = {each.name.identifier.upper() for each in call.arguments if each.name is not None}
            # a text that was completed before passes them already
            given = {pin: value for pin, value in found[name].values.items() if pin.upper() not in passed}
            if not given:
                continue
            added = ", ".join(f"{pin} := {value}" for pin, value in given.items())
            end = call.span[0] + text[slice(*call.span)].rindex(")")
            edits.append(Edit(end, end, f"{', ' if call.arguments else ''}{added}"))
            called.append(found[name].instance)
        return apply_edits(text, edits), list(dict.fromkeys(called))

    def _passed(self, pou: Pou, wanted: dict[str, PassedValues]) -> dict[str, PassedValues]:
        uses = {name: _Uses() for name in wanted}
        for text_site in text_sites(self._project):
            if text_site.site.pou is not None and _place(text_site.site.pou) == _place(pou):
                _note_uses(text_site, uses)
            else:
                _note_uses_elsewhere(text_site, uses)
        found: dict[str, PassedValues] = {}
        for name, given in wanted.items():
            use = uses[name]
            calls = [*use.passed, *use.drawn]
            pins = {pin.upper() for pin in given.values}
            if use.others or not pins.isdisjoint(use.members):
                continue
            if all(pins <= passed for passed in calls):
                found[name] = PassedValues(given.instance, {})
            elif not use.drawn and all(pins.isdisjoint(passed) for passed in calls):
                found[name] = given
        return found


def _place(pou: Pou) -> tuple[str, str]:
    """Return what tells a block from others, whose documents in a folder hold copies of the blocks of the project."""
    return pou.place, pou.name.casefold()


def _started(pou: Pou) -> Iterator[tuple[Variable, dict[str, str]]]:
    """Yield the instances of timers and counters with start values of inputs alone, and these values."""
    for variable in pou.variables():
        if not isinstance(variable.type, DerivedType) or not isinstance(variable.initial, StructValue):
            continue
        name = variable.type.name.strip('"').upper()
        block = standard_block(BLOCKS_OF_S7.get(name, name))
        inputs = {pin.name.upper() for pin in block.inputs} if block is not None and block.stateful else set()
        values = {m.member: m.value.text or "" for m in variable.initial.members if isinstance(m.value, SimpleValue)}
        if len(values) == len(variable.initial.members) and all(pin.upper() in inputs for pin in values):
            yield variable, values


def _instance(callee: n.Expression) -> str:
    """Return the local variable that is called, in lower case; empty for anything else."""
    is_local = isinstance(callee, n.Name) and callee.quoting in (n.Quoting.LOCAL, n.Quoting.LOCAL_QUOTED)
    return callee.identifier.casefold() if is_local and isinstance(callee, n.Name) else ""


def _note_uses(text_site: TextSite, uses: dict[str, _Uses]) -> None:
    folded = text_site.text.casefold()
    if not any(name in folded for name in uses):
        return
    if isinstance(text_site.holder, Block):
        _note_box(text_site.holder, uses)
        return
    if text_site.reading is SiteKind.NAME:
        return
    if text_site.reading not in (SiteKind.STATEMENTS, SiteKind.EXPRESSION):
        for use in (use for name, use in uses.items() if name in folded):
            use.others = True
        return
    nodes = list(walk(text_site.parsed(Dialect.SCL).tree))
    counted: set[int] = set()
    for node in nodes:
        if isinstance(node, n.Call) and (name := _instance(node.callee)) in uses:
            counted.add(id(node.callee))
            names = [argument.name.identifier.upper() for argument in node.arguments if argument.name is not None]
            uses[name].passed.append(set(names))
            uses[name].others |= len(names) < len(node.arguments)
        elif isinstance(node, n.Member) and (name := _instance(node.base)) in uses:
            counted.add(id(node.base))
            uses[name].members.add(node.name.identifier.upper())
    for node in nodes:
        if isinstance(node, n.Name) and (name := _instance(node)) in uses and id(node) not in counted:
            uses[name].others = True  # it is passed to something


def _note_box(box: Block, uses: dict[str, _Uses]) -> None:
    use = uses.get((box.instance or "").lstrip("#").strip('"').casefold())
    if use is not None:
        pins = [(pin.name.upper(), pin.input) for pin in box.parameters.inputs]
        use.drawn.append({name for name, wire in pins if wire is not None and (wire.connections or wire.expression)})


def _note_uses_elsewhere(text_site: TextSite, uses: dict[str, _Uses]) -> None:
    """Note members of the instance that other blocks name."""
    for name, use in uses.items():
        for found in re.finditer(rf'\.\s*"?{re.escape(name)}\b"?\s*(?:\.\s*"?(\w+))?', text_site.text, re.IGNORECASE):
            use.members.add((found[1] or "").upper())
            use.others |= found[1] is None
