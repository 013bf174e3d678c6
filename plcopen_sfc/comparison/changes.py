"""The result of comparing two projects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby
from typing import TYPE_CHECKING, Any

from plcopen_sfc.object_path import ObjectPath

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Verdict


class ChangeKind(StrEnum):
    """Kinds of changes."""

    ADDED = "added"
    REMOVED = "removed"
    RENAMED = "renamed"
    """It has another name; its references elsewhere, which follow, are no changes."""
    MOVED = "moved"
    """It is the same at another place."""
    CHANGED = "changed"
    LAYOUT = "layout"
    """Nothing that is executed: positions, and program text that means the same."""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of one thing.

    `path` is its place in the words of reports (``POU Main / step Fill``) with the names of the second project; of what
    was removed, of the first. `what` is the kind of thing (``step``), `aspect` what has changed of it (``maximum
    time``), empty for the whole thing. `before` and `after` are as people read them; None: nothing is there. Of what
    was added or removed, they tell it in short. `lines` is the difference of program text, as `difflib` writes it.
    `path_before` and `path_after` are the places in the first and the second project that are not `path`: of what has
    moved, and of transitions that lead elsewhere.
    """

    kind: ChangeKind
    path: str
    what: str
    aspect: str = ""
    before: str | None = None
    after: str | None = None
    lines: tuple[str, ...] = ()
    path_before: str = ""
    path_after: str = ""

    @property
    def place(self) -> str:
        """The thing and where it is: ``POU Main / step Fill``; never without its kind."""
        path = ObjectPath.of(self.path)
        is_told = not self.what or path.last.startswith(f"{self.what} ") or path.last == self.what
        return path if is_told else path.around / f"{self.what} {path.last}"

    @property
    def news(self) -> str:
        """Return the change, without its place."""
        return self.told(str)

    def told(self, say: Callable[[str], str]) -> str:
        """Return the change in the words of a language: `say` translates words and templates with ``{}``."""
        match self.kind:
            case ChangeKind.ADDED | ChangeKind.REMOVED:
                told = self.after if self.kind is ChangeKind.ADDED else self.before
                return say(f"{self.kind} ({{}})").format(say(told)) if told else say(self.kind.value)
            case ChangeKind.RENAMED:
                return say("renamed, was {}").format(self.before) if self.before else say("named {}").format(self.after)
            case ChangeKind.MOVED:
                return say("moved {} -> {}").format(say(f"{self.before}"), say(f"{self.after}"))
        aspect = say(self.aspect)
        if self.lines:
            return say("{} added" if self.before is None else "{} removed" if self.after is None else "{}").format(
                aspect
            )
        if self.before == self.after:
            is_program = "\n" in (self.before or "\n") or self.aspect.startswith("code")
            told = (
                say("differs in what is no text") if is_program else say("{} means something else").format(self.before)
            )
            return f"{aspect} {told}"
        if self.aspect in (*_TELL_THEMSELVES, self.before, self.after):
            before, after = (say(f"{each}") for each in (self.before, self.after))
            one_is_missing = after if self.before is None else say("no longer {}").format(before)
            return one_is_missing if None in (self.before, self.after) else f"{before} -> {after}"
        if self.before is None:
            return say("{} added").format(f"{aspect} {self.after}")
        if self.after is None:
            return say("{} removed").format(f"{aspect} {self.before}")
        return f"{aspect} {self.before} -> {self.after}"

    def __str__(self) -> str:
        """One line; the lines of program text follow."""
        return "\n".join([f"{self.place}: {self.news}", *(f"    {line}" for line in self.lines)])

    def as_dict(self) -> dict[str, Any]:
        """Return the change as plain data, for JSON."""
        data: dict[str, Any] = {"kind": self.kind.value, "path": self.path, "what": self.what}
        for name in ("aspect", "before", "after", "path_before", "path_after"):
            if getattr(self, name):
                data[name] = getattr(self, name)
        return data | ({"lines": list(self.lines)} if self.lines else {})


_TELL_THEMSELVES = frozenset(
    {"initial", "excluded", "negation", "retain", "constant", "persistent", "static", "kept", "union"}
)
"""Aspects whose values tell what they are."""


@dataclass(frozen=True, slots=True)
class Proof:
    """Proof that something changed still does the same: the `verdict`, or why there is none.

    `reason` with a verdict is what it holds for.
    """

    path: str
    verdict: Verdict | None = None
    reason: str = ""

    @property
    def equal(self) -> bool:
        """True if it does the same: by proof, or in runs that reached all of it."""
        return self.verdict is not None and self.verdict.equal

    def __str__(self) -> str:
        if self.verdict is None:
            return f"{self.path}: not compared: {self.reason}"
        return f"{self.path}: {self.verdict}" + (f"\n{self.reason}" if self.reason else "")

    def as_dict(self) -> dict[str, Any]:
        """Return the proof as plain data, for JSON."""
        told = {"reason": self.reason} if self.reason else {}
        return {"path": self.path, **({} if self.verdict is None else {"verdict": self.verdict.as_dict()}), **told}


@dataclass(frozen=True, repr=False)
class ProjectDiff:
    """The changes from one project to another, in the order of the first. `proofs` are those that were asked for."""

    changes: tuple[Change, ...]
    proofs: tuple[Proof, ...] = ()

    @property
    def equal(self) -> bool:
        """True if there is no change but of the layout."""
        return all(change.kind is ChangeKind.LAYOUT for change in self.changes)

    def __len__(self) -> int:
        """Number of changes; without any, a comparison is false in a condition."""
        return len(self.changes)

    def __iter__(self) -> Iterator[Change]:
        """Yield the changes."""
        return iter(self.changes)

    def grouped(self) -> Iterator[tuple[str, list[Change]]]:
        """Yield each outermost thing (``POU Main``) that has changes in it, with these."""
        for owner, changes in groupby(self.changes, key=lambda change: ObjectPath.of(change.path).owner):
            yield owner, list(changes)

    def __repr__(self) -> str:
        counts = Counter(change.kind.value for change in self.changes)
        return f"ProjectDiff({', '.join(f'{count} {kind}' for kind, count in counts.items()) or 'no changes'})"

    def text(self) -> Iterator[tuple[str, ChangeKind | None]]:
        """Yield the result as lines, a block for each POU, each with the kind of its change if it tells one."""
        for owner, changes in self.grouped():
            is_alone = all(change.path == owner for change in changes)
            if not is_alone:
                yield owner, None
            for change in changes:
                place = change.place if is_alone else f"  {ObjectPath.of(change.place).inside(owner)}"
                yield f"{place}: {change.news}" if place.strip() else f"  {change.news}", change.kind
                yield from ((f"    {line}", None) for line in change.lines)
        for proof in self.proofs:
            yield from ((line, None) for line in str(proof).splitlines())
        if not self.changes:
            yield "no differences", None

    def __str__(self) -> str:
        """A block for each POU: a line for each change."""
        return "\n".join(line for line, _ in self.text())

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain data, for JSON."""
        return {
            "equal": self.equal,
            "changes": [change.as_dict() for change in self.changes],
            "proofs": [proof.as_dict() for proof in self.proofs],
        }
