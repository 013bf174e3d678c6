"""Messages of readers, of runs that end with an error, reasons in findings and in reports have their German.

All of them, as they are in the code.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from plcopen_sfc.pages.page_words import Words

PACKAGE = Path(__file__).resolve().parents[2] / "plcopen_sfc"
ROOMS = ("formats", "documents", "model", "analysis", "languages", "conversion", "refactor", "lowering")
"""Where findings of a page, and items of reports come from."""
RUNS = ("semantics", "languages")
"""Where the errors of a run come from."""
CODE = re.compile(r"(?!XSD|IMP|LNG)[A-Z]{3}\d{3}")
"""Codes of findings; not of those that `validate` alone tells."""
REASONS = {"ConditionError", "Problem", "_doubt", "_unknown", "DamagedError"}
"""What is called with a message that becomes a part of a finding."""
FAILURES = {
    "CompetingTransitionsError",
    "ForcingConflictError",
    "SimulationError",
    "UnknownBehaviourError",
    "UnknownFunctionError",
    "UnstableChartError",
    "LiteralError",
    "NetworkProblem",
    "missing_time",
    "problem",
    "_refusing",
    "_said",
}
"""What is called with why a run ends with an error."""
FILLINGS = (
    "'x'",
    "3",
    "",
    "step",
    "body",
    "entry",
    "comment",
    "has no number",
    "is wired to 2 steps",
    "the source tests no transition in its first scan",
    "the source tests no transition of a chart in the scan that calls it first",
)
NEVER = (
    "`\0`\0 is not executed",
    "than in;",
    "than in\0",
    "in this step S7-GRAPH",
    "has written \0 S7-GRAPH",
    "drives \0 S7-GRAPH",
    "write \0 S7-GRAPH",
)
"""Beginnings and ends that are found in one function and never put together."""
ENGLISH = re.compile(
    r"\b(?:and|are|be|been|cannot|has|have|is|it|its|not?|of|one|only|or|that|the|there|this|to|too|which|with)\b"
)


def texts(node: ast.expr | None, scope: ast.AST, deep: int = 0) -> Iterator[str]:
    """The texts that an expression can be, with a zero byte for each value that is not known here."""
    match node:
        case ast.Constant(str(text)):
            yield text
        case ast.JoinedStr(values):
            nodes = (each.value if isinstance(each, ast.FormattedValue) else each for each in values)
            parts = (list(texts(each, scope, deep + 1)) or ["\0"] for each in nodes)
            yield from ("".join(text or "\0" for text in each) for each in product(*parts))
        case ast.IfExp(_, body, orelse):
            yield from (*texts(body, scope, deep + 1), *texts(orelse, scope, deep + 1))
        case ast.BinOp(left, ast.Add(), right):
            sides = (list(texts(side, scope, deep + 1)) or ["\0"] for side in (left, right))
            yield from map("".join, product(*sides))
        case ast.Name(name) if deep < 3:
            for each in ast.walk(scope):
                if isinstance(each, ast.Assign) and any(isinstance(t, ast.Name) and t.id == name for t in each.targets):
                    yield from texts(each.value, scope, deep + 1)


def is_code(argument: ast.expr) -> bool:
    is_text = isinstance(argument, ast.Constant) and isinstance(argument.value, str)
    return is_text and CODE.fullmatch(argument.value) is not None


def is_outcome(argument: ast.expr) -> bool:
    return isinstance(argument, ast.Attribute) and getattr(argument.value, "id", "") == "Outcome"


def messages(module: Path, *, of: str) -> Iterator[str]:
    """The messages of the findings, of items of reports, or of runs that fail, that a module makes."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    functions = [each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef)]
    for call in (each for each in ast.walk(tree) if isinstance(each, ast.Call)):
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        if of == "reports":
            begins = next((number for number, each in enumerate(call.args) if is_outcome(each)), None)
        elif of == "runs":
            begins = -1 if name in FAILURES else None
        else:
            begins = next((number for number, each in enumerate(call.args) if is_code(each)), None)
            begins = -1 if begins is None and name in REASONS else begins
        if begins is None:
            continue
        around = [each for each in functions if each.lineno <= call.lineno <= (each.end_lineno or 0)]
        scope = max(around, key=lambda each: each.lineno, default=tree)
        for argument in call.args[begins + 1 :]:
            # a text that ends with a blank is gone on with elsewhere
            yield from (text for text in texts(argument, scope) if " " in text.strip("\0 ") and text[-1] != " ")


def is_german(told: str) -> bool:
    return not ENGLISH.search(re.sub(r"'[^']*'|`[^`]*`|\([^)]*\)", "", told))


def _filled(text: str) -> Iterator[str]:
    for each in FILLINGS:
        for end in ("", ": it is never executed, and left out where the file is written for another one"):
            yield text.replace("\0", each) + end
            yield text.removesuffix("\0").replace("\0", each) + end


@pytest.mark.slow
@pytest.mark.parametrize(
    ("of", "rooms", "least"), [("findings", ROOMS, 160), ("reports", ROOMS, 400), ("runs", RUNS, 170)]
)
def test_every_message_has_its_german(of: str, rooms: tuple[str, ...], least: int) -> None:
    words = Words("de")
    modules = [module for room in rooms for module in (PACKAGE / room).rglob("*.py")]
    found = {text for module in modules for text in messages(module, of=of)}
    assert len(found) > least
    missing = []
    for text in found:
        is_path = any(words.place(text.removeprefix("\0")) != text for text in (text, text.replace("\0", "x")))
        if is_path or text.startswith("POU ") or any(each in f"{text}\0" for each in NEVER):
            continue
        # what only says what is wrong with a thing is told behind its name
        filled = (begin + each for begin in ("", "x ") for each in _filled(text))
        if not any(is_german(told) and told != each for each in filled for told in [words.message(each)]):
            missing.append(text.replace("\0", "{}"))
    assert "\n".join(sorted(missing)) == ""


def test_every_text_has_one_german() -> None:
    for path in sorted((PACKAGE / "pages" / "german").glob("*.json")):
        pairs: list[tuple[str, object]] = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=list)
        names = [name for name, _ in pairs]
        assert sorted(names) == sorted(set(names)), path.name
