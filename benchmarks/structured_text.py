"""Structured text that is measured: all of the corpus, and generated sources of any size; parsed by us and by blark.

What is measured lies in a JSON file, a list of texts with their kind and dialect, so that every contestant reads it in
a process of its own.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from plcopen_sfc.languages.st import parse_condition, parse_declarations, parse_expression, parse_statements, parsing
from plcopen_sfc.model.dialect import Dialect

Source = tuple[str, str, str]
"""Kind (``statements``, ``expression``, ``condition``, ``declarations``), dialect and text."""

PARSERS = {
    "statements": parse_statements,
    "expression": parse_expression,
    "condition": parse_condition,
    "declarations": parse_declarations,
}
STARTS = {"expression": "whole_expression"}
"""The rules of the grammar that have another name than the kind of text."""


def megabytes(sources: Iterable[Source]) -> float:
    """How many 10^6 bytes the texts have in UTF-8."""
    return sum(len(text.encode("utf-8", "surrogatepass")) for _, _, text in sources) / 1e6


def write(path: Path, sources: Iterable[Source]) -> Path:
    """Put texts into a file."""
    path.write_text(json.dumps(list(sources)), "ascii")
    return path


def read(path: Path) -> list[Source]:
    """The texts of a file, and everything imported and compiled. Not measured."""
    return [(kind, dialect, text) for kind, dialect, text in json.loads(path.read_text("ascii"))]


def parse(sources: list[Source]) -> list[Any]:
    """Every text, as the library parses it: equal short texts once."""
    return [PARSERS[kind](text, Dialect(dialect)) for kind, dialect, text in sources]


def parse_anew(sources: list[Source]) -> list[Any]:
    """Every text, equal ones again and again."""
    return [parsing._fresh_parse(text, Dialect(dialect), STARTS.get(kind, kind)) for kind, dialect, text in sources]


def for_blark(path: Path) -> tuple[Any, list[Source]]:
    """The parser of blark and the texts. Not measured."""
    return import_module("blark.parse"), read(path)


def parse_blark(prepared: tuple[Any, list[Source]]) -> list[Any]:
    """The trees of lark that blark makes; its own objects, made of them by `transform`, are left out."""
    blark, sources = prepared
    return [blark.parse_source_code(text, starting_rule="statement_list").tree for _, _, text in sources]


def has_blark() -> bool:
    """Whether the package `blark` is installed."""
    try:
        import_module("blark.parse")
    except ImportError:
        return False
    return True


def corpus() -> list[Source]:
    """Every text of the corpus, as often as it stands there; none where there is no corpus or no pytest."""
    try:
        texts = import_module("tests.languages.st_corpus").corpus_texts()
    except ImportError:
        return []
    return [(each.kind.value, each.dialect.value, each.text) for each in texts]


def sample_for_blark(sources: Iterable[Source], size: int) -> tuple[list[Source], int]:
    """Bodies of CODESYS and TwinCAT from all of the corpus, about `size` bytes; how many of them blark refuses."""
    bodies = sorted({each for each in sources if each[0] == "statements" and each[1] in ("codesys", "twincat")})
    bodies = [each for each in bodies if len(each[2]) < 4000]
    step = max(1, int(megabytes(bodies) * 1e6 / size))
    chosen = bodies[::step]
    taken = [each for each in chosen if parse_blark((import_module("blark.parse"), [each]))[0] is not None]
    return taken, len(chosen) - len(taken)


def generated(size: float) -> str:
    """`size` megabytes of a program, always the same: assignments, calls, branches, loops and comments."""
    pieces: list[str] = []
    length = 0
    for number in _numbers():
        if length >= size * 1e6:
            break
        pieces.append(_PIECE.format(n=number, m=number % 17, k=number % 250))
        length += len(pieces[-1])
    return "".join(pieces)


def _numbers() -> Iterator[int]:
    number = 0
    while True:
        number += 1
        yield number


_PIECE = """\
// station {n}
IF bStart{n} AND NOT bFault{m} AND (iPressure{n} > 16#{k:X} OR rLevel[{m}] >= {k}.5) THEN
    tonFill{n}(IN := bValve{n} AND xAuto, PT := T#{k}ms, Q => bFilled{n});
    stData.aStation[{m}, iIndex + 1].rFlow := rFlow{n} * 1.25 - ABS(rOffset{m}) / 2.0;
ELSIF bReset THEN
    iState{n} := 0; (* back to the start *)
    FB_Motor{m}.Stop(bQuick := TRUE);
ELSE
    iCount{n} := iCount{n} + 1;
END_IF
CASE iState{n} OF
    0: bValve{n} := FALSE;
    1, 2..5: bValve{n} := tonFill{n}.Q XOR xTest;
ELSE
    sMessage := 'state {n} is unknown';
END_CASE
FOR i := 0 TO {m} BY 1 DO
    aSum[i] := aSum[i] + DINT_TO_REAL(diValue{n});
END_FOR

"""
