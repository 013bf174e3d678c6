"""Small PLCopen XML projects around a snippet, for tests that look at one element."""
# ruff: noqa: E501  # XML is easier to read in long lines

from __future__ import annotations

import plcopen_sfc as sfc
from plcopen_sfc.model import Monitoring, Project, SfcNetwork, Step, Symbol, SymbolAccess, Transition

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
    prefix: bool = True,
) -> bytes:
    """A whole file. `prefix`: it declares one for XHTML, which CODESYS and TwinCAT do not."""
    xhtml = ' xmlns:xhtml="http://www.w3.org/1999/xhtml"' if prefix else ""
    return f"""<?xml version="1.0" encoding="utf-8"?>
<project xmlns="{NAMESPACES[version]}"{xhtml}>
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


def codesys(pous: str = "", *, instances: str = "", end: str = "", release: str = "CODESYS V3.5 SP18") -> bytes:
    """A whole file as CODESYS writes it."""
    pous = pous.replace("<xhtml:p>", '<xhtml xmlns="http://www.w3.org/1999/xhtml">').replace("</xhtml:p>", "</xhtml>")
    product = "CODESYS" if release.startswith("CODESYS") else "TwinCAT PLC Control"
    # without any of its data a file cannot be told from one of another tool
    info = f'<addData><data name="{CODESYS}projectinformation" handleUnknown="implementation"/></addData>'
    return project(
        pous, version="2.0", instances=instances, end=end, header=info, product=product, release=release, prefix=False
    )


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
    markup = "" if condition is None else f"<condition>{inline(condition)}</condition>"
    return (
        f'<transition localId="{number}"{attributes}><position x="0" y="0"/>{source(*sources)}'
        f"<connectionPointOut/>{markup}{more}</transition>"
    )


def drawn_transition(number: int, *sources: int, condition: str = "TRUE", more: str | None = None) -> str:
    """A transition as CODESYS draws it: its condition is an expression beside it, and its name."""
    expression = number + 100
    name = f'<attribute guid="38391c6d-6d4a-42f8-8ee7-9f45e5adafa8">{condition}</attribute>'
    data = f'<data name="{CODESYS}sfc/element" handleUnknown="implementation"><attributes xmlns="">{name}</attributes></data>'
    return (
        f'<inVariable localId="{expression}"><position x="0" y="0"/><connectionPointOut/>'
        f"<expression>{condition}</expression></inVariable>"
        f'<transition localId="{number}"><position x="0" y="0"/>{source(*sources, pin="sfc")}'
        f"<condition>{source(expression)}</condition>{f'<addData>{data}</addData>' if more is None else more}</transition>"
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
    lines = "".join(actions)
    return f'<actionBlock localId="{number}"{attributes}><position x="0" y="0"/>{source(owner)}{lines}</actionBlock>'


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
    assert settled(again) == settled(loaded)
    assert sorted(d.code for d in again.diagnostics) == sorted(d.code for d in loaded.diagnostics)
    loaded.accept_errors()
    assert sfc.loads(sfc.dumps(loaded, format="json")) == loaded
    return loaded


def settled(loaded: Project) -> Project:
    """A copy in which a chart of CODESYS says what the tools always say: snippets leave the defaults out."""
    copy = loaded.model_copy(deep=True)
    if loaded.source is None or loaded.source.format != "codesys":
        return copy
    for one in copy.charts():
        network = one.chart
        bars = (
            [s for s in network.drawing.symbols if "ivergence" in s.kind or s.kind == "jumpStep"]
            if network.drawing
            else []
        )
        for thing in (*network.steps, *network.transitions, *(a for _, a in network.associations()), *bars):
            thing.exclude = bool(thing.exclude)
            if not isinstance(thing, Symbol):
                thing.symbol = thing.symbol or SymbolAccess.UNSPECIFIED
            if isinstance(thing, Step | Transition):
                thing.duplicate = bool(thing.duplicate)
            if isinstance(thing, Transition):
                thing.monitoring = thing.monitoring or Monitoring.NONE
    return copy


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
