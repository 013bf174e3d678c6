"""Makes the files of the training chain in every format: ``python -m tests.lowering.training_chain``.

Four steps in a ring drive three outputs: continuously, stored, and under a condition. Textbooks teach with this chain
how a chart becomes a program; its textbook programs lie beside it.
"""

from __future__ import annotations

import re
import shutil

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.languages.networks import network_statements
from plcopen_sfc.languages.st import print_node
from tests.corpus import ROOT
from tests.lowering import charts

FOLDER = ROOT / "fixtures" / "training-chain"
LISTING = "classic_flip-flops.txt"
TIA = ROOT / "fixtures" / "simaticml-training-chain"
CHARTS = {
    "plcopen_1.01.xml": "plcopen-1.01",
    "plcopen_2.0.xml": "plcopen-2.0",
    "plcopen_2.01.xml": "plcopen-2.01",
    "codesys.xml": "codesys",
    "iec-text.st": "iec-text",
    "model.json": "json",
}
"""The files in `FOLDER` that hold the chart, with their formats."""

PROGRAMS = {
    "classic_case.st": ("case", "iec-text"),
    "classic_case.scl": ("case", "scl"),
    "classic_flip-flops.xml": ("flipflop", "plcopen-2.01"),
    "classic_flip-flops_codesys.xml": ("flipflop", "codesys"),
}
"""The files in `FOLDER` that hold the textbook programs, with construction and format."""


def project() -> m.Project:
    """The chain in a project."""
    pou = charts.training_chain()
    assert pou.interface is not None
    for variable in pou.interface.variables():
        variable.comment = f"{'Sensor' if variable.name.startswith('B') else 'Aktor'} {variable.name[1:]}"
    header = m.FileHeader(company="plcopen_sfc", product="plcopen_sfc", version="1", created="2026-01-01T00:00:00")
    return m.Project(name="Trainingskette", header=header, pous=[pou])


def graph_project() -> m.Project:
    """The chain as a block of S7-GRAPH, where the condition of an action is the interlock of its step."""
    made = project()
    made.header = m.FileHeader(product="TIA Portal", version="V21")
    chart = made.pous[0].sfc
    assert chart is not None
    conditional = chart.step("S3").actions[0]
    conditional.condition, conditional.interlock = None, True
    chart.step("S3").interlock = m.Supervised(condition=m.Expression(text="B5"))
    return made


def lowered(construction: str, form: str | None) -> sfc.LoweredPou:
    """The textbook program of the chain."""
    return sfc.lower(project(), construction, style="classic", lang="de", target=form, verify=False)


def listing(project: m.Project) -> str:
    """The networks of the only POU as text: the title of each, and what it does."""
    body = project.pous[0].body
    assert isinstance(body, m.FbdBody)
    paragraphs = []
    for network in body.networks:
        text = network_statements([network], project.dialect)
        assert text.complete
        paragraphs.append(f"// {network.title}\n{print_node(text.tree)}\n")
    return "\n".join(paragraphs)


def make() -> None:
    """Write all files."""
    for folder in (FOLDER, TIA):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
    for name, form in CHARTS.items():
        sfc.save(project(), FOLDER / name, format=form)
    for name, (construction, form) in PROGRAMS.items():
        sfc.save(lowered(construction, form).project, FOLDER / name, format=form)
    (FOLDER / LISTING).write_bytes(listing(lowered("flipflop", None).project).encode())
    sfc.save(graph_project(), TIA / "Ablauf.xml", format="simaticml-V21")
    sfc.save(lowered("flipflop", "simaticml").project, TIA / "classic_flip-flops.xml", format="simaticml-V21")
    for path in TIA.iterdir():  # what an export of TIA Portal has none of
        path.write_bytes(re.sub(rb"(\r\n *)?<!--plcopen_sfc .*?-->", b"", path.read_bytes()))


if __name__ == "__main__":
    make()
