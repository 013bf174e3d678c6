"""Sequencers of S7-GRAPH for the tests of lowering."""

from __future__ import annotations

from typing import Any

from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, equivalent
from plcopen_sfc.lowering import Construction, Language
from plcopen_sfc.lowering.construction import Constructed, construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.semantics.charts.rig import chain

STANDARD_INPUTS = "OFF_SQ INIT_SQ ACK_EF S_PREV S_NEXT SW_AUTO SW_TAP SW_TOP SW_MAN S_SEL:INT S_ON S_OFF T_PUSH"
STANDARD_OUTPUTS = "S_NO:INT S_MORE S_ACTIVE ERR_FLT AUTO_ON TAP_ON TOP_ON MAN_ON"


def act(qualifier: str, target: str | None = "Q", event: str | None = None, **fields: Any) -> m.ActionAssociation:
    """An action of a step."""
    return m.ActionAssociation(
        id=1,
        qualifier=m.Qualifier(qualifier),
        target=f"#{target}" if target else None,
        event=m.ActionEvent(event) if event else None,
        **fields,
    )


def ring(*actions: m.ActionAssociation) -> m.SfcNetwork:
    """A ring of S1, S2 and S3; S2 has the actions."""
    chart = chain("S1", "S2", "S3", conditions="#c1 #c2 #c3")
    chart.step("S2").actions = list(actions)
    return chart


def guarded(*actions: m.ActionAssociation, acknowledge: bool | None = None) -> m.SfcNetwork:
    """The same; S2 has an interlock and a supervision."""
    chart = ring(*actions)
    chart.step("S2").interlock = m.Supervised(condition=m.Expression(text="#ok"))
    chart.step("S2").supervision = m.Supervised(condition=m.Expression(text="#fault"))
    chart.graph_settings = m.GraphSettings(acknowledge_errors_required=acknowledge)
    return chart


def block(chart: m.SfcNetwork, inputs: str = "", outputs: str = "") -> m.Project:
    """A project with one block: the chart with the inputs c1, c2, c3 and others."""
    for number, step in enumerate(chart.steps, start=1):
        step.number = number
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=_declared(f"c1 c2 c3 {inputs}")),
        m.VariableSection(kind=m.SectionKind.OUTPUT, variables=_declared(outputs)),
    ]
    pou = m.Pou(
        name="Sequence",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.SfcBody(chart=chart)],
    )
    return m.Project(name="test", pous=[pou], dialect=Dialect.SCL)


def _declared(names: str) -> list[m.Variable]:
    words = [word.partition(":") for word in names.split()]
    return [m.Variable(name=name, type=type_ or "BOOL") for name, _, type_ in words]


def lowered(
    project: m.Project, language: Language = Language.ST, construction: Construction | None = None, **options: Any
) -> Constructed:
    """The block as code: bits in structured text, flip-flops in FBD and LD, if nothing else is wanted."""
    (pou,) = project.pous
    assert pou.sfc is not None
    construction = construction or (Construction.BITS if language is Language.ST else Construction.FLIPFLOP)
    rules = LoweringRules(PROFILES["s7graph"], construction=construction, language=language, **options)
    return construct(pou, pou.sfc, Dialect.SCL, rules, project)


def text(project: m.Project, construction: Construction = Construction.BITS) -> str:
    """The block as text."""
    body = lowered(project, construction=construction).pou.body
    assert isinstance(body, m.StBody)
    return body.text


def verdict(
    project: m.Project,
    language: Language = Language.ST,
    *,
    cap: int = 3_000,
    runs: int = 20,
    fixed: dict[str, int] | None = None,
    **options: Any,
) -> Verdict:
    """The comparison of the code with the chart."""
    made = lowered(project, language, **options)
    code = m.Project(name="code", pous=[made.pou], dialect=Dialect.SCL, data_types=project.data_types)
    return equivalent(
        project, code, "s7graph", step_flags=made.step_flags, fixed=fixed or made.at_rest, cap=cap, runs=runs
    )
