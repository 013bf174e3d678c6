"""Renames in real files: only the name changes, all of it, and the programs mean what they did."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

import plcopen_sfc as sfc
import plcopen_sfc.model as m
from plcopen_sfc.errors import FormatError
from plcopen_sfc.languages.binding import Declaration, Kind, Names
from plcopen_sfc.languages.binding.text_sites import NAMELESS, NAMING
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, GRAPH_OUTPUTS
from plcopen_sfc.refactor.rename import rename
from plcopen_sfc.report import RenameResult
from tests.corpus import corpus_files
from tests.formats.simaticml.documents import real_documents
from tests.languages.binding.projects import meanings
from tests.samples import ALL_PARAMS, NEW, label, lines_of, params, real_files
from tests.sweeps import WHOLE, in_turn, some_of

SEED = 61131
SMALL = 100_000
KINDS = (Kind.STEP, Kind.VARIABLE, Kind.ACTION, Kind.POU, Kind.MEMBER, Kind.ENUM_VALUE, Kind.TRANSITION, Kind.METHOD)
OTHERS = (Kind.DATA_TYPE, Kind.GLOBAL_LIST, Kind.INSTANCE)
LARGE = [path for path in real_files() if path.stat().st_size > 3 * SMALL]
"""Of these there are several: in each, names of four kinds are renamed, in the next of others."""


def sample(made: m.Project, number: int, kinds: Sequence[Kind]) -> list[int]:
    """At most so many declarations of every kind, by their number."""
    chosen = random.Random(SEED)  # noqa: S311
    declarations = list(Names(made).declarations())
    picked: list[int] = []
    for kind in kinds:
        some = [index for index, declaration in enumerate(declarations) if declaration.kind is kind]
        picked += chosen.sample(some, min(number, len(some)))
    return picked


def allowed(names: Names, what: Declaration) -> bool:
    """True if charts do not know it by its name, and nothing beside it has this: else it is not said which is meant."""
    of_graph = what.pou is not None and what.pou.chart is not None and names.project.dialect is m.Dialect.SCL
    if what.name in {flag.variable for flag in m.SfcFlag} or (
        of_graph and what.name in {*GRAPH_INPUTS, *GRAPH_OUTPUTS}
    ):
        return False
    for level in names.levels():
        if what in level:
            same = [d for d in level.named(what.name) if d.kind is not Kind.TRANSITION]
            if len({names.resolver.original(declaration) for declaration in same}) > 1:
                return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("path", some_of(params(6), 2))
def test_renames_in_real_files(path: Path) -> None:
    check_renames(path, 2 if WHOLE and path.stat().st_size < SMALL else 1)


@pytest.mark.slow
@pytest.mark.parametrize("path", some_of(ALL_PARAMS[1:], 20))
def test_more_renames_in_real_files(path: Path) -> None:
    """More names of every kind, in every tenth file."""
    check_renames(path, max(2, min(6, 1_000_000 // path.stat().st_size)))


TEXTS = {".scl", ".s7dcl", ".sfc", ".txt", ".test"}
OTHER_FILES = [
    *real_documents(),
    *(path for kind in ("simaticml", "iectext") for path in corpus_files(kind) if path.suffix in TEXTS),
]


@pytest.mark.slow
@pytest.mark.corpus
@pytest.mark.parametrize("path", some_of(OTHER_FILES, 3), ids=label)
def test_renames_in_files_of_other_tools(path: Path) -> None:
    try:
        made = sfc.load(path)
    except FormatError:
        pytest.skip("no format that is read")
    if path.stat().st_size > 4 * SMALL:
        pytest.skip("smaller files are enough for this")
    check_renames(path, 2, lines=made.source is not None and made.source.format == "scl")


def check_renames(path: Path, most: int, *, lines: bool = True) -> None:
    data = path.read_bytes()
    made = sfc.loads(data)
    before, original = meanings(made), made.model_dump_json()
    kinds = in_turn((*KINDS, *OTHERS), LARGE.index(path), 4) if path in LARGE else (*KINDS, *OTHERS)
    for number in sample(made, most, kinds):
        names = Names(made)
        what = names.resolver.original(list(names.declarations())[number])
        if not what.name or not allowed(names, what):
            continue
        old = what.name
        result = rename(made, what, NEW)
        note = f"{what.kind} {result.path}"
        assert meanings(made) == before, note
        if lines and not is_reformatted(made):
            assert_only_lines_that_name_it(data, sfc.dumps(made), old, note)
        assert_nothing_is_left(made, old, result, note)
        rename(made, what, old)
        again = made.model_dump_json()
        assert again.casefold() == original.casefold(), note
        if again != original:  # uses are spelt as the declaration is now
            made = sfc.loads(data)
            before = meanings(made)


def is_reformatted(made: m.Project) -> bool:
    """True if blanks stand around names in the file, which are put in again where a name changes."""
    charts = [chart.chart for chart in made.charts()]
    return any(
        t.extension_data is not None and t.extension_data.data for c in charts for t in (*c.steps, *c.transitions)
    )


def assert_only_lines_that_name_it(before: bytes, after: bytes, old: str, note: str) -> None:
    """Line for line the same, but for the name in some."""
    old_lines, new_lines = lines_of(before), lines_of(after)
    assert len(old_lines) == len(new_lines), note
    changed = [(a, b) for a, b in zip(old_lines, new_lines, strict=True) if a != b]
    assert changed, note
    for line, new in changed:
        if 'rewritten"' in line or 'added"' in line:  # a digest of what was written, which names the step
            continue
        assert NEW in new, note
        text_sites = re.split(re.escape(old), line, flags=re.IGNORECASE)
        wanted = f"(?:{re.escape(old)}|{NEW})".join(re.escape(text_site) for text_site in text_sites)
        assert re.fullmatch(wanted, new, re.IGNORECASE), (note, line, new)


# -- what is left of the old name -------------------------------------------------------------------------------------

SILENT = re.compile(r"//[^\r\n]*|\(\*.*?\*\)|\{[^}]*\}|'(?:\$.|[^'$])*'|\"(?:\$.|[^\"$])*\"", re.DOTALL)
"""Comments, pragmas and strings."""


def assert_nothing_is_left(made: m.Project, old: str, result: RenameResult, note: str) -> None:
    """A search for the old word finds only comments, strings, other things, and what the result lists."""
    word = re.compile(rf"(?<![\w%]){re.escape(old)}(?!\w)", re.IGNORECASE)  # an address is no name: %IX2
    names = Names(made)
    explained: dict[tuple[int, str | int], int] = {}
    doubts = 0
    for occurrence in names.occurrences(old):
        meaning = occurrence.meaning
        assert meaning.declaration is None or meaning.declaration.name != NEW, note
        doubts += meaning.doubt != "" and meaning.candidates is None
        place = (id(occurrence.text_site.holder), occurrence.text_site.key)
        explained[place] = explained.get(place, 0) + 1
    assert doubts <= len(result.undecided), note
    if old.isdigit():  # a member of TIA Portal, which numbers in the text are not
        return
    nameless = set().union(*NAMELESS.values())
    for thing, key, text in texts(made):
        found = len(word.findall(SILENT.sub(" ", text)))
        field = f"{type(thing).__name__}.{key}"
        if found and field not in nameless and key not in ("comment", "object_id", "global_id"):
            assert type(thing) in NAMING, (note, field)
            assert explained.get((id(thing), key), 0) >= found or is_label(text, old), (note, field, text)


def is_label(text: str, word: str) -> bool:
    """True if a text has a label of this name, which belongs to it alone."""
    return (
        re.search(rf"(?:(?:JMP\w*|GOTO)\s+{word}\b|^\s*{word}\s*:(?!=))", text, re.IGNORECASE | re.MULTILINE)
        is not None
    )


def texts(thing: object) -> Iterator[tuple[object, str, str]]:
    """Every text in a model, with its object and field."""
    if isinstance(thing, Model):
        if isinstance(thing, m.SfcBody):
            thing.chart.read()
        for key, value in thing.__dict__.items():
            if isinstance(value, str) and key not in ("kind", "language"):
                yield thing, key, value
            else:
                yield from texts(value)
    elif isinstance(thing, list):
        for item in thing:
            yield from texts(item)
