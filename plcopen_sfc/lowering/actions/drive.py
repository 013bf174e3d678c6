"""The drive block: the actions of a chain in a function block of their own, which gets the step flags."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.flattening import flatten
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.naming import free_name
from plcopen_sfc.lowering.code.program import Code, CodeNetwork, StepValue
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


class DriveBlock:
    """The function block that drives the outputs of one chain, whose code is `chain`, with a memory like `memory`.

    Lower actions with its own `code`, `memory` and `active`, then call `finish`. What the actions
    read and write of the variables of the chain is passed on; other names are seen from everywhere.
    """

    def __init__(
        self,
        source: ChartSource,
        chain: Code,
        memory: Memory,
        texts: Texts,
        active: StepValue,
    ) -> None:
        self.code = chain.beside()
        self.memory = type(memory)(self.code)
        self._source, self._chain, self._texts = source, chain, texts
        self._active = active
        self._given: dict[str, Expression] = {}
        self.interface = Interface()
        self.name = ""

    def active(self, step: int) -> Expression:
        """What tells in the block that a step is active: the flag of the chain, which it gets."""
        told = self._active(step)
        if isinstance(told, n.Name | n.Member):
            return told
        wanted = self._texts.flag_name(self._source.net.steps[step].step)
        if wanted not in self._given:
            self.code.declare_input(wanted, self._texts.flag_of(self._source.net.steps[step].path))
            self._given[wanted] = told
        return self.code.naming.local(wanted)

    def finish(self, surroundings: Collection[str]) -> None:
        """Declare what the block gets and gives, and append its call to the chain.

        Raises `LoweringError` for instances and actions of the POU: they stay there.
        """
        self.memory.finish(self._texts.first_scan)
        if self.code.needs_flat_statements:
            flatten(self.code)
        flags = self._chain.flags
        named = {name.identifier for name in self._names()}
        seen = [v for v in flags.external if v.name in named] if flags is not None else []
        self.name = free_name(f"{self._source.pou.name}_{self._texts.drive}", surroundings)
        instance = self._chain.declare(self._texts.drive, DerivedType(name=self.name))
        arguments = [n.Argument(value, n.Name(name)) for name, value in self._given.items()]
        sections: dict[SectionKind, list[Variable]] = {SectionKind.INPUT: self.code.inputs}
        for name, variable in self._passed().items():
            kind = self._kind(name)
            sections.setdefault(kind, []).append(Variable(name=name, type=variable.type, comment=variable.comment))
            is_output = kind is SectionKind.OUTPUT
            arguments.append(n.Argument(self._chain.naming.local(name), n.Name(name), output=is_output))
        sections |= {SectionKind.EXTERNAL: seen, SectionKind.LOCAL: self.code.variables}
        self.interface.sections = [VariableSection(kind=kind, variables=vs) for kind, vs in sections.items() if vs]
        arguments.sort(key=lambda argument: argument.output)
        self._chain.add(self._texts.drive_call, [n.CallStatement(n.Call(instance, tuple(arguments)))])

    def _passed(self) -> dict[str, Variable]:
        """The variables of the chain that the actions name, in the order of their declaration."""
        pou = self._source.pou
        declared = [*pou.variables(), *self._chain.inputs, *self._chain.constants, *self._chain.variables]
        own = {v.name.casefold() for v in (*self.code.variables, *self.code.inputs)}
        named = {name.identifier.casefold() for name in self._names()} - own
        for action in pou.actions:
            if action.name.casefold() in named:
                self._refuse(f"the action {action.name} is called in other actions, and stays in its POU")
        found = {v.name: v for v in declared if v.name.casefold() in named}
        for variable in found.values():
            kind = variable.type
            if isinstance(kind, DerivedType) and kind.name.casefold() not in self._chain.known_types:
                self._refuse(f"{variable.name} is an instance of a function block, which stays in its POU")
        return found

    def _kind(self, name: str) -> SectionKind:
        """What a variable of the chain is in the block: only read, only written in every scan, or both."""
        written = [each for each in self._targets() if _root(each).casefold() == name.casefold()]
        if not written:
            return SectionKind.INPUT
        each_scan = [each for each in self._statements() if isinstance(each, n.Assignment)]
        whole = {id(each.target) for each in each_scan if isinstance(each.target, n.Name)}
        targets = {id(each) for each in written}
        uses = sum(each.identifier.casefold() == name.casefold() for each in self._names())
        if targets <= whole and uses == len(written):
            return SectionKind.OUTPUT
        if self.code.drawn:
            self._refuse(f"{name} is read and written: networks do not show what goes in and out")
        return SectionKind.IN_OUT

    def _targets(self) -> Iterator[Expression]:
        """What is written: by assignments, loops and outputs of calls, and whatever else a call may write."""
        for statement in self._statements():
            for node in walk(statement):
                if isinstance(node, n.Assignment | n.AssignmentExpression):
                    yield node.target
                elif isinstance(node, n.For):
                    yield node.variable
                elif isinstance(node, n.Call):
                    yield from (a.value for a in node.arguments if a.output and a.value is not None)

    def _names(self) -> Iterator[n.Name]:
        """The variables that are named, not members, parameters and functions."""
        for statement in self._statements():
            nodes = list(walk(statement))
            others = {id(each.name) for each in nodes if isinstance(each, n.Member | n.Argument)}
            yield from (each for each in nodes if isinstance(each, n.Name) and id(each) not in others)

    def _statements(self) -> Iterator[Statement]:
        for network in self.code.networks:
            if isinstance(network, CodeNetwork):
                yield from network.statements

    def _refuse(self, message: str) -> NoReturn:
        raise LoweringError(message, location=Location(path=self._source.pou.name), hint="Leave actions inline.")


def _root(target: Expression) -> str:
    """The variable that a target is, or is a part of."""
    at = n.bare(target)
    while isinstance(at, n.Member | n.Index | n.Dereference | n.Peripheral):
        at = n.bare(at.base)
    return at.identifier if isinstance(at, n.Name) else ""
