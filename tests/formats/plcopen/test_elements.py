"""TC6 XML element by element: what each becomes in the model, and that the model says enough to write it again."""
# ruff: noqa: E501  # XML is easier to read in long lines

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.snippets import (
    SIMPLE,
    action,
    bar,
    block,
    chart,
    chart_of,
    codes,
    inline,
    jump,
    links,
    pou,
    project,
    round_trip,
    source,
    step,
    transition,
)

QUALIFIERS = ("P1", "N", "P0", "R", "S", "L", "D", "P", "DS", "DL", "SD", "SL")
BODIES = {
    "ST": "<ST><xhtml:p>x := 1;</xhtml:p></ST>",
    "IL": "<IL><xhtml:p>LD x</xhtml:p></IL>",
    "FBD": '<FBD><inVariable localId="1"><position x="1" y="2"/><connectionPointOut/><expression>a</expression></inVariable>'
    '<outVariable localId="2"><position x="3" y="4"/><connectionPointIn><connection refLocalId="1"/></connectionPointIn>'
    "<expression>b</expression></outVariable></FBD>",
    "LD": '<LD><leftPowerRail localId="1"><position x="0" y="0"/><connectionPointOut formalParameter=""/></leftPowerRail>'
    '<coil localId="2" storage="set"><position x="9" y="0"/><connectionPointIn><connection refLocalId="1"/>'
    "</connectionPointIn><connectionPointOut/><variable>q</variable></coil></LD>",
    "SFC": f"<SFC>{step(1, 'Inner', initial=True)}</SFC>",
}
DOCUMENTATION = "<documentation><xhtml:p>  Füllen &amp; „Leeren“\nzweite Zeile</xhtml:p></documentation>"
COMMENT = "  Füllen & „Leeren“\nzweite Zeile"


def data(rule: str = "preserve") -> str:
    return (
        f'<addData><data name="http://example.org/x" handleUnknown="{rule}"><y xmlns="" z="1">text</y></data></addData>'
    )


# -- steps ------------------------------------------------------------------------------------------------------------


def test_step_with_all_attributes() -> None:
    network = chart_of(
        step(
            7,
            "Füllen",
            initial=True,
            attributes=' negated="true" height="40" width="60.5" executionOrderId="3" globalId="G1"',
            more='<connectionPointOutAction formalParameter="x"><relPosition x="1" y="2.25"/></connectionPointOutAction>'
            + data()
            + DOCUMENTATION,
        )
    )
    (one,) = network.steps
    assert (one.id, one.name, one.initial, one.negated, one.global_id, one.comment) == (
        *(7, "Füllen", True, True, "G1"),
        COMMENT,
    )
    assert network.drawing is not None
    (symbol,) = network.drawing.symbols
    assert (symbol.height, symbol.width, symbol.execution_order) == (40, 60.5, 3)
    assert symbol.action_output is not None
    assert (symbol.action_output.name, symbol.action_output.position) == ("x", (1, 2.25))
    assert one.extension_data is not None
    assert one.extension_data.data[0].name == "http://example.org/x"


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
@pytest.mark.parametrize("language", BODIES)
def test_macro_step_with_a_body_in_each_language(language: str, version: str) -> None:
    macro = (
        f'<macroStep localId="2" name="M"><position x="0" y="0"/>{source(1)}<body>{BODIES[language]}</body></macroStep>'
    )
    network = chart_of(step(0, "A", initial=True), transition(1, 0), macro, transition(3, 2), version=version)
    found = network.step("M")
    assert found.macro is not None
    assert found.macro.body is not None
    assert found.macro.body.language == language
    assert links(network)[0] == (["A"], ["M"])
    if isinstance(found.macro.body, m.SfcBody):
        assert [s.name for s in found.macro.body.chart.steps] == ["Inner"]


def test_macro_step_without_name_and_body() -> None:
    network = chart_of(step(0, "A", initial=True), '<macroStep localId="2"><position x="5" y="6"/></macroStep>')
    assert network.steps[1].name == ""
    assert network.steps[1].macro == m.Macro()


def test_an_inner_step_is_renamed_in_its_own_lines() -> None:
    macro = f'<macroStep localId="2" name="M"><position x="0" y="0"/>\n<body>{BODIES["SFC"]}</body>\n</macroStep>'
    before = project(chart(step(0, "A", initial=True), macro))
    loaded = sfc.loads(before)
    network = loaded.pou("Main").sfc
    assert network is not None
    body = network.step("M").macro.body  # type: ignore[union-attr]
    assert isinstance(body, m.SfcBody)
    body.chart.rename_step("Inner", "Innen")
    assert sfc.dumps(loaded) == before.replace(b"Inner", b"Innen")


# -- jumps and bars ---------------------------------------------------------------------------------------------------


def test_jump_to_a_step_in_another_spelling() -> None:
    network = chart_of(step(0, "Init", initial=True), transition(1, 0), jump(2, "INIT", 1))
    assert links(network) == [(["Init"], ["Init"])]
    assert network.drawing is not None
    assert (network.drawing.symbols[2].target, network.drawing.symbols[2].name) == (0, "INIT")


def test_jump_to_a_simultaneous_divergence() -> None:
    network = chart_of(
        step(0, "A", initial=True),
        transition(1, 0),
        bar("simultaneousDivergence", 2, 1, attributes=' name="Both"', outputs=2),
        step(3, "B", 2),
        step(4, "C", 2),
        bar("simultaneousConvergence", 5, 3, 4),
        transition(6, 5),
        jump(7, "Both", 6),
    )
    assert links(network) == [(["A"], ["B", "C"]), (["B", "C"], ["B", "C"])]


def test_jump_to_nowhere_is_kept_and_reported() -> None:
    loaded = round_trip(project(chart(step(0, "A", initial=True), transition(1, 0), jump(2, "Lost", 1))))
    assert codes(loaded) == ["SFC103"]
    network = loaded.pou("Main").sfc
    assert network is not None
    assert links(network) == [(["A"], [])]
    assert b'targetName="Lost"' in sfc.dumps(loaded, fresh=True)


def test_selection_with_priorities() -> None:
    network = chart_of(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        transition(2, 1, attributes=' priority="2"'),
        transition(3, 1, attributes=' priority="1"'),
        bar("selectionConvergence", 4, 2, 3),
        step(5, "B", 4),
    )
    assert links(network) == [(["A"], ["B"]), (["A"], ["B"])]
    assert [t.priority for t in network.transitions] == [2, 1]
    assert [t.id for t in network.outgoing(network.step("A"))] == [3, 2]


def test_simultaneous_divergence_and_convergence() -> None:
    network = chart_of(
        step(0, "A", initial=True),
        transition(1, 0),
        bar("simultaneousDivergence", 2, 1, outputs=2),
        step(3, "B", 2),
        step(4, "C", 2),
        bar("simultaneousConvergence", 5, 3, 4),
        transition(6, 5),
        step(7, "D", 6),
    )
    assert links(network) == [(["A"], ["B", "C"]), (["B", "C"], ["D"])]
    assert network.drawing is not None
    kinds = [s.kind.value for s in network.drawing.symbols]
    assert kinds[2] == "simultaneousDivergence"
    assert kinds[5] == "simultaneousConvergence"


# -- action blocks ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", ["2.0", "2.01"])
@pytest.mark.parametrize("qualifier", QUALIFIERS)
def test_every_qualifier_with_literal_and_variable_duration(qualifier: str, version: str) -> None:
    lines = [
        action(11, "A1", f' qualifier="{qualifier}" duration="T#1s500ms" indicator="bReady"'),
        action(12, "A2", f' qualifier="{qualifier}" duration="tDelay" width="9" height="8" executionOrderId="4"'),
        action(13, "A3", f' qualifier="{qualifier}"'),
    ]
    network = chart_of(step(0, "S", initial=True), block(10, 0, *lines), version=version)
    found = network.steps[0].actions
    assert [a.qualifier.value for a in found] == [qualifier] * 3
    assert [a.target for a in found] == ["A1", "A2", "A3"]
    assert [a.duration for a in found] == ["T#1s500ms", "tDelay", None]
    assert [a.indicator for a in found] == ["bReady", None, None]
    assert network.drawing is not None
    entries = network.drawing.symbols[1].entries
    assert entries is not None
    assert (entries[1].width, entries[1].height, entries[1].execution_order) == (9, 8, 4)


def test_a_missing_qualifier_is_n() -> None:
    network = chart_of(step(0, "S", initial=True), block(10, 0, action(11, "A")))
    assert network.steps[0].actions[0].qualifier is m.Qualifier.N


@pytest.mark.parametrize("language", BODIES)
@pytest.mark.parametrize("reference", ["", "bBoth"])
def test_inline_action_in_each_language_and_with_a_reference(language: str, reference: str) -> None:
    line = action(11, reference, more=f"<inline>{BODIES[language]}</inline>")
    network = chart_of(step(0, "S", initial=True), block(10, 0, line))
    (one,) = network.steps[0].actions
    assert one.target == (reference or None)
    assert one.body is not None
    assert one.body.language == language


def test_negated_block_and_its_documentation() -> None:
    lines = (action(11, "A", more="<connectionPointOut/>" + data("discard") + DOCUMENTATION), action(12, "B"))
    whole = block(10, 0, *lines, attributes=' negated="true"').replace(
        "</actionBlock>", DOCUMENTATION + "</actionBlock>"
    )
    network = chart_of(step(0, "S", initial=True), whole)
    one, other = network.steps[0].actions
    assert one.negated
    assert other.negated
    assert one.comment == COMMENT
    assert network.drawing is not None
    assert network.drawing.symbols[1].comment == COMMENT


def test_two_blocks_at_one_step() -> None:
    network = chart_of(step(0, "S", initial=True), block(10, 0, action(11, "A")), block(20, 0, action(21, "B")))
    assert [a.target for a in network.steps[0].actions] == ["A", "B"]


def test_block_without_step_is_carried_and_reported() -> None:
    loaded = round_trip(project(chart(step(0, "S", initial=True), block(10, 77, action(11, "A")))))
    assert "SFC108" in codes(loaded)
    network = loaded.pou("Main").sfc
    assert network is not None
    assert network.steps[0].actions == []
    assert network.extension_data is not None
    assert "actionBlock" in network.extension_data.elements[0]


def test_actions_with_the_same_id_get_ids_of_their_own() -> None:
    network = chart_of(step(0, "S", initial=True), block(10, 0, action(0, "A"), action(0, "B")))
    assert len({a.id for a in network.steps[0].actions} | {0, 10}) == 4


def test_block_of_tc6_1_01() -> None:
    whole = (
        '<actionBlock localId="10"><position x="0" y="0"/>' + source(0) + '<connectionPointOut formalParameter="q"/>'
        '<action qualifier="D" duration="T#1s"><reference name="A"/></action>'
        "<action><inline><ST><xhtml:p>x</xhtml:p></ST></inline></action></actionBlock>"
    )
    network = chart_of(step(0, "S", initial=True), whole, version="1.01")
    one, other = network.steps[0].actions
    assert (one.qualifier.value, one.duration, one.target) == ("D", "T#1s", "A")
    assert isinstance(other.body, m.StBody)


# -- conditions -------------------------------------------------------------------------------------------------------


def with_condition(condition: str, *more: str, version: str = "2.01") -> m.Transition:
    one = f'<transition localId="1"><position x="0" y="0"/>{source(0)}{condition}</transition>'
    return chart_of(step(0, "A", initial=True), *more, one, step(2, "B", 1), version=version).transitions[0]


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
@pytest.mark.parametrize("negated", [False, True])
def test_condition_by_name(version: str, *, negated: bool) -> None:
    mark = ' negated="true"' if negated else ""
    found = with_condition(f'<condition{mark}><reference name="tReady"/></condition>', version=version)
    assert found.condition == m.NamedCondition(name="tReady", negated=negated)


@pytest.mark.parametrize("negated", [False, True])
def test_condition_as_inline_expression(*, negated: bool) -> None:
    mark = ' negated="true"' if negated else ""
    found = with_condition(f"<condition{mark}>{inline('a &lt; b AND &quot;c&quot;')}</condition>")
    assert found.condition == m.Expression(text='a < b AND "c"', negated=negated)


@pytest.mark.parametrize("language", ["IL", "FBD", "LD", "SFC"])
def test_condition_as_inline_body(language: str) -> None:
    found = with_condition(f'<condition><inline name="c1">{BODIES[language]}</inline></condition>')
    assert isinstance(found.condition, m.BodyCondition)
    assert (found.condition.name, found.condition.body.language) == ("c1", language)


@pytest.mark.parametrize("version", ["2.0", "2.01"])
def test_condition_from_a_drawn_expression(version: str) -> None:
    variable = '<inVariable localId="9"><position x="1" y="1"/><connectionPointOut/><expression>a OR b</expression></inVariable>'
    found = with_condition(f"<condition>{source(9)}</condition>", variable, version=version)
    assert found.condition == m.Expression(text="a OR b")


def test_condition_from_a_drawn_expression_in_1_01() -> None:
    variable = '<inVariable localId="9"><position x="1" y="1"/><connectionPointOut/><expression>a OR b</expression></inVariable>'
    found = with_condition('<condition><connection refLocalId="9"/></condition>', variable, version="1.01")
    assert found.condition == m.Expression(text="a OR b")


@pytest.mark.parametrize("version", ["1.01", "2.01"])
def test_condition_from_logic(version: str) -> None:
    logic = (
        '<inVariable localId="9" negated="true"><position x="1" y="1"/><connectionPointOut/><expression>a</expression></inVariable>'
        '<block localId="8" typeName="AND"><position x="2" y="2"/><inputVariables><variable formalParameter="IN1">'
        + source(9)
        + "</variable></inputVariables><inOutVariables/><outputVariables>"
        '<variable formalParameter="OUT"><connectionPointOut/></variable></outputVariables></block>'
    )
    wire = '<connection refLocalId="8" formalParameter="OUT"/>'
    inner = wire if version == "1.01" else f"<connectionPointIn>{wire}</connectionPointIn>"
    found = with_condition(f"<condition>{inner}</condition>", logic, version=version)
    assert isinstance(found.condition, m.WiredCondition)
    (connection,) = found.condition.input.connections
    assert (connection.source, connection.pin) == (8, "OUT")


def test_expression_that_feeds_two_conditions_stays_logic() -> None:
    variable = (
        '<inVariable localId="9"><position x="1" y="1"/><connectionPointOut/><expression>a</expression></inVariable>'
    )
    condition = f"<condition>{source(9)}</condition>"
    both = [
        f'<transition localId="{i}"><position x="0" y="0"/>{source(s)}{condition}</transition>'
        for i, s in ((1, 0), (3, 2))
    ]
    network = chart_of(step(0, "A", 3, initial=True), variable, both[0], step(2, "B", 1), both[1])
    assert [type(t.condition) for t in network.transitions] == [m.WiredCondition] * 2
    assert [n.kind for n in network.logic] == ["input"]


def test_missing_condition_is_reported() -> None:
    loaded = round_trip(project(chart(step(0, "A", initial=True), transition(1, 0, condition=None), step(2, "B", 1))))
    assert codes(loaded) == ["SFC112"]
    assert loaded.pou("Main").sfc.transitions[0].condition is None  # type: ignore[union-attr]


def test_transition_with_all_attributes() -> None:
    network = chart_of(
        step(0, "A", initial=True),
        transition(
            1,
            0,
            attributes=' priority="5" executionOrderId="2" height="2" width="20" globalId="T1"',
            more=data("implementation") + DOCUMENTATION,
        ),
        step(2, "B", 1),
    )
    one = network.transitions[0]
    assert (one.priority, one.global_id, one.comment) == (5, "T1", COMMENT)


# -- what every element may have --------------------------------------------------------------------------------------

HOLDERS = {
    "step": lambda x: chart(step(0, "A", initial=True, more=x)),
    "macroStep": lambda x: chart(
        step(0, "A", initial=True), f'<macroStep localId="1" name="M"><position x="0" y="0"/>{x}</macroStep>'
    ),
    "transition": lambda x: chart(*SIMPLE[:1], transition(1, 0, more=x), *SIMPLE[2:]),
    "jumpStep": lambda x: chart(*SIMPLE, transition(5, 2), jump(6, "A", 5).replace("</jumpStep>", f"{x}</jumpStep>")),
    "selectionDivergence": lambda x: chart(
        SIMPLE[0], bar("selectionDivergence", 9, 0).replace("</sel", f"{x}</sel"), transition(1, 9), *SIMPLE[2:]
    ),
    "simultaneousDivergence": lambda x: chart(
        *SIMPLE[:2], bar("simultaneousDivergence", 9, 1).replace("</sim", f"{x}</sim"), step(2, "B", 9), SIMPLE[3]
    ),
    "selectionConvergence": lambda x: chart(
        *SIMPLE[:2], bar("selectionConvergence", 9, 1).replace("</sel", f"{x}</sel"), step(2, "B", 9), SIMPLE[3]
    ),
    "simultaneousConvergence": lambda x: chart(
        SIMPLE[0], bar("simultaneousConvergence", 9, 0).replace("</sim", f"{x}</sim"), transition(1, 9), *SIMPLE[2:]
    ),
    "actionBlock": lambda x: chart(
        *SIMPLE, block(9, 0, action(10, "q")).replace("</actionBlock>", f"{x}</actionBlock>")
    ),
    "action": lambda x: chart(*SIMPLE, block(9, 0, action(10, "q", more=x))),
    "block": lambda x: pou(
        '<body><FBD><block localId="1" typeName="AND"><position x="0" y="0"/><inputVariables/><inOutVariables/>'
        f"<outputVariables/>{x}</block></FBD></body>"
    ),
    "contact": lambda x: pou(
        f'<body><LD><contact localId="1"><position x="0" y="0"/><variable>a</variable>{x}</contact></LD></body>'
    ),
    "inVariable": lambda x: pou(
        f'<body><FBD><inVariable localId="1"><position x="0" y="0"/><expression>a</expression>{x}</inVariable></FBD></body>'
    ),
    "body": lambda x: pou(f"<body>{BODIES['ST']}{x}</body>"),
    "pou": lambda x: pou(f"<body>{BODIES['ST']}</body>{x}"),
    "interface": lambda x: pou(f"<interface>{x}</interface><body>{BODIES['ST']}</body>"),
    "localVars": lambda x: pou(f"<interface><localVars>{x}</localVars></interface><body>{BODIES['ST']}</body>"),
    "variable": lambda x: pou(
        '<interface><localVars><variable name="v"><type><BOOL/></type>' + x + "</variable></localVars></interface>"
        f"<body>{BODIES['ST']}</body>"
    ),
    "pou action": lambda x: pou(
        f'<actions><action name="Go"><body>{BODIES["ST"]}</body>{x}</action></actions><body>{BODIES["ST"]}</body>'
    ),
    "pou transition": lambda x: pou(
        f'<transitions><transition name="Go"><body>{BODIES["ST"]}</body>{x}</transition></transitions><body>{BODIES["ST"]}</body>'
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["preserve", "discard", "implementation"])
@pytest.mark.parametrize("holder", HOLDERS)
def test_foreign_data_with_each_rule_on_each_element(holder: str, rule: str) -> None:
    content = project(HOLDERS[holder](data(rule)))
    loaded = round_trip(content)
    assert not loaded.diagnostics
    fresh = sfc.dumps(loaded, fresh=True)
    assert f'<data name="http://example.org/x" handleUnknown="{rule}">'.encode() in fresh
    assert b'<y xmlns="" z="1">text</y>' in fresh


@pytest.mark.parametrize("holder", HOLDERS)
def test_documentation_on_each_element(holder: str) -> None:
    loaded = round_trip(project(HOLDERS[holder](DOCUMENTATION)))
    assert not loaded.diagnostics
    assert "  Füllen &amp; „Leeren“\nzweite Zeile".encode() in sfc.dumps(loaded, fresh=True)


@pytest.mark.parametrize("holder", HOLDERS)
def test_unknown_element_is_kept_and_reported(holder: str) -> None:
    loaded = round_trip(project(HOLDERS[holder]('<ownMark level="3">!</ownMark>')))
    assert codes(loaded) == ["XML201"]
    assert '<ownMark level="3">!</ownMark>' in sfc.dumps(loaded, fresh=True).decode()


def test_foreign_data_with_an_unknown_rule() -> None:
    loaded = sfc.loads(project(HOLDERS["step"](data("perhaps"))))
    assert codes(loaded) == ["XML203"]
    assert loaded.pou("Main").sfc.steps[0].extension_data.data[0].rule is m.UnknownDataRule.IMPLEMENTATION  # type: ignore[union-attr]


def test_unknown_attributes_are_kept() -> None:
    content = project(
        chart(step(0, "A", initial=True, attributes=' hue="7" xmlns:v="urn:v" v:mark="x y"'), *SIMPLE[1:])
    )
    loaded = round_trip(content)
    extension_data = loaded.pou("Main").sfc.steps[0].extension_data  # type: ignore[union-attr]
    assert extension_data is not None
    assert extension_data.attributes == {"hue": "7", "{urn:v}mark": "x y"}


@pytest.mark.parametrize(
    ("attributes", "kept"),
    [
        (' height="tall"', {"height": "tall"}),
        (' executionOrderId="-1"', {"executionOrderId": "-1"}),
        (' initialStep="yes"', {"initialStep": "yes"}),
        (' width="1,5"', {"width": "1,5"}),
    ],
)
def test_damaged_values_are_kept_and_reported(attributes: str, kept: dict[str, str]) -> None:
    loaded = round_trip(project(chart(step(0, "A", attributes=attributes))))
    assert "XML202" in codes(loaded)
    (only,) = loaded.pou("Main").sfc.steps  # type: ignore[union-attr]
    holders = [only.extension_data, loaded.pou("Main").sfc.drawing.symbols[0].extension_data]  # type: ignore[union-attr]
    assert kept in [holder.attributes for holder in holders if holder is not None]


def test_damaged_local_ids() -> None:
    loaded = sfc.loads(project(chart(step(0, "A", initial=True), step(0, "B"), '<step localId="x" name="C"/>')))
    assert codes(loaded).count("SFC101") == 1
    assert codes(loaded).count("SFC107") == 1
    assert len({s.id for s in loaded.pou("Main").sfc.steps}) == 3  # type: ignore[union-attr]
    assert sfc.loads(sfc.dumps(loaded, fresh=True)).pou("Main").sfc.steps[1].name == "B"  # type: ignore[union-attr]


def test_several_worksheets() -> None:
    sheets = "".join(f'<body WorksheetName="Blatt {i}">{BODIES["ST"]}</body>' for i in (1, 2, 3))
    bodies = round_trip(project(pou(sheets))).pou("Main").bodies
    assert [body.worksheet for body in bodies] == ["Blatt 1", "Blatt 2", "Blatt 3"]


@pytest.mark.parametrize("language", BODIES)
def test_pou_bodies_and_named_parts_in_each_language(language: str) -> None:
    body = f"<body>{BODIES[language]}</body>"
    loaded = round_trip(
        project(
            pou(
                f'<actions><action name="Act">{body}</action></actions>'
                f'<transitions><transition name="Go">{body}</transition></transitions>{body}'
            )
        )
    )
    names = [(name, b.language) for name, _, b in loaded.pou("main").named_bodies()]
    assert names == [("Main", language), ("Main.Act", language), ("Main.Go", language)]


def test_texts_with_markup_and_cdata() -> None:
    rich = "<documentation><xhtml:p>a <xhtml:b>fat</xhtml:b> word</xhtml:p></documentation>"
    code = "<ST><xhtml:p><![CDATA[IF a < b THEN c := '&'; END_IF]]></xhtml:p></ST>"
    loaded = round_trip(project(pou(f"<body>{code}</body>{rich}")))
    comment = loaded.pou("Main").comment
    assert isinstance(comment, m.MarkupText)
    assert comment.text == "a fat word"
    body = loaded.pou("Main").body
    assert isinstance(body, m.StBody)
    assert (body.text, body.markup) == ("IF a < b THEN c := '&'; END_IF", None)


# -- declarations -----------------------------------------------------------------------------------------------------

TYPES = {
    "BOOL": "<BOOL/>",
    "LREAL": "<LREAL/>",
    "ANY_NUM": "<ANY_NUM/>",
    "string": '<string length="80"/>',
    "wstring": "<wstring/>",
    "derived": '<derived name="T_Ofen"/>',
    "array": '<array><dimension lower="0" upper="MAX"/><dimension lower="-1" upper="1"/><baseType><INT/></baseType></array>',
    "struct": '<struct><variable name="x"><type><BOOL/></type><initialValue><simpleValue value="TRUE"/></initialValue>'
    + DOCUMENTATION
    + "</variable></struct>",
    "enum": '<enum><values><value name="Red" value="1"/><value name="Green"/></values><baseType><UINT/></baseType></enum>',
    "subrangeSigned": '<subrangeSigned><range lower="-5" upper="5"/><baseType><INT/></baseType></subrangeSigned>',
    "subrangeUnsigned": '<subrangeUnsigned><range lower="0" upper="9"/><baseType><USINT/></baseType></subrangeUnsigned>',
    "pointer": '<pointer><baseType><derived name="T"/></baseType></pointer>',
}
VALUES = {
    "simple": '<simpleValue value="T#5s"/>',
    "empty": "<simpleValue/>",
    "array": '<arrayValue><value repetitionValue="3"><simpleValue value="0"/></value><value><simpleValue value="1"/></value></arrayValue>',
    "struct": '<structValue><value member="a"><simpleValue value="1"/></value><value member="b"><arrayValue><value>'
    '<simpleValue value="2"/></value></arrayValue></value></structValue>',
}


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
@pytest.mark.parametrize("kind", TYPES)
def test_each_kind_of_type(kind: str, version: str) -> None:
    if version == "1.01" and kind == "ANY_NUM":
        pytest.skip("TC6 1.01 has no generic types")
    loaded = round_trip(
        project(
            types=f'<dataType name="T1"><baseType>{TYPES[kind]}</baseType></dataType>',
            pous=pou(
                f'<interface><returnType>{TYPES[kind]}</returnType><inputVars><variable name="v"><type>{TYPES[kind]}</type>'
                f"</variable></inputVars></interface><body>{BODIES['ST']}</body>",
                kind="function",
            ),
            version=version,
        )
    )
    declared = loaded.data_types[0].type
    interface = loaded.pou("Main").interface
    assert interface is not None
    assert interface.return_type == declared == interface.variables()[0].type
    if isinstance(declared, m.ArrayType):
        assert [(d.lower, d.upper) for d in declared.dimensions] == [("0", "MAX"), ("-1", "1")]
    if isinstance(declared, m.EnumType):
        assert [(v.name, v.value) for v in declared.values] == [("Red", "1"), ("Green", None)]
    if isinstance(declared, m.StructType):
        assert declared.members[0].comment == COMMENT


@pytest.mark.parametrize("kind", VALUES)
def test_each_kind_of_value(kind: str) -> None:
    initial = f"<initialValue>{VALUES[kind]}</initialValue>"
    loaded = round_trip(
        project(
            types=f'<dataType name="T1"><baseType><INT/></baseType>{initial}</dataType>',
            pous=pou(
                f'<interface><localVars><variable name="v" address="%QX1.0"><type><INT/></type>{initial}</variable>'
                f"</localVars></interface><body>{BODIES['ST']}</body>"
            ),
        )
    )
    value = loaded.data_types[0].initial
    assert value is not None
    assert value == loaded.pou("Main").interface.variables()[0].initial  # type: ignore[union-attr]
    expected = {"simple": "simple", "empty": "simple", "array": "array", "struct": "struct"}[kind]
    assert value.kind == expected


@pytest.mark.parametrize("flag", ["constant", "retain", "nonretain", "persistent", "nonpersistent"])
@pytest.mark.parametrize(
    ("element", "kind"),
    [
        ("localVars", "local"),
        ("tempVars", "temp"),
        ("inputVars", "input"),
        ("outputVars", "output"),
        ("inOutVars", "inOut"),
        ("externalVars", "external"),
        ("globalVars", "global"),
        ("accessVars", "access"),
    ],
)
def test_each_section_with_each_flag(element: str, kind: str, flag: str) -> None:
    variable = '<variable name="v"><type><BOOL/></type></variable>'
    loaded = round_trip(
        project(
            pou(
                f'<interface><{element} {flag}="true" name="L">{variable}</{element}></interface><body>{BODIES["ST"]}</body>'
            )
        )
    )
    (section,) = loaded.pou("Main").interface.sections  # type: ignore[union-attr]
    assert (section.kind.value, getattr(section, flag), section.name) == (kind, True, "L")
    assert [getattr(section, f) for f in ("constant", "retain", "nonretain", "persistent", "nonpersistent")].count(
        True
    ) == 1


def test_configuration_with_everything() -> None:
    loaded = round_trip(
        project(
            instances="""
<configuration name="Werk" globalId="C1">
  <resource name="SPS1">
    <task name="Schnell" single="bGo" interval="T#10ms" priority="3" globalId="K">
      <pouInstance name="i1" typeName="Main"/>
    </task>
    <globalVars name="G" retain="true"><variable name="g"><type><INT/></type></variable></globalVars>
    <pouInstance name="i2" typeName="Main"><documentation><xhtml:p>d</xhtml:p></documentation></pouInstance>
  </resource>
  <globalVars constant="true"><variable name="h"><type><INT/></type></variable></globalVars>
  <accessVars>
    <accessVariable alias="a" instancePathAndName="SPS1.x" direction="readOnly"><type><BOOL/></type></accessVariable>
    <accessVariable alias="b" instancePathAndName="SPS1.y"><type><BOOL/></type></accessVariable>
  </accessVars>
  <configVars>
    <configVariable instancePathAndName="SPS1.z" address="%MW1"><type><INT/></type>
      <initialValue><simpleValue value="7"/></initialValue></configVariable>
  </configVars>
</configuration>"""
        )
    )
    (one,) = loaded.configurations
    (resource,) = one.resources
    (task,) = resource.tasks
    assert (task.single, task.interval, task.priority, task.global_id) == ("bGo", "T#10ms", 3, "K")
    assert [i.name for i in (*task.instances, *resource.instances)] == ["i1", "i2"]
    assert resource.global_variables[0].retain
    assert one.global_variables[0].constant
    assert one.access_variables is not None
    assert [a.direction for a in one.access_variables.variables] == [m.AccessDirection.READ_ONLY, None]
    assert one.config_variables is not None
    assert one.config_variables.variables[0].initial == m.SimpleValue(text="7")


@pytest.mark.parametrize("missing", ["fileHeader", "contentHeader", "types", "instances"])
def test_missing_parts_are_reported(missing: str) -> None:
    text = project().decode()
    start = text.index(f"<{missing}")
    ends = text.index("/>", start) + 2 if missing == "fileHeader" else text.index(f"</{missing}>") + len(missing) + 3
    loaded = sfc.loads((text[:start] + text[ends:]).encode())
    assert codes(loaded) == ["XML207"]


def test_header_with_everything() -> None:
    text = project().decode()
    text = text.replace(
        'companyName=""',
        'companyName="Firma" companyURL="http://firma.example" productRelease="7" contentDescription="Text"',
    ).replace(
        '<contentHeader name="Test">',
        '<contentHeader name="Test" version="1.2" modificationDateTime="2024-02-01T00:00:00" organization="O" author="Ä" '
        'language="de-DE"><Comment>Was &amp; wie</Comment>',
    )
    text = text.replace("<coordinateInfo>", '<coordinateInfo><pageSize x="100" y="50.5"/>')
    loaded = round_trip(text.encode())
    header = loaded.header
    assert (header.company, header.company_url, header.release, header.description) == (
        "Firma",
        "http://firma.example",
        "7",
        "Text",
    )
    assert (loaded.version, loaded.organization, loaded.author, loaded.language) == ("1.2", "O", "Ä", "de-DE")
    assert loaded.content_comment == "Was & wie"
    assert loaded.scales.page == m.Scaling(x=100, y=50.5)
