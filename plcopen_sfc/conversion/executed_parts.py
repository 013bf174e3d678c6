"""A project as a tree of what a controller executes: parts, each with what is told of it.

Parts are found again by what they are called and where they stand: steps by name, transitions by the steps that they
connect, actions by what they execute, variables by name.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

from plcopen_sfc.conversion.meaning import Meaning, literal_meaning
from plcopen_sfc.model.chart_settings import OPERATING_FLAGS, SfcFlag
from plcopen_sfc.model.declaration import NamedObject

UNDECLARED = "undeclared name"
"""The kind of parts that are names which nothing declares."""
STORED = "stored value of "
"""The beginning of the aspect that tells what the rows of a step store in an operand."""
BOOLEAN_ACTIONS = "Boolean actions"
"""The aspect that tells when variables that are actions of a chart are written, and which of them other code writes."""
ALONE, TOGETHER = "", "one for all"
"""Controls of an action: one that acts for its step alone, as statements in place do too, and one for all its steps."""
PLAIN_VARIABLES = "plain variables"
"""The aspect that lists variables of a chart of another tool whose names are parameters of charts of S7-GRAPH."""
STABILITY, START = "search for stability", "start of several sequences"
"""Subject of items that tell that charts of a GRAFCET evolve once in a scan, and begin with a step of their own."""
SELECTION = "selection"
"""Subject of items that tell of steps which several transitions of a GRAFCET leave together."""
FIRST_SCAN = "first scan"
"""Subject of items that tell what the target does not do in the scan in which it starts."""
HIDDEN_FLAG = "flag of the initial step"
"""Subject of items that tell that another step of the result is active in place of the initial one, whose flag nothing
reads."""
SHOWN_STATE = "shown state"
"""The aspect that lists outputs by which a chart of S7-GRAPH tells its state."""
OPERATING_INPUT = "operating input"
"""The kind of parts that are inputs which operate a chart of S7-GRAPH, such as INIT_SQ."""
UNUSED_INPUT = "unused operating input"
"""The kind of those that nothing in the project operates, although it has an instance of the block."""
RESTING_INPUT = "operating input at rest"
"""The kind of inputs that the user states to be inactive."""
OPERATING_KINDS = frozenset({OPERATING_INPUT, UNUSED_INPUT, RESTING_INPUT})


class BooleanActions(NamedTuple):
    """Variables that are actions of a chart, by their plain names, and when they are written.

    `rules`: when the steps that act do so, in words, and when, if only others than the chart are looked at. `by_code`:
    the variables that statements of the POU write, too, those of excluded steps with them; `elsewhere`: those that only
    other POUs write. `spelled`: the names as the chart has them.
    """

    rules: dict[str, tuple[str, str]]
    by_code: frozenset[str]
    elsewhere: frozenset[str]
    spelled: dict[str, str]


def told_flag(flag: SfcFlag) -> tuple[str, str]:
    """Return the subject and the place, below the chart, of items about an SFC flag."""
    return (OPERATING_INPUT, flag.variable) if flag in OPERATING_FLAGS else (flag.variable, "")


UNDECLARED_TYPE = "undeclared type"
"""The kind of parts that are names of types which nothing declares."""
PROGRAM_CALL = "call of a program"
"""The kind of parts that are calls of programs, or uses of their variables from outside, as CODESYS has them."""


class Detail(IntEnum):
    """Detail in which a tree tells of a project."""

    EXECUTED = 0
    """The parts that a controller executes, by what they do: conversions are compared by that."""
    MEANT = 1
    """Also what people and tools look at: comments, excluded elements, times of alarms, all types."""
    WRITTEN = 2
    """The same as the file states it: qualifiers by name, and what is called by its name and not by what it does."""


class Key(NamedTuple):
    """Key of a part among its neighbours: its kind and its name, and which of several that are alike."""

    kind: str
    name: str
    number: int = 0


@dataclass(slots=True)
class Part:
    """A part of a project that is executed. `path` is the place in the words of reports (``POU Main / step Fill``).

    Of a transition, `leaves` are the names of the steps that it leaves, as in their keys, and `waiting` is its
    condition together with their minimum times. Of a project, `lists` are the names of its lists of global variables,
    `listed` tells of the variables in these how many have one of that name, `programs` are the names of its programs,
    and `boxes` those of what its networks draw. Of a name that nothing declares,
    `is_called`: it is that of a function. Of a chart of S7-GRAPH, `parameters` are the casefolded names of the
    variables that operate it or show its state. Of a step, `order` are the keys of the transitions that leave it, in
    the order in which they are tried. `subject` is the object of the model, where one has the name of the part.
    """

    path: str
    aspects: dict[str, Meaning] = field(default_factory=dict)
    parts: dict[Key, Part] = field(default_factory=dict)
    leaves: tuple[str, ...] = ()
    waiting: Meaning | None = None
    lists: frozenset[str] = frozenset()
    listed: Mapping[str, int] | None = None
    programs: frozenset[str] = frozenset()
    parameters: frozenset[str] = frozenset()
    boxes: frozenset[str] = frozenset()
    is_called: bool = False
    order: tuple[Key, ...] = ()
    subject: NamedObject | None = field(default=None, repr=False, compare=False)
    _steps: dict[str, list[Part]] = field(default_factory=dict, repr=False, compare=False)
    _steps_of: int = field(default=0, repr=False, compare=False)
    _counts: dict[tuple[str, str], int] = field(default_factory=dict, repr=False, compare=False)

    def steps_named(self, name: str) -> list[Part]:
        """Return the steps of a chart that have a plain name."""
        if self._steps_of != len(self.parts):
            self._steps_of, self._steps = len(self.parts), {}
            for key, part in self.parts.items():
                if key.kind == "step":
                    self._steps.setdefault(key.name, []).append(part)
        return self._steps.get(name, [])

    def tell(self, aspect: str, meaning: Meaning | None) -> None:
        """Note an aspect; None is nothing to note."""
        if meaning is not None:
            self.aspects[aspect] = meaning

    def add(self, kind: str, name: str, path: str, subject: NamedObject | None = None) -> Part:
        """Return a new part inside this one; the name of a transition is made of plain names of steps."""
        plain = name if kind == "transition" else plain_name(name)
        number = self._counts.get((kind, plain), 0)
        self._counts[kind, plain] = number + 1
        part = self.parts[Key(kind, plain, number)] = Part(path, subject=subject)
        return part


@lru_cache(maxsize=16384)  # several passes over a chart ask for the same names
def plain_name(name: str) -> str:
    """Return a name to compare, as all tools could spell it: they know different quotes and signs in names."""
    return shown_name(name).casefold()


def shown_name(name: str) -> str:
    """Return the same name with its upper and lower case."""
    return _SIGNS.sub("_", name.replace('"', "").removeprefix("#"))


_SIGNS = re.compile(r"(?:[^\w.]|_)+")


def duration_meaning(text: str | None) -> Meaning | None:
    """Return a time as it is compared; None where there is none."""
    return literal_meaning(text) if text and text.strip() else None
