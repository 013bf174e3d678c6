"""Every FBD and LD body, chart logic and condition of the fixtures and the corpus: to text, drawn again, read again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks.condition_reading import chart_statements, condition_expression
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules
from plcopen_sfc.languages.networks.network_drawing import draw_fbd, draw_ld
from plcopen_sfc.languages.networks.network_reading import body_statements
from plcopen_sfc.languages.networks.results import NetworkExpression, NetworkStatements
from plcopen_sfc.languages.networks.wires import normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model import (
    Body,
    BodyCondition,
    Expression,
    FbdBody,
    LdBody,
    NamedCondition,
    Pou,
    SfcBody,
    WiredCondition,
)
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import corpus_files, require_corpus
from tests.languages.networks.test_inverse import meant
from tests.samples import fixture_files, real_files

KINDS = {WiredCondition: "wired", NamedCondition: "named", BodyCondition: "body"}


class CorpusNetwork(NamedTuple):
    """A network of a file, as text."""

    file: str
    name: str
    kind: str
    dialect: Dialect
    read: NetworkStatements | NetworkExpression


def dialect_of(path: Path) -> Dialect:
    folders = {part.lower() for part in path.parts}
    if "simaticml" in folders:
        return Dialect.SCL
    return Dialect.CODESYS if {"codesys", "twincat"} & folders else Dialect.IEC


def bodies_in(body: Body | str | None, name: str) -> Iterator[tuple[str, FbdBody | LdBody]]:
    """The networks in a body, those of the steps of its chart included."""
    if isinstance(body, FbdBody | LdBody):
        yield name, body
    elif isinstance(body, SfcBody):
        for step in body.chart.steps:
            inner = [step.entry_action, step.main_action, step.exit_action, *(a.body for a in step.actions)]
            for one in [*inner, step.macro.body if step.macro is not None else None]:
                yield from bodies_in(one, f"{name}.{step.name}")
        for transition in body.chart.transitions:
            if isinstance(transition.condition, BodyCondition):
                yield from bodies_in(transition.condition.body, f"{name}.{transition.id}")


def networks_in(path: Path, pou: Pou, dialect: Dialect) -> Iterator[CorpusNetwork]:
    for name, _, body in pou.named_bodies():
        for inner, network in bodies_in(body, name):
            yield CorpusNetwork(path.name, inner, network.language, dialect, body_statements(network, dialect))
        if isinstance(body, SfcBody):
            chart = body.chart
            if chart.logic:
                yield CorpusNetwork(path.name, name, "chart logic", dialect, chart_statements(chart, dialect))
            for transition in chart.transitions:
                if transition.condition is not None and not isinstance(transition.condition, Expression):
                    read = condition_expression(chart, transition, dialect, transitions=pou.transitions)
                    kind = f"condition ({KINDS[type(transition.condition)]})"
                    yield CorpusNetwork(path.name, f"{name}: {chart.label(transition)}", kind, dialect, read)


@cache
def networks(corpus: bool) -> list[CorpusNetwork]:
    """Every network, each text of a network once."""
    found: dict[object, CorpusNetwork] = {}
    for path in real_files() if corpus else fixture_files():
        for pou in sfc.load(path).pous:
            for one in networks_in(path, pou, dialect_of(path)):
                found.setdefault((path.parent.name, path.name, one.name, one.kind, one.read.tree), one)
    return list(found.values())


def again(found: CorpusNetwork, *, ladder: bool) -> NetworkStatements:
    """A text drawn and read again. Of a condition, what must be executed before it is drawn too."""
    rules = DrawingRules(found.dialect, instances=found.read.instances)
    drawn = (draw_ld if ladder else draw_fbd)(statements_of(found).statements, rules)
    return body_statements(drawn.body, found.dialect)


def statements_of(found: CorpusNetwork) -> n.Statements:
    read = found.read
    if isinstance(read, NetworkStatements):
        return read.tree
    assert read.tree is not None
    return n.Statements((*read.before, n.Assignment(n.Name("Condition"), read.tree)))


def errors(found: CorpusNetwork) -> list[str]:
    return [problem.message for problem in found.read.problems if problem.severity is Severity.ERROR]


def unstable(all_networks: list[CorpusNetwork]) -> list[str]:
    """The networks that do not come back the same from being drawn."""
    failed = []
    for found in all_networks:
        for ladder in (False, True):
            second, first = again(found, ladder=ladder), statements_of(found)
            same = meant(second.tree) == meant(first) if ladder else normal_form(second.tree) == normal_form(first)
            if not same or second.helpers or not second.complete:
                failed.append(f"{found.file}: {found.name} as {'LD' if ladder else 'FBD'}")
    return failed


@pytest.mark.slow
def test_every_network_of_the_fixtures_is_stable() -> None:
    assert not unstable([found for found in networks(False) if found.read.tree is not None])  # else nothing is drawn


def test_what_of_the_fixtures_does_not_translate() -> None:
    assert {(found.name, message) for found in networks(False) for message in errors(found)} == {
        (name, message)
        for name in ("Mixer", "Mixer.ACT_Release")
        for message in (
            "an error of the tool that made the file: Unknown block PID_2 of library Control 1.4",
            "an element that only its tool understands: Trend recorder, 3 channels",
            "an input cannot set anything",
        )
    } | {("Mixer: Wait -> Wait", "the condition is wired to nothing")}


@pytest.mark.slow
@pytest.mark.corpus
def test_every_network_of_the_corpus_is_stable() -> None:
    require_corpus()
    assert not unstable(networks(True))


@pytest.mark.slow
@pytest.mark.corpus
def test_how_many_networks_of_the_corpus_are_said_completely() -> None:
    require_corpus()
    count = Counter(found.kind for found in networks(True))
    complete = Counter(found.kind for found in networks(True) if not errors(found))
    assert {kind: (complete[kind], count[kind]) for kind in count} == {
        "FBD": (16, 19),
        "LD": (12, 14),
        "chart logic": (5, 6),
        "condition (wired)": (9, 9),
        "condition (named)": (7, 7),
    }


DANGLING = "its value leads nowhere"
NOT_FED = "nothing leads to this contact; taken as connected to the left power rail"


@pytest.mark.corpus
def test_what_of_the_corpus_does_not_translate_and_why() -> None:
    """Networks that are drawn incompletely: a value that is wired to nothing, a contact without power."""
    require_corpus()
    failures = sorted({(found.file, found.name, message) for found in networks(True) for message in errors(found)})
    assert failures == [
        ("SFC_example_9.4_version2.xml", "sfc1", DANGLING),
        ("TC001.xml", "DEBOUNCE", DANGLING),
        ("TC001.xml", "functionBlock1", NOT_FED),
        ("TC001_failed.xml", "DEBOUNCE", DANGLING),
        ("TC001_failed.xml", "functionBlock1", NOT_FED),
        ("plc.xml", "plc_prg", DANGLING),
    ]


@pytest.mark.corpus
def test_what_of_the_corpus_is_assumed() -> None:
    require_corpus()
    assumed = {p.message for f in networks(True) for p in f.read.problems if p.severity is Severity.WARNING}
    assert assumed == {
        "a wire starts at the output 'isSorting' of element 26, which TOF does not have; taken as 'Q'",
        # the same POU in FBD has one negation here
        "its input 'EN' is negated, and so is contact 8 before it; both are counted",
    }


@cache
def networks_of_tia_portal() -> list[CorpusNetwork]:
    """Every network of TIA Portal, each text once."""
    found: dict[object, CorpusNetwork] = {}
    for path in corpus_files("simaticml"):
        try:
            project = sfc.load(path)
        except sfc.FormatError:
            continue  # parts of documents, and pages about them
        for pou in project.pous:
            for one in networks_in(path, pou, Dialect.SCL):
                found.setdefault((one.kind, one.read.tree), one)
    return list(found.values())


@pytest.mark.corpus
@pytest.mark.slow
def test_networks_of_tia_portal_are_said_and_stable() -> None:
    require_corpus()
    found = networks_of_tia_portal()
    count = Counter(one.kind for one in found)
    complete = Counter(one.kind for one in found if not errors(one))
    assert {kind: (complete[kind], count[kind]) for kind in count} == {
        "LD": (71, 71),
        "FBD": (13, 15),
        "condition (body)": (40, 40),
    }
    # its text comes back the same, but needs the same variables for results of calls as before
    assert {one.split(".xml")[0] for one in unstable(found)} == {"b5a54b0008e27f432071d0537cccc31f61cb373c"}
