"""Small PLCopen XML projects around a snippet, for tests that look at one element."""

from __future__ import annotations

import plcopen_sfc as sfc
from plcopen_sfc.model import Project, SfcNetwork

NAMESPACES = {
    "1.01": "http://www.plcopen.org/xml/tc6.xsd",
    "2.0": "http://www.plcopen.org/xml/tc6_0200",
    "2.01": "http://www.plcopen.org/xml/tc6_0201",
}
CODESYS = "http://www.3s-software.com/plcopenxml/"


def project(
    pous: str = "",
    *,
    version: str = "2.01",
    types: str = "",
    instances: str = "",
    end: str = "",
    header: str = "",
    product: str = "Test",
    release: str = "1",
) -> bytes:
    """A whole file."""
    return f"""<?xml version="1.0" encoding="utf-8"?>
<project xmlns="{NAMESPACES[version]}" xmlns:xhtml="http://www.w3.org/1999/xhtml">
  <fileHeader companyName="" productName="{product}" productVersion="{release}" creationDateTime="2024-01-31T08:30:00"/>
  <contentHeader name="Test">
    <coordinateInfo>
      <fbd><scaling x="1" y="1"/></fbd>
      <ld><scaling x="1" y="1"/></ld>
      <sfc><scaling x="1" y="1"/></sfc>
    </coordinateInfo>{header}
  </contentHeader>
  <types>
    <dataTypes>{types}</dataTypes>
    <pous>{pous}</pous>
  </types>
  <instances>
    <configurations>{instances}</configurations>
  </instances>{end}
</project>
""".encode()


def pou(content: str, *, name: str = "Main", kind: str = "program", more: str = "") -> str:
    return f'<pou name="{name}" pouType="{kind}"{more}>{content}</pou>'


def chart(*elements: str) -> str:
    """A program whose body is a chart."""
    return pou(f"<body><SFC>{''.join(elements)}</SFC></body>")


def source(*ids: int | str, pin: str = "") -> str:
    """``connectionPointIn``; several ids make several connections."""
    name = f' formalParameter="{pin}"' if pin else ""
    wires = "".join(f'<connection refLocalId="{i}"{name}/>' for i in ids)
    return f"<connectionPointIn>{wires}</connectionPointIn>"


def step(number: int, name: str, *sources: int, initial: bool = False, more: str = "", attributes: str = "") -> str:
    start = ' initialStep="true"' if initial else ""
    wires = source(*sources) if sources else ""
    return (
        f'<step localId="{number}" name="{name}"{start}{attributes}><position x="0" y="0"/>{wires}'
        f'<connectionPointOut formalParameter="sfc"/>{more}</step>'
    )


def transition(number: int, *sources: int, condition: str | None = "TRUE", more: str = "", attributes: str = "") -> str:
    said = "" if condition is None else f"<condition>{inline(condition)}</condition>"
    return (
        f'<transition localId="{number}"{attributes}><position x="0" y="0"/>{source(*sources)}'
        f"<connectionPointOut/>{said}{more}</transition>"
    )


def inline(text: str) -> str:
    return f'<inline name=""><ST><xhtml:p>{text}</xhtml:p></ST></inline>'


def bar(kind: str, number: int, *sources: int, attributes: str = "", outputs: int = 1) -> str:
    """A divergence or convergence; convergences have one pin for each source."""
    if kind.endswith("Convergence"):
        pins = "".join(source(i) for i in sources) + "<connectionPointOut/>"
    else:
        pins = source(*sources) + '<connectionPointOut formalParameter=""/>' * outputs
    return f'<{kind} localId="{number}"{attributes}><position x="0" y="0"/>{pins}</{kind}>'


def jump(number: int, target: str, *sources: int) -> str:
    return f'<jumpStep localId="{number}" targetName="{target}"><position x="0" y="0"/>{source(*sources)}</jumpStep>'


def block(number: int, owner: int, *actions: str, attributes: str = "") -> str:
    return f'<actionBlock localId="{number}"{attributes}><position x="0" y="0"/>{source(owner)}{"".join(actions)}</actionBlock>'


def action(number: int, target: str = "", attributes: str = "", more: str = "") -> str:
    reference = f'<reference name="{target}"/>' if target else ""
    return f'<action localId="{number}"{attributes}><relPosition x="0" y="0"/>{reference}{more}</action>'


SIMPLE = (step(0, "A", 3, initial=True), transition(1, 0), step(2, "B", 1), transition(3, 2))
"""A circle of two steps."""


def round_trip(data: bytes) -> Project:
    """The project in `data`; it comes back byte for byte, and written from the model alone it is the same project."""
    loaded = sfc.loads(data)
    assert sfc.dumps(loaded) == data
    fresh = sfc.dumps(loaded, fresh=True)
    again = sfc.loads(fresh)
    assert again == loaded
    assert sorted(d.code for d in again.diagnostics) == sorted(d.code for d in loaded.diagnostics)
    assert sfc.loads(sfc.dumps(loaded, format="json")) == loaded
    return loaded


def chart_of(*elements: str, version: str = "2.01") -> SfcNetwork:
    """The chart of the elements, after `round_trip`."""
    found = round_trip(project(chart(*elements), version=version)).pou("Main").sfc
    assert found is not None
    return found


def links(network: SfcNetwork) -> list[tuple[list[str], list[str]]]:
    """From where to where each transition leads, by names."""
    names = {s.id: s.name for s in network.steps}
    return [([names[i] for i in t.sources], [names[i] for i in t.targets]) for t in network.transitions]


def codes(loaded: Project) -> list[str]:
    return [d.code for d in loaded.diagnostics]
