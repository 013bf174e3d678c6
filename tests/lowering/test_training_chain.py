"""The training chain lies in the fixtures in every format; its programs are those that textbooks have for it."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.semantics.net import Net
from tests.lowering import training_chain as chain
from tests.samples import FIXTURES


def facts(project: m.Project) -> object:
    """The content of the chart, whatever the ids and the dialect are."""
    chart = project.pous[0].sfc
    assert chart is not None
    net = Net.of(chart)
    steps = [
        (step.path, bool(net.initial & step.bit), step.step.number, [acting(each) for each in step.step.actions])
        for step in net.steps
    ]
    return steps, [
        (t.sources, t.targets, t.transition.condition.text)
        for t in net.transitions
        if isinstance(t.transition.condition, m.Expression)
    ]


def acting(action: m.ActionAssociation) -> tuple[object, ...]:
    condition = action.condition.text if isinstance(action.condition, m.Expression) else None
    return action.qualifier, action.target, condition


@pytest.mark.parametrize("name", chain.CHARTS)
def test_every_file_holds_the_chart(name: str) -> None:
    project = sfc.load(chain.FOLDER / name)
    assert facts(project) == facts(chain.project())
    assert [v.comment for v in project.pous[0].interface.variables()] == [  # type: ignore[union-attr]
        *(f"Sensor {number}" for number in range(1, 6)),
        *(f"Aktor {number}" for number in range(1, 4)),
    ]


def test_the_files_are_those_that_the_script_makes() -> None:
    for name, form in chain.CHARTS.items():
        assert (chain.FOLDER / name).read_bytes() == sfc.dumps(chain.project(), format=form), name
    made = {*chain.CHARTS, *chain.PROGRAMS, chain.LISTING}
    assert {path.name for path in chain.FOLDER.iterdir()} == made
    readme = (FIXTURES / "README.md").read_text(encoding="utf-8")
    named = [f"{chain.FOLDER.name}/{name}" for name in made]
    named += [f"{chain.TIA.name}/{path.name}" for path in chain.TIA.iterdir()]
    assert [name for name in named if f"`{name}`" not in readme] == []


@pytest.mark.parametrize("name", ["classic_case.st", "classic_case.scl"])
def test_the_case_of_the_textbook(name: str) -> None:
    construction, form = chain.PROGRAMS[name]
    written = sfc.dumps(chain.lowered(construction, form).project, format=form)
    assert written.decode("utf-8-sig") == (chain.FOLDER / name).read_bytes().decode("utf-8-sig")


def test_the_networks_of_the_textbook() -> None:
    expected = (chain.FOLDER / chain.LISTING).read_text(encoding="utf-8")
    assert chain.listing(chain.lowered("flipflop", None).project) == expected


@pytest.mark.parametrize("name", ["classic_flip-flops.xml", "classic_flip-flops_codesys.xml"])
def test_the_networks_of_the_textbook_in_files(name: str) -> None:
    """Dialects have other names for pins; the flags do the same."""
    again = sfc.load(chain.FOLDER / name)
    verdict = equivalent(chain.lowered("flipflop", None).project, again, "iec")
    assert verdict.kind is VerdictKind.PROVEN, str(verdict)


def test_a_network_for_each_step_in_tia_portal() -> None:
    again = sfc.load(chain.TIA / "classic_flip-flops.xml")
    body = again.pous[0].body
    assert isinstance(body, m.FbdBody)
    titles = [network.title.texts for network in body.networks if isinstance(network.title, m.MultilingualText)]
    steps = ["Schritt 1 – Initialschritt", "Schritt 2", "Schritt 3", "Schritt 4"]
    assert titles[:4] == [{"de-DE": title} for title in steps]
    text = (chain.TIA / "classic_flip-flops.xml").read_text(encoding="utf-8-sig")
    assert text.count('<Part Name="Sr"') == 5  # the reset dominates: outside of Siemens this is RS
    assert '<Part Name="Rs"' not in text


@pytest.mark.parametrize("name", chain.CHARTS)
@pytest.mark.parametrize("construction", ["flipflop", "case", "bits"])
def test_exact_code_is_proven_from_every_file(construction: str, name: str) -> None:
    lowered = sfc.lower(sfc.load(chain.FOLDER / name), construction, profile="iec")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)


def test_the_block_of_s7_graph_is_the_same_chart() -> None:
    project = sfc.load(chain.TIA / "Ablauf.xml")
    lowered = sfc.lower(project, verify=False)
    still = {
        name.name: False
        for name in project.pous[0].interface.variables()  # type: ignore[union-attr]
        if name.name.startswith(("OFF_", "INIT_", "ACK_", "S_", "SW_", "T_")) and name.name != "S_SEL"
    }
    verdict = equivalent(project, lowered.project, "s7graph", fixed=still)
    assert verdict.kind is VerdictKind.PROVEN, str(verdict)
