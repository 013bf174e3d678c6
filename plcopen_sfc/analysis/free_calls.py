"""Results of unknown functions and blocks in a search: whatever they may be, the same on both sides.

In a scan equal calls have equal results, and all results are tried. A block depends on the calls before, too: which
these were is compared at the end of every scan, so both sides have made the same ones as long as the search goes on.
What is proven then holds whatever the functions and blocks do. A difference may be none: a result may be another one
in another scan, though the arguments are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from plcopen_sfc.analysis.domains import NotProvableError, Probe, Symbolic
from plcopen_sfc.analysis.intervals import Split
from plcopen_sfc.analysis.product import Branching
from plcopen_sfc.semantics.programs.types import ElementaryType, Family
from plcopen_sfc.semantics.programs.unknown_calls import UnknownCalls

__all__ = ["FreeCalls"]

_NUMBERS = (Family.INTEGER, Family.BITS, Family.REAL, Family.DURATION)


class FreeCalls(UnknownCalls):
    """Derived values in a run, free ones in a search. `is_delayed`: the other side makes its calls in other scans."""

    def __init__(self) -> None:
        super().__init__()
        self.is_delayed = False
        self.number: Callable[[Hashable], Any] | None = None
        """What stands for a number that is the answer to a question, where numbers need not be known."""
        self._branching: Branching | None = None

    def begin_scan(self, branching: Branching | None) -> None:
        """A scan begins; `branching`: one of a search."""
        self._branching = branching
        self.begin()

    @property
    def is_exact(self) -> bool:
        """Whether instances keep what tells different histories apart."""
        return self._branching is None

    def value(self, name: str, arguments: Any, type_: ElementaryType) -> Any:
        """The result of a function, or an output of a block in a situation; equal for equal arguments."""
        if self._branching is None:
            return super().value(name, arguments, type_)
        if self.is_delayed:
            raise NotProvableError(f"{name} is not known, and is called in other scans on both sides")
        before = tuple(call for call in self.log if name.startswith(f"{call[0]}."))
        question = ("call", name, self.key(arguments), before)
        if type_.family is Family.BOOL:
            return self._branching.answer(question)
        if self.number is not None and type_.family in _NUMBERS and type_.narrowed is None and not type_.names:
            return self.number(question)
        raise NotProvableError(f"{name} is not known, and its value is no truth value")

    def called(self, name: str, arguments: tuple[Any, ...], history: int, elapsed: int | None) -> Hashable:
        """Note the call of a block; its situation after that."""
        if self._branching is None:
            return super().called(name, arguments, history, elapsed)
        self.log.append((name, repr(self.key(arguments))))
        return None

    def key(self, value: Any) -> Hashable:
        """Equal for equal values."""
        if isinstance(value, Split):
            return "input", value.domain.name  # it is of this scan
        if isinstance(value, Probe):
            value.domain.double()
        return value.key() if isinstance(value, Symbolic) else super().key(value)
