"""The order in which the elements of a network are executed, for a tool that looks at no places."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.st import print_node

HEAD = (
    '<project xmlns="http://www.plcopen.org/xml/tc6_0201"><fileHeader companyName="" productName="" productVersion=""'
    ' creationDateTime="2020-01-01T00:00:00"/><contentHeader name=""><coordinateInfo><fbd><scaling x="1" y="1"/></fbd>'
    '<ld><scaling x="1" y="1"/></ld><sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader><types>'
    '<dataTypes/><pous><pou name="Main" pouType="functionBlock"><interface><inputVars><variable name="a"><type><BOOL/>'
    '</type></variable></inputVars><outputVars><variable name="q"><type><BOOL/></type></variable><variable name="q2">'
    "<type><BOOL/></type></variable></outputVars></interface><body><FBD>"
)
TAIL = "</FBD></body></pou></pous></types><instances><configurations/></instances></project>"


def wired(number: int, top: int, order: str, source: str, target: str) -> str:
    """An input variable that is wired to an output variable."""
    return (
        f'<inVariable localId="{number}"><position x="0" y="{top}"/><connectionPointOut/><expression>{source}'
        f'</expression></inVariable><outVariable localId="{number + 1}"{order}><position x="100" y="{top}"/>'
        f'<connectionPointIn><connection refLocalId="{number}"/></connectionPointIn><expression>{target}</expression>'
        "</outVariable>"
    )


def statements(data: bytes, *, as_tool: bool = False) -> str:
    project = sfc.loads(data, as_tool=as_tool)
    return " ".join(print_node(body_statements(project.pou("Main").bodies[0], project.dialect).tree).split())


@pytest.mark.parametrize("tops", [(10, 20), (20, 10)])
@pytest.mark.parametrize("orders", [("", ""), (1, 2), (2, 1)])
def test_elements_are_executed_by_codesys_in_the_order_of_the_source(
    tops: tuple[int, int], orders: tuple[int | str, int | str]
) -> None:
    first, second = (f' executionOrderId="{order}"' if order else "" for order in orders)
    drawn = wired(1, tops[0], first, "a", "q") + wired(3, tops[1], second, "q", "q2")
    source = (HEAD + drawn + TAIL).encode()
    written = statements(source)
    assert written in ("q := a; q2 := q;", "q2 := q; q := a;")
    data, report = sfc.convert(sfc.loads(source), "codesys")
    assert not report.losses
    placeless = re.sub(rb'<position x="[^"]*" y="[^"]*"', b'<position x="0" y="0"', data)
    assert statements(placeless, as_tool=True) == written
    unnumbered = re.sub(rb' executionOrderId="[^"]*"', b"", placeless)
    assert statements(unnumbered, as_tool=True) == written
