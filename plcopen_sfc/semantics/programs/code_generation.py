"""Python source of translated bodies: written line by line, compiled once, and traced back to the text it is of."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType, FunctionType, TracebackType
from typing import Any

from plcopen_sfc.errors import Location, SimulationError

INDENT = " "
_LINE_LIMIT = 90
"""Blocks that Python allows in each other: 100 levels of indentation, and the function itself is one."""


class Writer:
    """Lines of Python source, each with the line of the program text that it is of."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.origins: list[int] = []
        self.origin = 1
        self._depth = 1
        self._temporaries = 0

    def write(self, line: str) -> None:
        """Write a line."""
        self.lines.append(INDENT * self._depth + line)
        self.origins.append(self.origin)

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """Write a head, and the lines that the body of the `with` writes below it."""
        self.write(head)
        self._depth += 1
        if self._depth > _LINE_LIMIT:
            raise SimulationError("statements stand too deep in each other")
        before = len(self.lines)
        yield
        if len(self.lines) == before:
            self.write("pass")
        self._depth -= 1

    def temporary(self) -> str:
        """Return a new name of a local variable of Python."""
        self._temporaries += 1
        return f"_{self._temporaries}"

    def mark(self) -> tuple[int, int]:
        """Return the present end of the text; see `rollback`."""
        return len(self.lines), self._depth

    def rollback(self, mark: tuple[int, int]) -> None:
        """Take back what was written since `mark`."""
        del self.lines[mark[0] :]
        del self.origins[mark[0] :]
        self._depth = mark[1]


@dataclass(slots=True)
class _Draft:
    function: FunctionType
    head: str
    lines: list[str]
    origins: list[int]
    path: str
    filename: str
    linked: str = ""


def _template() -> None:
    raise AssertionError("a routine is called before it is linked")


_FREE = re.compile("\x01([^\x01\x02]*)\x02([^\x01\x03]*)\x03")
"""A token without another one in it: the index of an element may be a free input, too."""


def free_token(key: str, plain: str, asking: str) -> str:
    """Source that reads what may be a free input: which of both it becomes is known when all is translated."""
    return f"\x01{key}\x02{plain}\x04{asking}\x03"


@lru_cache(maxsize=4096)  # a comparison translates the same program several times, with the same names
def _code(source: str) -> CodeType:
    """Return the code of the function that `source` defines."""
    scratch: dict[str, Any] = {"__builtins__": {}}
    # what runs here was generated from a syntax tree; names and texts of the project never reach it as code
    exec(compile(source, "<plc>", "exec"), scratch)  # noqa: S102
    return next(value for value in scratch.values() if isinstance(value, FunctionType)).__code__


_FUNCTIONS = {
    **{each.__name__: each for each in (abs, all, any, bool, divmod, enumerate, float, int, isinstance, len, list)},
    **{each.__name__: each for each in (max, min, range, round, str, sum, tuple, zip)},
}
"""Builtins of Python that generated code has: none that opens, imports or looks into an object."""


class Linker:
    """All functions of a controller: they share one namespace, so that they can call each other."""

    def __init__(self) -> None:
        self.namespace: dict[str, Any] = {"__builtins__": {}, **_FUNCTIONS}
        self._names = 0
        self._known: dict[int, str] = {}
        self._waiting: list[_Draft] = []
        self._asking: list[_Draft] = []
        """Code that reads variables that may be free inputs."""
        self._version: Hashable = None
        self._places: dict[str, _Draft] = {}
        self._prefix = f"plc-{id(self):x}"

    def name(self, thing: object, hint: str = "k") -> str:
        """Return a name by which source can reach an object."""
        found = self._known.get(id(thing))
        if found is None:
            self._names += 1
            found = self._known[id(thing)] = f"{hint}{self._names}"
            self.namespace[found] = thing
        return found

    def reserve(self, hint: str = "r") -> Callable[..., Any]:
        """Return a function that exists before its body is known; see `routine`."""
        function = FunctionType(_template.__code__, self.namespace, hint)
        self.name(function, hint)
        return function

    def routine(
        self, parameters: str, writer: Writer, path: str, function: Callable[..., Any] | None = None
    ) -> Callable[..., Any]:
        """Return a function whose body `writer` has. It exists at once, and can be called when it is linked."""
        function = function or self.reserve()
        name = self.name(function)
        head = f"def {name}({parameters}):"
        filename = f"<{self._prefix}-{name}>"
        assert isinstance(function, FunctionType)  # noqa: S101  # reserve makes no others
        draft = _Draft(function, head, writer.lines or [" pass"], writer.origins or [1], path, filename)
        self._waiting.append(draft)
        self._places[filename] = draft
        return function

    def link(self, is_free: Callable[[str], bool], version: Hashable) -> list[SimulationError]:
        """Compile what has not been compiled yet, and again what reads inputs, where `version` tells of a change.

        What Python cannot compile, because it is nested too deeply, is an error that the function raises.
        """
        errors = []
        waiting, self._waiting = self._waiting, []
        if version != self._version:
            self._version = version
            waiting = [*self._asking, *waiting]
        for draft in waiting:
            source = "\n".join([draft.head, *draft.lines])
            found, count = source, 1
            while count:
                found, count = _FREE.subn(lambda token: token[2].split("\x04")[is_free(token[1])], found)
            if not draft.linked and "\x01" in source:
                self._asking.append(draft)
            if found != draft.linked:
                try:
                    draft.function.__code__ = self._compiled(found, draft)
                except SimulationError as error:
                    errors.append(error)
                    instead = f"{draft.head} fail({self.name(error, 'e')})"
                    draft.function.__code__ = self._compiled(instead, draft)
                draft.linked = found
        return errors

    def _compiled(self, source: str, draft: _Draft) -> CodeType:
        try:
            return _code(source).replace(co_filename=draft.filename)
        except (SyntaxError, MemoryError, RecursionError) as error:
            raise SimulationError(
                f"the text is too deeply nested to be simulated ({getattr(error, 'msg', error)})",
                location=Location(path=draft.path),
            ) from None

    def place(self, traceback: TracebackType | None) -> Location | None:
        """Return the innermost place of a program text that an exception came through."""
        found = None
        while traceback is not None:
            draft = self._places.get(traceback.tb_frame.f_code.co_filename)
            if draft is not None:
                line = traceback.tb_lineno - 2  # lines count from 1, and the first one is the head
                found = Location(path=draft.path, line=draft.origins[line] if 0 <= line < len(draft.origins) else None)
            traceback = traceback.tb_next
        return found
