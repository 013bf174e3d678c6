"""Access of texts in a chart to variables: what they read and write, and what only its actions write."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from functools import cached_property

from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.effects import ANYTHING, Path, calls, may_change, path_of, reads, writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.model.types import DerivedType, SimpleValue, Variable
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.reachability import reached


class UntouchedVariables:
    """Variables of a POU that code outside of it cannot touch, and what a call of its own actions touches.

    `own`: names that only the lowered code knows, in lower case. `timers`: its instances of timers.
    """

    def __init__(self, source: ChartSource, own: Collection[str] = (), timers: Collection[Path] = ()) -> None:
        sections = sections_of(source.pou.interface)
        local = (v.name.casefold() for each in sections if each.kind in _LOCAL for v in each.variables if not v.address)
        self.own = frozenset(own)
        self.private = {*own, *local}
        self.blocks = standard_instances(source) | {*timers}
        self._pou, self._dialect = source.pou, source.dialect

    @cached_property
    def _bodies(self) -> dict[str, set[str]]:
        """Names in the bodies of actions and methods, by those of these."""
        return {
            name.rpartition(".")[2].casefold(): names_in(body, self._dialect)
            for name, _, body in self._pou.named_bodies()
            if "." in name
        }

    def called(self, name: str) -> set[str]:
        """Return the names in all that a call of this name executes in the POU."""
        return reached(self._bodies.get(name, ()), lambda word: self._bodies.get(word, ()))


_LOCAL = (SectionKind.LOCAL, SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.TEMP)


class Effect:
    """Variables that code reads and writes. What it calls may touch all that is not private."""

    def __init__(self, scope: UntouchedVariables, trees: Iterable[Expression | Statement] = ()) -> None:
        self._scope = scope
        self.reading: set[Path] = set()
        self.writing: set[Path] = set()
        self.is_open = False
        self.add(trees)

    def add(self, trees: Iterable[Expression | Statement]) -> None:
        """Add the effects of expressions and statements."""
        for tree in trees:
            self.reading |= reads(tree)
            written = writes(tree, self._scope.blocks)
            self.writing |= written - {ANYTHING}
            if ANYTHING not in written:
                continue
            self.is_open = True
            # a pointer may lead to any variable, a name that is read at a call may be passed by reference
            if any(isinstance(node, n.Dereference | n.Unreadable) for node in walk(tree)):
                self.writing.add(ANYTHING)
            self.writing |= reads(tree)
            self.writing |= {(word,) for path in calls(tree) if len(path) == 1 for word in self._scope.called(path[0])}
            # a method or action may write all of its instance
            self.writing |= {path[:-1] for path in calls(tree) if len(path) > 1}

    def conflicts(self, other: Effect) -> bool:
        """Return True if one of them touches what the other one writes."""
        return self._disturbs(other) or other._disturbs(self)

    def _disturbs(self, other: Effect) -> bool:
        # no pointer leads to a name that only the lowered code knows
        if may_change(frozenset(other.reading | other.writing), frozenset(self.writing), self._scope.own):
            return True
        touched = self.reading | self.writing
        return other.is_open and (
            self.is_open or any(path[:1] == () or path[0] not in self._scope.private for path in touched)
        )


class OwnVariables:
    """Variables that only the actions of a chart write. `beside`: other code that is executed in the POU."""

    def __init__(self, source: ChartSource, beside: Iterable[Statement] = ()) -> None:
        scope = UntouchedVariables(source)
        self._others = WrittenPaths(scope)
        steps = (each for step in source.step_code for each in (*step.entry, *step.main, *step.exit))
        before = (each for statements in source.preparations for each in statements)
        asked = (each for action in source.actions for use in action.uses for each in use.preparation)
        for statement in (*steps, *source.logic, *before, *asked, *beside):
            self._others.add(0, Effect(scope, [statement]))
        self._variables: dict[Path, Variable] = {}
        for section in sections_of(source.pou.interface):
            if (
                section.kind in (SectionKind.LOCAL, SectionKind.OUTPUT)
                and not section.retain
                and not section.persistent
            ):
                self._variables |= {(variable.name.casefold(),): variable for variable in section.variables}

    def has(self, target: Expression) -> bool:
        """Return True if it is such a variable, one that does not outlive a restart."""
        path = path_of(target)
        return path in self._variables and not self._others.touching([path])

    def is_false_at_rest(self, target: Expression) -> bool:
        """Return True if it is one that is FALSE anyway while its action is not executed."""
        if not self.has(target):
            return False
        initial = self._variables[path_of(target)].initial
        value = initial.text if isinstance(initial, SimpleValue) else None
        return (value or "FALSE").upper() in ("FALSE", "BOOL#FALSE", "0")


class WrittenPaths:
    """Paths that actions write: finds the actions that write a path, a part of it, or what it is part of."""

    def __init__(self, scope: UntouchedVariables) -> None:
        self._private = scope.private
        self._whole: dict[tuple[bool, Path], set[int]] = {}
        self._starts: dict[tuple[bool, Path], set[int]] = {}
        self._anything: set[int] = set()
        self._open: set[int] = set()
        self._shared: set[int] = set()
        self._all: set[int] = set()

    def add(self, index: int, effect: Effect) -> None:
        """Note what an action writes."""
        if effect.is_open:
            self._open.add(index)
            self._shared.add(index)
            self._all.add(index)
        for path in effect.writing:
            self._all.add(index)
            # an address or a pointer may be any variable
            if path == ANYTHING:
                self._anything.add(index)
            if self._is_shared(path):
                self._shared.add(index)
            for is_part, form in _forms(path):
                self._whole.setdefault((is_part, form), set()).add(index)
                for length in range(1, len(form) + 1):
                    self._starts.setdefault((is_part, form[:length]), set()).add(index)

    def touching(self, paths: Iterable[Path], *, is_open: bool = False) -> set[int]:
        """Return the actions that write something of these paths, or of what a call may touch if one `is_open`."""
        found: set[int] = set(self._shared) if is_open else set()
        for path in paths:
            found |= self._all if path == ANYTHING else self._anything
            if self._is_shared(path):
                found |= self._open
            for is_part, form in _forms(path):
                # two shortened paths would match by their last names alone, such as A.x and B.x
                for kind in (False,) if is_part else (False, True):
                    found |= self._starts.get((kind, form), set())
                    for length in range(1, len(form)):
                        found |= self._whole.get((kind, form[:length]), set())
        return found

    def _is_shared(self, path: Path) -> bool:
        """Return True if called code may touch a variable."""
        return path == ANYTHING or path[0] not in self._private


def _forms(path: Path) -> list[tuple[bool, Path]]:
    """Return a path as it is, and without its first name: a global variable may be named with or without its list."""
    return [(False, path)] + ([(True, path[1:])] if len(path) > 1 else []) if path else []


def standard_instances(source: ChartSource) -> set[Path]:
    """Return the instances of standard function blocks of a POU: calling them writes nothing else."""
    kinds = {v.name: v.type.name for v in source.pou.variables() if isinstance(v.type, DerivedType)}
    kinds |= {helper.name: helper.type_name for helper in source.helpers if helper.type_name}
    blocks = {name: standard_block(kind) for name, kind in kinds.items()}
    return {(name.casefold(),) for name, block in blocks.items() if block is not None and block.stateful}
