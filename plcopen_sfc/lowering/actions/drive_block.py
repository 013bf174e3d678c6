"""Drive block: the actions of a sequence in a function block of their own, which gets the step flags."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from plcopen_sfc.languages.effects import targets
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, standard_block
from plcopen_sfc.languages.words import free_name
from plcopen_sfc.lowering.actions.variable_access import OwnVariables
from plcopen_sfc.lowering.code.boolean_logic import negation
from plcopen_sfc.lowering.code.code_bodies import body_of
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.flat_statements import flatten
from plcopen_sfc.lowering.code.lowered_code import BOOL
from plcopen_sfc.lowering.lowering_options import Language
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


class DriveSignal(NamedTuple):
    """Input of a drive block in the place of an expression: its name and comment."""

    name: str
    comment: str


class DriveBlock:
    """Function block that executes actions of one sequence, whose code has the memory `caller`.

    Lower actions with its own `memory`, then call `finish`. `signals` are expressions that become inputs, as
    flags of steps do. The variables of the sequence that actions read and write are passed on; other names are global.
    `wanted` is the name of the instance, `beside` other code that writes variables of the sequence.
    """

    def __init__(
        self,
        source: ChartSource,
        caller: Memory,
        *,
        wanted: str,
        signals: Mapping[Expression, DriveSignal],
        beside: Iterable[Statement] = (),
    ) -> None:
        self.code = caller.code.beside()
        self.memory = type(caller)(self.code)
        self._source, self._caller, self._wanted = source, caller.code, wanted
        self._signals = signals
        self._owned = OwnVariables(source, beside)
        self._given: dict[Expression, n.Name] = {}
        self.interface = Interface()
        self.name = ""
        self.call: n.CallStatement

    def finish(self, surroundings: Collection[str]) -> None:
        """Declare the parameters, and make the `call`.

        Raises `LoweringError` for instances and actions of the POU: they stay there.
        """
        self.code.end_first_scan()
        self._replace_signals()
        if self.code.needs_flat_statements:
            flatten(self.code, self._source.pou.variables())
        flags = self._caller.flags
        named = {name.identifier for name in self._names()}
        seen = [v for v in flags.external if v.name in named] if flags is not None else []
        self.name = free_name(f"{self._source.pou.name}_{self._wanted}", surroundings)
        instance = self._caller.declare(self._wanted, DerivedType(name=self.name))
        arguments = [n.Argument(value, n.Name(name.identifier)) for value, name in self._given.items()]
        sections: dict[SectionKind, list[Variable]] = {SectionKind.INPUT: self.code.inputs}
        for name, variable in self._passed().items():
            kind = self._kind(name)
            is_output = kind is SectionKind.OUTPUT
            initial = variable.initial if is_output else None
            passed = Variable(name=name, type=variable.type, initial=initial, comment=variable.comment)
            sections.setdefault(kind, []).append(passed)
            arguments.append(n.Argument(self._caller.naming.local(name), n.Name(name), output=is_output))
        sections |= {SectionKind.EXTERNAL: seen, SectionKind.LOCAL: self.code.variables}
        self.interface.sections = [VariableSection(kind=kind, variables=vs) for kind, vs in sections.items() if vs]
        arguments.sort(key=lambda argument: argument.output)
        self.call = n.CallStatement(n.Call(instance, tuple(arguments)))

    def _replace_signals(self) -> None:
        """Write inputs in the place of `signals`, and of outputs of instances outside."""
        kinds = {v.name.casefold(): v.type for v in (*self._source.pou.variables(), *self._caller.variables)}

        def replaced(node: n.Node) -> n.Node:
            match node:
                case n.Operation() if node in self._signals:
                    return self._input(node, *self._signals[node])
                # ``state <> 2`` is passed on as NOT of the input for ``state = 2``: one input for both
                case n.Operation() if (opposite := negation(node)) in self._signals:
                    return negation(self._input(opposite, *self._signals[opposite]))
                case n.Member(n.Name(instance), n.Name(output)):
                    kind = kinds.get(instance.casefold())
                    block = (
                        standard_block(BLOCKS_OF_S7.get(kind.name, kind.name))
                        if isinstance(kind, DerivedType)
                        else None
                    )
                    pin = block.output_name(output) if block is not None and block.stateful else None
                    types = {each.name: each.type for each in block.outputs} if block is not None else {}
                    if pin is not None and types[pin] in Elementary.__members__:
                        return self._input(
                            node, f"{instance}_{output}", "", ElementaryType(name=Elementary[types[pin]])
                        )
            return node

        self.code.change(lambda statement: transform(statement, replaced))

    def _input(self, given: Expression, wanted: str, comment: str, kind: DataType = BOOL) -> n.Name:
        if given not in self._given:
            self._given[given] = self.code.declare_input(self.code.naming.fresh(wanted), comment, kind)
        return self._given[given]

    def _passed(self) -> dict[str, Variable]:
        """Return the variables of the sequence that the actions name, in the order of their declaration."""
        pou = self._source.pou
        declared = [*pou.variables(), *self._caller.inputs, *self._caller.constants, *self._caller.variables]
        own = {v.name.casefold() for v in (*self.code.variables, *self.code.inputs)}
        named = {name.identifier.casefold() for name in self._names()} - own
        for action in pou.actions:
            if action.name.casefold() in named:
                self._source.refuse(
                    f"the action {action.name} is called in other actions, and stays in its POU", _INLINE
                )
        found = {v.name: v for v in declared if v.name.casefold() in named}
        for variable in found.values():
            kind = variable.type
            if isinstance(kind, DerivedType) and kind.name.casefold() not in self._caller.known_types:
                self._source.refuse(
                    f"{variable.name} is an instance of a function block, which stays in its POU", _INLINE
                )
        return found

    def _kind(self, name: str) -> SectionKind:
        """Return the kind of parameter of a variable: it is only read, only written, or both."""
        written = [
            each
            for statement in self._statements()
            for each in targets(statement)
            if _root(each).casefold() == name.casefold()
        ]
        if not written:
            return SectionKind.INPUT
        each_scan = [each for each in self._statements() if isinstance(each, n.Assignment)]
        whole = {id(each.target) for each in each_scan if isinstance(each.target, n.Name)}
        places = {id(each) for each in written}
        uses = sum(each.identifier.casefold() == name.casefold() for each in self._names())
        # written in every scan and never read: the old value does not matter
        if places <= whole and uses == len(written):
            return SectionKind.OUTPUT
        # no other code writes it, so that the block can keep the value between two scans
        if self._owned.has(n.Name(name)) and (uses == len(written) or self.code.drawn):
            return SectionKind.OUTPUT  # the block keeps it
        # in networks an in-out is one pin: readers would not see that the block changes it
        if self.code.drawn:
            self._source.refuse(f"{name} is read and written: networks do not show what goes in and out", _INLINE)
        return SectionKind.IN_OUT

    def _names(self) -> Iterator[n.Name]:
        """Yield the names of variables, not of members, parameters and functions."""
        for statement in self._statements():
            nodes = list(walk(statement))
            others = {id(each.name) for each in nodes if isinstance(each, n.Member | n.Argument)}
            yield from (each for each in nodes if isinstance(each, n.Name) and id(each) not in others)

    def _statements(self) -> Iterator[Statement]:
        return (statement for network in self.code.networks for statement in network.statements)


_INLINE = "Leave actions inline."


def without_texts(source: ChartSource) -> ChartSource:
    """Return the chart without the texts of its actions as they were written: a block has other names."""
    return replace(source, actions=tuple(replace(action, text="") for action in source.actions))


def _root(target: Expression) -> str:
    """Return the variable that a target is, or is a part of."""
    at = n.bare(target)
    while isinstance(at, n.Member | n.Index | n.Dereference | n.Peripheral):
        at = n.bare(at.base)
    return at.identifier if isinstance(at, n.Name) else ""


def drive_block(drive: DriveBlock, dialect: Dialect, language: Language) -> Pou:
    """Return the function block that drives the actions."""
    body = body_of(drive.code, dialect, language, drive.interface.variables(), drive.name)
    return Pou(name=drive.name, kind=PouKind.FUNCTION_BLOCK, interface=drive.interface, bodies=[body])
