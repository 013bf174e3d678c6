"""Files that were merged line by line: what neither side has changed so, and what a name means now.

Lines of both sides may fit together and the programs not: a name of one side is hidden by a new variable of the other
one, or two steps are initial.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from plcopen_sfc.analysis.checks import check_charts
from plcopen_sfc.comparison.changes import Change, ChangeKind
from plcopen_sfc.comparison.project_comparison import diff
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model.project import Project


class Versions(NamedTuple):
    """A file as it was before both sides changed it, and as they have it."""

    base: Project
    ours: Project
    theirs: Project


def merge_faults(merged: Project, versions: Versions, changes: Sequence[Sequence[Change]]) -> set[str]:
    """Return the faults of a merged file, in words: what neither side has, or only one, and is not meant so.

    `changes`: those that each of the two sides has made.
    """
    told = _errors(merged) - _errors(versions.base) | _unlike(diff(versions.base, merged).changes, changes)
    told |= _new_findings(merged, versions)
    names = [Names(each) for each in (merged, *versions)]
    lost = _undeclared(names[0]) - _undeclared(names[2]) - _undeclared(names[3])
    told |= {f"{each!r} is named, and nothing declares it" for each in lost}  # one side renamed it
    told |= _declared_twice(merged) - _declared_twice(versions.ours)  # both sides added it
    return told | set(_other_meanings(names))


def _errors(project: Project) -> set[str]:
    return {str(each) for each in project.diagnostics if each.severity is Severity.ERROR}


def _unlike(found: Sequence[Change], sides: Sequence[Sequence[Change]]) -> set[str]:
    """Return the changes of a merged file that are missing or of no side.

    Of one text both sides may have changed lines: the merged one has the changed lines of both, and no others.
    """
    say = _in_new_names([each for side in sides for each in side])

    def place(change: Change) -> tuple[str, str, str]:
        return say(change.path), change.what, change.aspect

    def lines(change: Change) -> set[str]:
        return {say(line) for line in change.lines if line.startswith(("+", "-"))}

    def words(change: Change) -> str:
        is_renamed = change.kind is ChangeKind.RENAMED  # whose old name stays
        return f"{say(change.place)}: {change.news}" if is_renamed else say(str(change))

    ours, theirs = ({place(each): lines(each) for each in side} for side in sides)
    both = {where: ours[where] | theirs[where] for where in ours if ours[where] and theirs.get(where)}
    fits = {place(each) for each in found if lines(each) == both.get(place(each))}
    told, wanted = (
        {words(each) for each in changes if place(each) not in fits}
        for changes in (found, [each for side in sides for each in side])
    )
    return {f"lacks {each}" for each in wanted - told} | {f"of no side: {each}" for each in told - wanted}


def _in_new_names(changes: Sequence[Change]) -> Callable[[str], str]:
    """Return the function that gives a text the names that things have after both sides renamed some.

    A side that knows nothing of that tells its changes with the old ones.
    """
    names = {each.before: each.after or "" for each in changes if each.kind is ChangeKind.RENAMED and each.before}
    if not names:
        return str
    pattern = re.compile(rf"(?<!\w)(?:{'|'.join(map(re.escape, names))})(?!\w)")
    return lambda text: pattern.sub(lambda found: names[found[0]], text)


def _new_findings(merged: Project, versions: Versions) -> set[str]:
    """Return the errors and warnings of `check` in a merged file that neither side has.

    One that a side brought may have other words, where the other side renamed what it names.
    """
    found, base, *sides = (dict(_findings(each)) for each in (merged, *versions))
    known = {text: code for side in sides for text, code in side.items()}
    gone = Counter(code for text, code in known.items() if text not in found and text not in base)
    new = {text: code for text, code in found.items() if text not in known}
    counts = Counter(new.values())
    return {text for text, code in new.items() if counts[code] > gone[code]}


def _findings(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the errors and warnings of `check` in words, each with its code."""
    for found in check_charts(project):
        if found.severity is not Severity.INFO:
            yield f"{found.location.path or ''}: {found.code} {found.message}", found.code


def _undeclared(names: Names) -> set[str]:
    """Return the names in program text of a file that it does not declare."""
    return {each.reference.name for each in (*names.undeclared(), *names.undeclared_members())}


def _declared_twice(project: Project) -> set[str]:
    """Return the things of a file whose names others of their kind have, in words."""
    return {
        f"{pou.report_path}: a second {word} {thing.name}"
        for pou in project.pous
        for word, thing, _ in pou.declared_twice()
    }


class _Meaning(NamedTuple):
    """What a name in a text means: the path of its declaration, empty for what is not in the file."""

    name: str
    path: str
    is_local: bool


def _meanings(names: Names) -> Counter[_Meaning]:
    """Return what the names in the texts of a file mean, each with how often."""
    found = Counter[_Meaning]()
    for each in names.everything:
        meant = each.meaning.declaration
        if not each.meaning.doubt:
            path = meant.path if meant is not None else ""
            found[_Meaning(each.reference.name.casefold(), path, meant is not None and meant.pou is not None)] += 1
    return found


def _other_meanings(names: Sequence[Names]) -> Iterator[str]:
    """Yield the names that mean something else after a merge: more mean the one than both sides have made so.

    Fewer mean another thing then that the file still declares, or that is in another file.
    """
    merged, base, ours, theirs = map(_meanings, names)
    declared = {each.path for each in names[0].declarations()}
    for meaning, count in merged.items():
        if count <= max(ours[meaning], theirs[meaning], ours[meaning] + theirs[meaning] - base[meaning]):
            continue
        for other in {*ours, *theirs}:
            is_lost = ours[other] + theirs[other] - base[other] > merged[other]
            is_there = other.path in declared if other.path else meaning.is_local
            if other.name == meaning.name and other != meaning and is_lost and is_there:
                before = other.path or "something of another file"
                yield f"{meaning.name!r} means {meaning.path or 'nothing of this file'}, and {before} on one side"
