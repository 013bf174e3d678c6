"""Code in C among statements, ``{{ .. }}`` of Beremiz and OpenPLC: kept, and never taken for nothing."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LoweringError, SimulationError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_declarations, parse_expression, parse_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.translation import translate
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import Outcome

SOURCE = """{{ #include "drive.h" }}
PROGRAM Main
VAR {{ static int calls; }}
  x : INT; {{ /* more */ }}
  go : BOOL;
END_VAR
x := x + 1;
{{ SetFbVar(X, "a}b"); }}
IF go THEN {{ stop(); }} END_IF;
END_PROGRAM
"""
CHART = """PROGRAM Main
VAR go : BOOL; q : BOOL; END_VAR
INITIAL_STEP A:
  Run(N);
END_STEP
STEP B:
END_STEP
TRANSITION FROM A TO B := go; END_TRANSITION
TRANSITION FROM B TO A := NOT go; END_TRANSITION
ACTION Run:
  q := go;
  {{ drive(); }}
END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ('{{ f("}"); }}\nx := 1;', [n.EmbeddedCode, n.Assignment]),
        ("x := 1; {{ f(); }} y := 2;", [n.Assignment, n.EmbeddedCode, n.Assignment]),
        ("IF a THEN {{ f(); }} ELSE {{ g(); }} END_IF;", [n.If]),
        ("CASE a OF 1: {{ f(); }} 2: b := 1; END_CASE;", [n.Case]),
    ],
)
def test_it_is_a_statement(text: str, kinds: list[type]) -> None:
    parsed = parse_statements(text)
    assert parsed.problems == ()
    assert [type(statement) for statement in parsed.tree.statements] == kinds
    again = parse_statements(print_node(parsed.tree))
    assert [type(statement) for statement in again.tree.statements] == kinds


def test_elsewhere_it_is_a_pragma_or_an_error() -> None:
    assert parse_declarations("VAR {{ int c; }} x : INT; {{ }} END_VAR").problems == ()
    assert parse_expression("a AND {{ f() }}").problems
    assert parse_statements("x := {{ 1 }};").problems


def test_a_text_keeps_it_everywhere() -> None:
    project = sfc.loads(SOURCE.encode())
    assert project.diagnostics == ()
    assert sfc.check_syntax(project) == []
    assert sfc.dumps(project) == SOURCE.encode()
    fresh = sfc.dumps(project, fresh=True)
    assert sfc.loads(fresh).pous == project.pous
    for code in ('#include "drive.h"', "static int calls;", "/* more */", 'SetFbVar(X, "a}b");', "stop();"):
        assert f"{{{{ {code} }}}}".encode() in fresh
    project.rename("Main.x", "count")
    assert sfc.dumps(project).decode() == SOURCE.replace("x : INT", "count : INT").replace("x := x", "count := count")


def test_it_is_not_run() -> None:
    with pytest.raises(SimulationError, match=r"code in C is not known.*SetFbVar"):
        sfc.simulate(sfc.loads(SOURCE.encode()), scans=1)
    with pytest.raises(SimulationError, match=r"code in C is not known.*drive\(\)"):
        sfc.simulate(sfc.loads(CHART.encode()), scans=1)


def test_it_is_not_lowered() -> None:
    with pytest.raises(LoweringError, match="code in C"):
        sfc.lower(sfc.loads(CHART.encode()), "case", target="iec-text")


def test_it_is_not_translated_without_a_word() -> None:
    project = sfc.loads(SOURCE.encode())
    translated = translate(parse_statements("x := 1; {{ f(); }}"), Dialect.SCL)
    assert not translated.exact
    assert "{{ f(); }}" in translated.text
    for target in ("codesys", "simaticml", "scl"):
        report = sfc.convert(project, target, partial=True)[1]
        assert [item for item in report.losses if "code in C" in f"{item.what} {item.why}"], target
    report = sfc.convert(project, "plcopen")[1]
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
