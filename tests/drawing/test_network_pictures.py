"""Pictures of FBD and LD: wires lead from where a signal comes to where it goes, and nothing is on anything else."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.drawing.pictures.network_layout import Box, NetworkLayout, Wire, feedback_wires
from plcopen_sfc.model import network as n
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from tests.drawing.pictures import points

ROOT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"

Line = tuple[tuple[int, int], tuple[int, int]]


@st.composite
def circuits(draw: st.DrawFn) -> tuple[list[Box], list[Wire]]:
    boxes = []
    for _ in range(draw(st.integers(2, 9))):
        inputs, outputs = draw(st.integers(0, 3)), draw(st.integers(1, 2))
        rows = max(inputs, outputs, 1)
        levels = [28 + 20 * row for row in range(rows)]
        boxes.append(Box(draw(st.sampled_from([40, 70])), 20 + 20 * rows, levels[:inputs], levels[:outputs]))
        if inputs > 1 and draw(st.booleans()):  # branches of a ladder meet
            boxes[-1] = Box(0, 0, [0] * inputs, [0], joins=True)
    ends = [(target, place) for target, box in enumerate(boxes) for place in range(len(box.inputs))]
    wires = []
    for target, place in ends:
        for source in draw(st.lists(st.integers(0, len(boxes) - 1), max_size=2, unique=True)):
            wires.append(Wire(source, draw(st.integers(0, len(boxes[source].outputs) - 1)), target, place))
    back = feedback_wires(len(boxes), wires)
    return boxes, [wire for wire in wires if wire not in back]


def on(point: tuple[int, int], line: Line) -> bool:
    (x1, y1), (x2, y2) = line
    return min(x1, x2) <= point[0] <= max(x1, x2) and min(y1, y2) <= point[1] <= max(y1, y2)


def reached(start: tuple[int, int], lines: list[Line]) -> list[Line]:
    """The lines that touch a point, and those that touch these with an end."""
    found = [line for line in lines if on(start, line)]
    for line in found:
        found += [
            other
            for other in lines
            if other not in found and any(on(p, line) for p in other) | any(on(p, other) for p in line)
        ]
    return found


def shared(one: Line, other: Line) -> bool:
    """True if two lines have more than a point in common."""
    axis = 0 if one[0][1] == one[1][1] == other[0][1] == other[1][1] else 1
    if axis and not one[0][0] == one[1][0] == other[0][0] == other[1][0]:
        return False
    (a, b), (c, d) = (sorted(point[axis] for point in line) for line in (one, other))
    return min(b, d) - max(a, c) > 0


@settings(max_examples=60, deadline=None)
@given(circuits())
def test_wires_connect_what_they_should_and_nothing_else(circuit: tuple[list[Box], list[Wire]]) -> None:
    boxes, wires = circuit
    layout = NetworkLayout(boxes, wires)
    for one, other in combinations(boxes, 2):
        apart = one.x + one.width <= other.x or other.x + other.width <= one.x
        assert apart or one.y + one.height <= other.y or other.y + other.height <= one.y
    lines: dict[tuple[int, int], list[Line]] = {}
    for wire in wires:
        start = (
            boxes[wire.source].x + boxes[wire.source].width,
            boxes[wire.source].y + boxes[wire.source].outputs[wire.pin],
        )
        net = lines.setdefault((wire.source, wire.pin), [])
        if not net:
            nets = [line for path in layout.paths for line in path.lines if path.net == (wire.source, wire.pin)]
            net += reached(start, [line for line in nets if line[0] != line[1]])
        end = (boxes[wire.target].x, boxes[wire.target].y + boxes[wire.target].inputs[wire.place])
        assert any(on(end, line) for line in net), wire
    joined = {frozenset((a[:2], b[:2])) for a in wires for b in wires if a[2:] == b[2:]}
    for a, b in combinations(lines, 2):
        if frozenset((a, b)) not in joined:
            assert not [pair for pair in ((x, y) for x in lines[a] for y in lines[b]) if shared(*pair)]
    for net, each in lines.items():
        for (x1, y1), (x2, y2) in each:
            for box in boxes:
                inside = min(x1, x2) < box.x + box.width and max(x1, x2) > box.x
                assert not (inside and min(y1, y2) < box.y + box.height and max(y1, y2) > box.y), net


def crossings(layout: NetworkLayout) -> int:
    lines = [line for path in layout.paths for line in path.lines]
    across = [(y, min(x1, x2), max(x1, x2)) for (x1, y), (x2, y2) in lines if y == y2]
    upright = [(x, min(y1, y2), max(y1, y2)) for (x, y1), (x2, y2) in lines if x == x2 and y1 != y2]
    return sum(left < x < right and top < y < bottom for x, top, bottom in upright for y, left, right in across)


@pytest.mark.parametrize("up", [False, True])
def test_wires_beside_each_other_do_not_cross(up: bool) -> None:
    sources = [Box(40, 20, [], [10]) for _ in range(4)]
    target = Box(60, 300, [200 + 20 * row for row in range(4)] if not up else [], [])
    boxes = [*sources, target]
    if up:
        boxes = [Box(40, 400, [], [300 + 20 * row for row in range(4)]), *(Box(40, 20, [10], []) for _ in range(4))]
    wires = [Wire(0, row, 1 + row, 0) if up else Wire(row, 0, 4, row) for row in range(4)]
    layout = NetworkLayout(boxes, wires)
    assert [line for path in layout.paths for line in path.lines if line[0][1] != line[1][1]]
    assert crossings(layout) == 0


def test_a_branch_leaves_before_what_it_would_cross() -> None:
    """In LD of `lower` the way around a block crossed the wire into the second input of that block."""
    boxes = [
        Box(40, 20, [], [10]),
        Box(60, 60, [20], [20]),
        Box(60, 60, [20, 40], [20]),
        Box(60, 60, [], [20]),
        Box(40, 40, [28], [28]),
        Box(40, 20, [10], []),
    ]
    wires = [
        Wire(*each) for each in ((0, 0, 1, 0), (1, 0, 2, 0), (3, 0, 2, 1), (1, 0, 4, 0), (2, 0, 5, 0), (4, 0, 5, 0))
    ]
    assert crossings(NetworkLayout(boxes, wires)) == 0


def drawn(path: str, name: str) -> dict[str, etree._Element]:
    project = sfc.load(ROOT / "fixtures" / path)
    body = next(body for found, _, body in project.bodies() if found == name and isinstance(body, FbdBody | LdBody))
    svg = body.to_svg()
    assert svg == body.to_svg()
    tree = etree.fromstring(svg.encode("ascii"))
    return {g.findtext(f"{SVG}title"): g for g in tree.iter(f"{SVG}g")}


def texts(element: etree._Element) -> list[str]:
    return [text.text for text in element.iter(f"{SVG}text")]


def test_a_function_block_diagram() -> None:
    found = drawn("training-chain/classic_flip-flops.xml", "Ablauf")
    flip_flop = found["RS FF_X2"]
    assert flip_flop.get("class") == "block"
    assert texts(flip_flop) == ["FF_X2", "RS", "S", "R1", "Q1"]
    assert texts(found["Schritt 2"]) == ["Schritt 2"]
    # an operand of one block is at its pin and needs no wire
    assert texts(found["AND"]) == ["AND", "X3", "IN1", "B5", "IN2", "OUT"]


@pytest.mark.parametrize(
    ("dialect", "kind", "pins", "shown"),
    [
        ("iec", "RS", ("R1", "S"), ["RS", "S", "R1", "Q1"]),
        ("iec", "SR", ("R", "S1"), ["SR", "S1", "R", "Q1"]),
        ("scl", "RS", ("R1", "operand", "S"), ["State", "SR", "S", "R1", "Q"]),
        ("scl", "SR", ("S1", "R", "operand"), ["State", "RS", "R", "S1", "Q"]),
    ],
)
def test_flip_flops_have_the_names_of_their_tool(
    dialect: str, kind: str, pins: tuple[str, ...], shown: list[str]
) -> None:
    """That of TIA Portal which IEC 61131-3 calls RS is SR there; its pins were in the order of its wires."""
    inputs = [
        n.BlockVariable(name=name, input=n.InputPin(expression="State" if name == "operand" else None)) for name in pins
    ]
    parameters = n.BlockParameters(inputs=inputs, outputs=[n.BlockVariable(name="Q1")])
    block = n.Block(id=1, type_name=kind, parameters=parameters)
    body = FbdBody(networks=[n.LogicNetwork(nodes=[block])])
    pou = sfc.Pou(name="P", kind=sfc.PouKind.PROGRAM, bodies=[body])
    project = sfc.Project(pous=[pou], dialect=dialect)
    tree = etree.fromstring(project.pous[0].body.to_svg().encode("ascii"))
    assert [text.text for text in tree.iter(f"{SVG}text")] == shown


def test_a_ladder_diagram() -> None:
    found = drawn("plcopen/filling_station_2.01.xml", "DripValve")
    assert [found[f"contact {name}"].get("class") for name in ("Open", "Latch", "Close")] == ["contact"] * 3
    assert texts(found["contact Close"]) == ["Close", "/"]
    assert texts(found["coil Done"]) == ["Done", "S"]
    left, top = (int(found["contact Open"].get("data-area").split()[i]) for i in (0, 1))
    below = found["contact Latch"].get("data-area").split()
    assert (left, top) == (int(below[0]), top)
    assert int(below[1]) > top


def wire(*sources: int) -> n.InputPin:
    return n.InputPin(connections=[n.Connection(source=source) for source in sources])


def box(number: int, name: str, **inputs: int) -> n.Block:
    pins = [n.BlockVariable(name=pin, input=wire(source)) for pin, source in inputs.items()]
    parameters = n.BlockParameters(inputs=pins, outputs=[n.BlockVariable(name="OUT")])
    return n.Block(id=number, type_name=name, parameters=parameters)


@pytest.mark.parametrize(
    ("dialect", "join", "end"), [(Dialect.IEC, [], wire(1, 2)), (Dialect.SCL, [box(3, "OR", IN1=1, IN2=2)], wire(3))]
)
def test_branches_of_a_ladder_join_in_a_line(dialect: Dialect, join: list[n.Node], end: n.InputPin) -> None:
    """In LAD of TIA Portal there was a box OR with pins, and elsewhere no dot where they meet."""
    contacts = [n.Contact(id=number, variable=name, input=wire(0)) for number, name in enumerate("ab", 1)]
    nodes = [n.LeftPowerRail(id=0), *contacts, *join, n.Coil(id=9, variable="y", input=end)]
    body = LdBody(networks=[n.LogicNetwork(nodes=nodes)])
    pou = sfc.Pou(name="P", kind=sfc.PouKind.PROGRAM, bodies=[body])
    root = etree.fromstring(sfc.Project(pous=[pou], dialect=dialect).pous[0].body.to_svg().encode("ascii"))
    assert not root.findall(f".//{SVG}g[@class='block']")
    (joined,) = root.findall(f".//{SVG}g[@class='join']")
    (x, top), (across, bottom) = points(joined.find(f"{SVG}path"))
    assert x == across
    levels = [int(root.find(f".//{SVG}g[{SVG}text='{name}']").get("data-area").split()[1]) + 28 for name in "ab"]
    assert [top, bottom] == levels, "contacts are level with the ends of the line"
    assert len(joined.findall(f"{SVG}circle")) == 1


def test_a_contact_is_level_with_the_pin_that_it_leads_to() -> None:
    """The wire to a block with a heading had two corners."""
    nodes = [n.LeftPowerRail(id=0), n.Contact(id=1, variable="a", input=wire(0)), box(2, "TON", IN=1)]
    root = etree.fromstring(LdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    wires = [points(path) for path in root.iterfind(f"{SVG}path[@class='wire']")]
    assert wires
    assert len({y for line in wires for _, y in line}) == 1


def test_networks_that_share_their_rails_are_below_their_titles() -> None:
    """The right rail is at the top of the sheet: it drew all networks there, and their titles at the bottom."""
    nodes: list[n.Node] = [n.LeftPowerRail(id=0)]
    for number in (1, 2):
        nodes += [
            n.CommentBox(id=10 * number, content=f"Title {number}", position=(20, 100 * number)),
            n.Coil(id=10 * number + 1, variable=f"Q{number}", input=wire(0), position=(20, 100 * number + 20)),
        ]
    nodes[4:4] = [
        n.InputVariable(id=31, expression="Value", position=(20, 140)),
        n.OutputVariable(id=32, expression="Result", input=wire(31), position=(90, 140)),
    ]
    nodes.append(n.RightPowerRail(id=99, inputs=[wire(11), wire(21)], position=(200, 0)))
    tree = etree.fromstring(LdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    areas = {g.findtext(f"{SVG}title"): list(map(int, g.get("data-area").split())) for g in tree.iter(f"{SVG}g")}
    order = ["Title 1", "coil Q1", "Value", "Title 2", "coil Q2"]
    assert sorted(order, key=lambda name: areas[name][1]) == order
    (rail,) = (points(path)[0][0] for path in tree.iterfind(f"{SVG}path[@class='bar']"))
    assert areas["Value"][0] > rail, "the rail does not go through it"


def test_a_signal_that_comes_back_is_a_link() -> None:
    block = n.Block(
        id=1,
        type_name="OR",
        instance="Hold",
        parameters=n.BlockParameters(
            inputs=[n.BlockVariable(name="IN1", input=n.InputPin(connections=[n.Connection(source=1, pin="OUT")]))],
            outputs=[n.BlockVariable(name="OUT", output=n.OutputPin())],
        ),
    )
    svg = FbdBody(networks=[n.LogicNetwork(nodes=[block])]).to_svg()
    tree = etree.fromstring(svg.encode("ascii"))
    (link,) = tree.iter(f"{SVG}a")
    assert link.get("href") == f"#{next(tree.iter(f'{SVG}g')).get('id')}"
    assert texts(link) == ["\u2190 Hold.OUT"]


def test_operands_modifiers_and_broken_wires() -> None:
    def wire(source: int) -> n.InputPin:
        return n.InputPin(connections=[n.Connection(source=source)])

    inputs = [
        n.BlockVariable(name="IN1", input=wire(1)),
        n.BlockVariable(name="IN2", input=wire(2), negated=True),
        n.BlockVariable(name="IN3", input=wire(99)),
        n.BlockVariable(name="IN4", hidden=True),
    ]
    nodes: list[n.Node] = [
        n.InputVariable(id=1, expression="A", negated=True),
        n.InputVariable(id=2, expression="B", negated=True),
        n.Block(id=3, type_name="AND", parameters=n.BlockParameters(inputs=inputs)),
        n.InputVariable(id=4, expression="C"),
        n.OutputVariable(id=5, expression="D", input=wire(4), storage=n.Storage.SET),
        n.OutputVariable(id=6, expression="E", input=wire(4)),
        n.Coil(id=7, variable="F", input=wire(4), negated=True),
    ]
    tree = etree.fromstring(FbdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    found = {g.findtext(f"{SVG}title"): g for g in tree.iter(f"{SVG}g")}
    # A is at its pin with the circle of its negation; B, negated twice, keeps its own; the wire from nowhere is told
    assert texts(found["AND"]) == ["AND", "A", "IN1", "IN2", "?", "IN3"]
    assert len(found["AND"].findall(f"{SVG}circle")) == 2
    assert "A" not in found
    assert len(found["B"].findall(f"{SVG}circle")) == 1
    # C goes to three places: its wire divides at two dots
    assert set(found) >= {"C", "D", "E"}
    assert texts(found["D"]) == ["D", "S"]
    assert texts(found["assignment F"]) == ["F", "/"]
    assert [circle.get("class") for circle in tree.findall(f"{SVG}circle")] == ["head"] * 2


def test_numbered_pins_are_in_their_order() -> None:
    """Files of TIA Portal have them in the order of their wires; it draws IN1 above IN2."""
    names = ["EN", "IN10", "S", "IN2", "R1", "IN1"]
    inputs = [n.BlockVariable(name=name, input=n.InputPin()) for name in names]
    block = n.Block(id=1, type_name="X", parameters=n.BlockParameters(inputs=inputs))
    tree = etree.fromstring(FbdBody(networks=[n.LogicNetwork(nodes=[block])]).to_svg().encode("ascii"))
    assert texts(tree) == ["X", "EN", "IN1", "S", "IN2", "R1", "IN10"]


def test_the_power_of_a_comparison_has_no_name_in_a_ladder() -> None:
    """`pre` is a name in the XML of TIA Portal, which no tool shows."""
    nodes = [n.LeftPowerRail(id=0), box(1, "GE", pre=0, IN1=0, IN2=0)]
    tree = etree.fromstring(LdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    assert texts(tree) == ["GE", "IN1", "IN2", "OUT"]


def test_a_comparison_of_tia_portal_is_a_contact_in_a_ladder() -> None:
    """It was a box GE with IN1 and IN2, which LAD of TIA Portal does not have."""
    compare = box(3, "GE", pre=1, IN1=2)
    compare.parameters.inputs.append(n.BlockVariable(name="IN2", input=n.InputPin(expression="3")))
    contact, coil = n.Contact(id=1, variable="a", input=wire(0)), n.Coil(id=4, variable="y", input=wire(3))
    nodes = [n.LeftPowerRail(id=0), contact, n.InputVariable(id=2, expression="Level_of_tank"), compare, coil]
    tree = etree.fromstring(LdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    found = {each.findtext(f"{SVG}title"): each for each in tree.iter(f"{SVG}g")}
    shown = found["contact Level_of_tank >= 3"]
    assert shown.get("class") == "contact"
    above, sign, below = shown.findall(f"{SVG}text")
    assert (above.text, sign.text, below.text) == ("Level_of_tank", ">=", "3")
    assert int(above.get("y")) < int(sign.get("y")) < int(below.get("y"))
    assert {y for path in tree.iterfind(f"{SVG}path[@class='wire']") for _, y in points(path)} == {
        int(sign.get("y")) - 4
    }


def test_nothing_is_beside_the_left_rail() -> None:
    """A block that other blocks follow was on the rail, and wires from the rail began in the middle of nothing."""
    contact = n.Contact(id=1, variable="a", input=wire(0))
    operands = [n.InputVariable(id=number, expression=f"Operand_{number}") for number in (2, 3)]
    deep = [box(4, "XOR", IN1=2, IN2=3), box(5, "XOR", IN1=4), box(6, "XOR", IN1=5)]
    nodes = [n.LeftPowerRail(id=0), contact, *operands, *deep, box(7, "AND", IN1=1, IN2=6)]
    tree = etree.fromstring(LdBody(networks=[n.LogicNetwork(nodes=nodes)]).to_svg().encode("ascii"))
    (rail,) = (points(path) for path in tree.iterfind(f"{SVG}path[@class='bar']"))
    right = rail[0][0]
    places = [int(g.get("data-area").split()[0]) for g in tree.iter(f"{SVG}g") if g.get("class") != "rail"]
    assert places
    assert min(places) > right
    begins = [min(x for x, _ in points(path)) for path in tree.iter(f"{SVG}path") if path.get("class") == "wire"]
    assert min(begins) == right


def test_names_are_text_only() -> None:
    nasty = "<script>x</script>"
    node = n.Block(id=1, type_name=nasty, instance=nasty)
    svg = FbdBody(networks=[n.LogicNetwork(title=nasty, nodes=[node, n.CommentBox(id=2, content=nasty)])]).to_svg()
    assert "<script" not in svg
    # the heading, block and instance, the comment, and the titles of block (both names) and comment
    assert svg.count("&lt;script&gt;x&lt;/script&gt;") == 7


@pytest.mark.slow
def test_a_long_network_takes_time_in_proportion() -> None:
    # each step of the layout looks at a wire or a symbol a few times, so a chain of blocks has as many wires as blocks
    def chain(count: int) -> FbdBody:
        nodes: list[n.Node] = [n.InputVariable(id=0, expression="Start")]
        for number in range(1, count + 1):
            wire = n.InputPin(connections=[n.Connection(source=number - 1)])
            pins = n.BlockParameters(
                inputs=[n.BlockVariable(name="IN", input=wire)],
                outputs=[n.BlockVariable(name="Q", output=n.OutputPin())],
            )
            nodes.append(n.Block(id=number, type_name="TON", instance=f"T{number}", parameters=pins))
        return FbdBody(networks=[n.LogicNetwork(nodes=nodes)])

    lengths = [len(chain(count).to_svg()) for count in (500, 2000)]
    assert lengths[1] < 4.5 * lengths[0]


def test_draw_has_networks_where_there_are_no_charts(tmp_path: Path) -> None:
    project = sfc.load(ROOT / "fixtures" / "training-chain" / "classic_flip-flops.xml")
    assert [each.name for each in sfc.draw(project, tmp_path / "a.svg")] == ["Ablauf"]
    assert "<title>Ablauf</title>" in (tmp_path / "a.svg").read_text(encoding="ascii")
    conveyor = sfc.load(ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml")
    sfc.draw(conveyor, tmp_path / "belt.svg", pou="PLC_PRG.ACT_Belt")
    assert "Ladder diagram: 1 network" in (tmp_path / "belt.svg").read_text(encoding="ascii")
    with pytest.raises(sfc.ModelError, match=r"no chart 'PLC_PRG.ACT_Belt'"):
        sfc.draw(conveyor, tmp_path / "belt.mmd", pou="PLC_PRG.ACT_Belt")
