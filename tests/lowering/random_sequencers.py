"""Sequencers of S7-GRAPH at random."""

from __future__ import annotations

from hypothesis import strategies as st

from plcopen_sfc import model as m
from tests.analysis.nets import any_nets, block_chart, chart_of_arcs
from tests.lowering.sequencers import act


@st.composite
def sequencers(draw: st.DrawFn, *, switching: bool = True) -> tuple[m.SfcNetwork, str, str]:
    """Any net with any actions, checks and parameters; its inputs and outputs. `switching`: with ON and OFF."""
    chart = draw(nets())
    conditions = st.sampled_from(["#c1", "#c2", "#c3", "NOT #c1", "#c1 AND #c2", "TRUE", *_questions(chart)])
    for transition in chart.transitions:
        transition.condition = draw(st.none() | conditions.map(lambda text: m.Expression(text=text)))
    for step in chart.steps:
        step.actions = draw(st.lists(actions(chart, switching=switching), max_size=3))
        for name in ("interlock", "supervision"):
            if draw(st.integers(0, 3)) == 0:
                setattr(step, name, m.Supervised(condition=m.Expression(text=draw(conditions))))
    flag = st.sampled_from([None, True])
    chart.graph_settings = m.GraphSettings(acknowledge_errors_required=draw(flag), skip_steps=draw(flag))
    if draw(st.booleans()):
        question = draw(st.sampled_from(_questions(chart)))
        chart.permanent_pre = [m.PermanentOperation(body=m.StBody(text=f"#P := {question};"))]
    if draw(st.booleans()):
        question = draw(st.sampled_from(_questions(chart)))
        chart.permanent_post = [m.PermanentOperation(body=m.StBody(text=f"#R := {question};"))]
    inputs = draw(st.sampled_from(["", "ACK_EF", "INIT_SQ OFF_SQ", "REG_S ACK_EF", "SW_TAP SW_TOP T_PUSH", "S_NEXT"]))
    outputs = draw(st.sampled_from(["", "ERR_FLT", "S_NO:INT S_MORE S_ACTIVE"]))
    return chart, inputs, f"P Q R n:INT t {outputs}"


@st.composite
def nets(draw: st.DrawFn) -> m.SfcNetwork:
    """Sound nets and others."""
    if draw(st.booleans()):
        return block_chart(draw(st.integers(0, 999)), draw(st.integers(1, 5)))
    steps, initial, arcs = draw(any_nets(max_steps=4, max_transitions=5))
    return chart_of_arcs(steps, initial, arcs)


def _questions(chart: m.SfcNetwork) -> list[str]:
    quantities = "X S1 S0 L1 LA LS V1 VA A1 R1".split()
    names = [step.name for step in chart.steps[:2]]
    asked = [f"#{name}.{quantity}" for name in names for quantity in quantities]
    return [*asked, *(f"#{name}.T >= T#20ms" for name in names)]


@st.composite
def actions(draw: st.DrawFn, chart: m.SfcNetwork, *, switching: bool) -> m.ActionAssociation:
    """Any action."""
    event = draw(st.sampled_from("S1 S0 L1 L0 V1 V0 A1 R1".split()))
    some_event = draw(st.sampled_from([None, event]))
    interlock = draw(st.booleans())
    target = draw(st.sampled_from(["P", "Q", "R"]))
    step = draw(st.sampled_from([*(step.name for step in chart.steps), "S_ALL"]))
    duration = draw(st.sampled_from(["T#10ms", "T#20ms", "T#0ms"]))
    asked = draw(st.sampled_from(_questions(chart)))
    switches = [act("ON", step, event), act("OFF", step, event, interlock=interlock)] if switching else []
    return draw(
        st.sampled_from(
            [
                act("N", target, some_event, interlock=interlock),
                act("S", target, some_event, interlock=interlock),
                act("R", target, some_event, interlock=interlock),
                act("D", target, duration=duration, interlock=interlock),
                act("L", target, duration=duration, interlock=interlock),
                act("N", target, some_event, value=f"NOT #{target}", interlock=interlock),
                act("N", target, some_event, value=asked, interlock=interlock),
                act("CU", "n", event, interlock=interlock),
                act("CS", "n", event, value="3"),
                act("TL", "t", event, duration=duration),
                act("TD", "t", event, duration=duration, interlock=interlock),
                act("TR", "t", event),
                act("TF", "t", duration=duration, interlock=interlock),
                *switches,
            ]
        )
    )
