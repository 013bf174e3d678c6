"""Who writes the variables of a POU: its actions alone, or something else too."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.languages.st.effects import ANYTHING, Path, path_of, writes
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.model.types import DerivedType, SimpleValue, Variable
from plcopen_sfc.model.variables import SectionKind


class OwnVariables:
    """The variables that only the actions of a chart write. `beside`: what else is executed in the POU."""

    def __init__(self, source: ChartSource, beside: Iterable[Statement] = ()) -> None:
        blocks = standard_instances(source)
        self._others = WrittenPaths()
        steps = (each for step in source.step_code for each in (*step.entry, *step.main, *step.exit))
        before = (each for statements in source.preparations for each in statements)
        asked = (each for action in source.actions for use in action.uses for each in use.preparation)
        for statement in (*steps, *source.logic, *before, *asked, *beside):
            self._others.add(0, writes(statement, blocks))
        self._variables: dict[Path, Variable] = {}
        for section in source.pou.interface.sections if source.pou.interface is not None else ():
            if (
                section.kind in (SectionKind.LOCAL, SectionKind.OUTPUT)
                and not section.retain
                and not section.persistent
            ):
                self._variables |= {(variable.name.casefold(),): variable for variable in section.variables}

    def has(self, target: Expression) -> bool:
        """Whether it is such a variable, one that does not outlive a restart."""
        path = path_of(target)
        return path in self._variables and not self._others.touching([path])

    def is_false_at_rest(self, target: Expression) -> bool:
        """Whether it is one that is FALSE anyway while its action is not executed."""
        if not self.has(target):
            return False
        initial = self._variables[path_of(target)].initial
        value = initial.text if isinstance(initial, SimpleValue) else None
        return (value or "FALSE").upper() in ("FALSE", "BOOL#FALSE", "0")


class WrittenPaths:
    """What actions write: finds those that write a path, a part of it, or what it is part of."""

    def __init__(self) -> None:
        self._whole: dict[tuple[bool, Path], set[int]] = {}
        self._starts: dict[tuple[bool, Path], set[int]] = {}
        self._anything: set[int] = set()
        self._all: set[int] = set()

    def add(self, index: int, written: Iterable[Path]) -> None:
        """An action writes these paths."""
        for path in written:
            self._all.add(index)
            if path == ANYTHING:
                self._anything.add(index)
            for is_part, form in _forms(path):
                self._whole.setdefault((is_part, form), set()).add(index)
                for length in range(1, len(form) + 1):
                    self._starts.setdefault((is_part, form[:length]), set()).add(index)

    def touching(self, paths: Iterable[Path]) -> set[int]:
        """The actions that write something of these paths."""
        found: set[int] = set()
        for path in paths:
            found |= self._all if path == ANYTHING else self._anything
            for is_part, form in _forms(path):
                for kind in (False,) if is_part else (False, True):
                    found |= self._starts.get((kind, form), set())
                    for length in range(1, len(form)):
                        found |= self._whole.get((kind, form[:length]), set())
        return found


def _forms(path: Path) -> list[tuple[bool, Path]]:
    """A path as it is, and without its first name: a global variable may be named with or without its list."""
    return [(False, path)] + ([(True, path[1:])] if len(path) > 1 else []) if path else []


def standard_instances(source: ChartSource) -> set[Path]:
    """The instances of standard function blocks of a POU: calling them writes nothing else."""
    kinds = {v.name: v.type.name for v in source.pou.variables() if isinstance(v.type, DerivedType)}
    kinds |= {helper.name: helper.type_name for helper in source.helpers if helper.type_name}
    blocks = {name: standard_block(kind) for name, kind in kinds.items()}
    return {(name.casefold(),) for name, block in blocks.items() if block is not None and block.stateful}
