"""The files under fixtures/ are what their README says: well-formed, valid, byte-exact, and complete."""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from plcopen_sfc.cli.summary import all_charts

ROOT = Path(__file__).resolve().parents[1]
FIXTURES = ROOT / "fixtures"
XSD_DIR = Path(os.environ.get("PLCOPEN_SFC_XSD") or ROOT.parent / "shared" / "xsd")

TC6_101 = "http://www.plcopen.org/xml/tc6.xsd"
TC6_200 = "http://www.plcopen.org/xml/tc6_0200"
TC6_201 = "http://www.plcopen.org/xml/tc6_0201"
XS = "{http://www.w3.org/2001/XMLSchema}"
SCHEMAS = {TC6_101: "TC6_XML_V10_B.xsd", TC6_200: "tc6_xml_v200.xsd", TC6_201: "tc6_xml_v201.xsd"}

CODESYS = ("codesys/sorting_conveyor.xml", "codesys/distribution_belt.xml", "codesys/device_export.xml")
TWINCAT = ("twincat/press_station.xml",)
PLCOPEN = {
    "plcopen/filling_station_2.01.xml": TC6_201,
    "plcopen/filling_station_2.0.xml": TC6_200,
    "plcopen/filling_station_1.01.xml": TC6_101,
    "plcopen/every_element_2.01.xml": TC6_201,
    "plcopen/every_element_1.01.xml": TC6_101,
}
DEFECTS = (
    "broken/duplicate_local_id.xml",
    "broken/connection_to_nothing.xml",
    "broken/jump_to_nowhere.xml",
    "broken/transition_without_condition.xml",
    "broken/two_initial_steps.xml",
)
SCL = ("scl/filling_line.scl", "scl/conveyor_step7.scl")
CODESYS23 = ("codesys23/distribution_belt.EXP",)
EXPORTS = ("codesys-export/mixer.export",)
IECTEXT = ("iectext/mixing_plant.st", "iectext/distribution_belt.st")
ENCODINGS = {
    "broken/umlauts_utf8.xml": "utf-8",
    "broken/umlauts_cp1252.xml": "cp1252",
    "broken/umlauts_utf16.xml": "utf-16",
}
UNREADABLE = (
    "broken/not_xml.txt",
    "broken/truncated.xml",
    "broken/wrong_root.xml",
    "broken/unknown_version.xml",
    "broken/lying_encoding.xml",
    "broken/entity_bomb.xml",
    "broken/external_entity.xml",
    "broken/empty.xml",
    "broken/added_configuration_with_a_field_of_nobody.xml",
    "broken/no_headings.csv",
    "broken/quote_without_end.csv",
)
FOUND = (
    "broken/comment_in_code.xml",
    "broken/condition_without_wires.xml",
    "broken/delay_that_is_no_time.gct",
    "broken/extension_data_that_are_no_xml.json",
    "broken/numbers_of_5000_digits.st",
    "broken/step_times_that_are_none.EXP",
    "broken/text_without_a_beginning.EXP",
    "broken/two_data_blocks_of_one_name.scl",
    "broken/two_macro_steps_of_one_name.grafcet",
    "broken/ends_of_statements_as_actions.st",
    "broken/type_without_its_end.st",
    "broken/value_of_another_kind.json",
    "broken/view_without_entries.export",
    "broken/start_value_of_itself.st",
    "broken/variables_of_an_action.st",
    "broken/wires_from_nothing.json",
)
SOUND = (*CODESYS, *TWINCAT, *PLCOPEN, *ENCODINGS)
VALID = (*SOUND, *DEFECTS)
# The faults that sound files show on purpose: file, chart, rule. Every other file loads without a word.
DELIBERATE = {"twincat/press_station.xml": [("POU FB_Press / action ACT_Eject_Draft / jumpStep 4", "SFC106")]}
SFC_ELEMENT = "http://www.3s-software.com/plcopenxml/sfc/element"
NAME_GUID = "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8"


def parse(name: str) -> etree._Element:
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    return etree.fromstring((FIXTURES / name).read_bytes(), parser)


def namespace(root: etree._Element) -> str:
    return etree.QName(root).namespace or ""


def local(element: etree._Element) -> str:
    return etree.QName(element).localname


def xsd_path(name: str) -> Path:
    found = sorted(XSD_DIR.rglob(name)) if XSD_DIR.is_dir() else []
    if not found:
        pytest.skip(f"{name} not found under {XSD_DIR}; set PLCOPEN_SFC_XSD to the directory with the official schemas")
    return found[0]


def sfc_bodies(root: etree._Element) -> list[etree._Element]:
    return list(root.iter(f"{{{namespace(root)}}}SFC"))


def with_local_id(chart: etree._Element) -> list[etree._Element]:
    """The elements of one chart that can be wired; actions inside a block are not."""
    return [child for child in chart if isinstance(child.tag, str) and child.get("localId") is not None]


def wires(element: etree._Element) -> list[etree._Element]:
    """The connections into one element of a chart, those of a nested body left out."""
    found = element.iter(f"{{{namespace(element)}}}connection")
    return [
        wire
        for wire in found
        if not any(local(a) == "body" and element in a.iterancestors() for a in wire.iterancestors())
    ]


# -- the files and their bytes ------------------------------------------------------------------------------------


def test_every_fixture_is_listed_here_and_in_the_readme() -> None:
    written = {
        p.relative_to(FIXTURES).as_posix()
        for folder in ("codesys", "twincat", "plcopen", "iectext", "scl", "codesys23", "codesys-export", "broken")
        for p in (FIXTURES / folder).iterdir()
    }
    assert written == {*VALID, *IECTEXT, *SCL, *CODESYS23, *EXPORTS, *UNREADABLE, *FOUND}
    readme = (FIXTURES / "README.md").read_text(encoding="utf-8")
    assert [name for name in sorted(written) if f"`{name}`" not in readme] == []


@pytest.mark.parametrize("name", VALID)
def test_readable_fixtures_have_the_namespace_of_their_dialect(name: str) -> None:
    expected = PLCOPEN.get(name, TC6_200 if name.startswith(("codesys", "twincat")) else TC6_201)
    root = parse(name)
    assert root.tag == f"{{{expected}}}project"


@pytest.mark.parametrize("name", [*CODESYS, *TWINCAT])
def test_codesys_files_are_written_as_dotnet_writes_them(name: str) -> None:
    data = (FIXTURES / name).read_bytes()
    assert data.startswith(b'\xef\xbb\xbf<?xml version="1.0" encoding="utf-8"?>\r\n<project xmlns=')
    assert data.endswith(b"</project>")
    assert data.count(b"\n") == data.count(b"\r\n") == data.count(b"\r")
    assert b'<position x="0" y="0" />' in data
    assert b'"/>' not in data


@pytest.mark.parametrize(
    ("name", "start", "eol"),
    [
        ("plcopen/filling_station_2.01.xml", b"<?xml version='1.0' encoding='utf-8'?>\n", b"\n"),
        ("plcopen/filling_station_2.0.xml", b'<?xml version="1.0" encoding="UTF-8"?>\r\n<!--', b"\r\n"),
        ("plcopen/filling_station_1.01.xml", b'<?xml version="1.0" encoding="UTF-8"?>\n', b"\n"),
        ("plcopen/every_element_2.01.xml", b'<?xml version="1.0" encoding="UTF-8"?>\n', b"\n"),
        ("plcopen/every_element_1.01.xml", b'<?xml version="1.0" encoding="UTF-8"?>\r\n', b"\r\n"),
        ("broken/umlauts_utf8.xml", b"<?xml version='1.0' encoding='utf-8'?>\n", b"\n"),
        ("broken/umlauts_cp1252.xml", b"<?xml version='1.0' encoding='windows-1252'?>\r\n", b"\r\n"),
    ],
)
def test_other_files_keep_their_line_ends_and_have_no_bom(name: str, start: bytes, eol: bytes) -> None:
    data = (FIXTURES / name).read_bytes()
    assert data.startswith(start)
    assert data.count(b"\r\n") == (data.count(b"\n") if eol == b"\r\n" else 0)
    assert data.endswith(b">" + eol)


@pytest.mark.parametrize(("name", "encoding"), ENCODINGS.items())
def test_umlauts_survive_in_three_encodings(name: str, encoding: str) -> None:
    data = (FIXTURES / name).read_bytes()
    assert 'name="Füllen"' in data.decode(encoding)
    root = parse(name)
    assert [s.get("name") for s in root.iter(f"{{{TC6_201}}}step")] == ["Warten", "Füllen", "Rühren", "Ablassen"]


# -- the schema ---------------------------------------------------------------------------------------------------


def hoist(root: etree._Element) -> int:
    """Move POUs and data types from a vendor's addData to where the schema can see them."""
    ns, moved = namespace(root), 0
    for tag, parent in (("dataType", "dataTypes"), ("pou", "pous")):
        target = root.find(f"{{{ns}}}types/{{{ns}}}{parent}")
        assert target is not None
        for element in list(root.iter(f"{{{ns}}}{tag}")):
            if element.getparent() is not target:
                target.append(element)
                moved += 1
    return moved


@pytest.mark.parametrize("name", VALID)
def test_fixtures_validate_also_with_hidden_pous_hoisted(name: str) -> None:
    root = parse(name)
    schema = etree.XMLSchema(etree.parse(str(xsd_path(SCHEMAS[namespace(root)]))))
    schema.assertValid(root)
    moved = hoist(root)
    schema.assertValid(root)
    hides = name in {"codesys/distribution_belt.xml", "codesys/device_export.xml", "twincat/press_station.xml"}
    assert bool(moved) is hides


class Schema:
    """Declarations of one XSD, and those of them that documents have used."""

    def __init__(self, path: Path) -> None:
        self.root = etree.parse(str(path)).getroot()
        self.namespace = self.root.get("targetNamespace")
        self.named = {(child.tag, child.get("name")): child for child in self.root if isinstance(child.tag, str)}
        self.used: set[etree._Element] = set()
        self.values: set[tuple[etree._Element, str]] = set()

    def type_of(self, declaration: etree._Element) -> etree._Element | None:
        inline = declaration.find(f"{XS}complexType")
        if inline is not None:
            return inline
        return self.named.get((f"{XS}complexType", declaration.get("type", "").partition(":")[2]))

    def content(self, node: etree._Element) -> tuple[list[etree._Element], dict[str, etree._Element]]:
        """The element and attribute declarations of a type, groups and base types included."""
        elements: list[etree._Element] = []
        attributes: dict[str, etree._Element] = {}
        parts: list[etree._Element] = []
        for child in node:
            if child.tag == f"{XS}element":
                elements.append(child)
            elif child.tag == f"{XS}attribute":
                attributes[child.get("name", "")] = child
            elif child.tag == f"{XS}group":
                parts.append(self.named[(f"{XS}group", child.get("ref", "").partition(":")[2])])
            elif child.tag == f"{XS}extension":
                parts += [self.named[(f"{XS}complexType", child.get("base", "").partition(":")[2])], child]
            elif child.tag in {f"{XS}sequence", f"{XS}choice", f"{XS}complexContent"}:
                parts.append(child)
        for part in parts:
            more_elements, more_attributes = self.content(part)
            elements += more_elements
            attributes |= more_attributes
        return elements, attributes

    def mark(self, element: etree._Element, declaration: etree._Element | None = None) -> None:
        if declaration is None:
            declaration = self.named[(f"{XS}element", local(element))]
        self.used.add(declaration)
        node = self.type_of(declaration)
        if node is None:
            return
        elements, attributes = self.content(node)
        for name, value in element.attrib.items():
            if str(name) in attributes:
                self.used.add(attributes[str(name)])
                self.values.add((attributes[str(name)], str(value)))
        by_name = {d.get("name"): d for d in elements}
        for child in element:
            if (
                isinstance(child.tag, str)
                and etree.QName(child).namespace == self.namespace
                and local(child) in by_name
            ):
                self.mark(child, by_name[local(child)])

    def unused(self) -> list[str]:
        return [self.path(d) for d in self.root.iter(f"{XS}element", f"{XS}attribute") if d not in self.used]

    def unused_values(self) -> list[str]:
        """Values of enumerations that no attribute of that type has; the type is taken over all its attributes."""
        seen: dict[etree._Element, set[str]] = {}
        for attribute, value in self.values:
            node = attribute.find(f"{XS}simpleType")
            if node is None:
                node = self.named.get((f"{XS}simpleType", attribute.get("type", "").partition(":")[2]))
            if node is not None:
                seen.setdefault(node, set()).add(value)
        return [
            f"{self.path(node)}={enumeration.get('value')}"
            for node in self.root.iter(f"{XS}simpleType")
            for enumeration in node.iter(f"{XS}enumeration")
            if enumeration.get("value") not in seen.get(node, set())
        ]

    @staticmethod
    def path(node: etree._Element) -> str:
        names = [a.get("name") for a in (node, *node.iterancestors()) if a.get("name")]
        return "/".join(str(n) for n in reversed(names))


@pytest.mark.parametrize("name", ["plcopen/every_element_2.01.xml", "plcopen/every_element_1.01.xml"])
def test_every_declared_element_attribute_and_value_occurs(name: str) -> None:
    root = parse(name)
    schema = Schema(xsd_path(SCHEMAS[namespace(root)]))
    schema.mark(root)
    assert schema.unused() == []
    assert schema.unused_values() == []


# -- the charts ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SOUND)
def test_sound_charts_are_sound(name: str) -> None:
    root = parse(name)
    ns = namespace(root)
    for body in sfc_bodies(root):
        elements = with_local_id(body)
        ids = {e.get("localId") for e in elements}
        assert len(ids) == len(elements)
        assert {c.get("refLocalId") for e in elements for c in wires(e)} <= ids
        steps = [e for e in elements if local(e) == "step"]
        assert [e.get("initialStep") for e in steps].count("true") == 1
        names = {e.get("name") for e in elements if local(e) in {"step", "macroStep", "simultaneousDivergence"}}
        assert len({e.get("name") for e in steps}) == len(steps)
        assert {e.get("targetName") for e in elements if local(e) == "jumpStep"} <= names
        assert all(e.find(f"{{{ns}}}condition") is not None for e in elements if local(e) == "transition")


@pytest.mark.parametrize("name", SOUND)
def test_sound_charts_can_run(name: str) -> None:
    """Steps and transitions alternate: a selection is below a step, and every transition leads somewhere."""
    project = sfc.load(FIXTURES / name)
    for chart, _, network in all_charts(project):
        loose = [t.id for t in network.transitions if not t.sources or not t.targets]
        assert loose == [], chart
        reached = {target for t in network.transitions for target in t.targets}
        assert {s.id for s in network.steps} - reached <= {s.id for s in network.initial_steps}, chart
    assert [(d.location.path, d.code) for d in project.diagnostics] == DELIBERATE.get(name, [])


@pytest.mark.parametrize("name", SOUND)
def test_every_selection_stands_below_a_step_or_a_branch(name: str) -> None:
    root = parse(name)
    for body in sfc_bodies(root):
        by_id = {e.get("localId"): e for e in with_local_id(body)}
        for element in by_id.values():
            if local(element) == "selectionDivergence":
                (wire,) = wires(element)
                above = local(by_id[wire.get("refLocalId")])
                assert above in {"step", "macroStep", "selectionDivergence"}, element.get("localId")


@pytest.mark.slow
def test_the_readme_counts_what_the_charts_hold(capsys: pytest.CaptureFixture[str]) -> None:
    columns = ("steps", "transitions", "selections", "simultaneous_branches", "jumps")
    written: dict[str, list[tuple[str, tuple[int, ...]]]] = {}
    file = ""
    for line in (FIXTURES / "README.md").read_text(encoding="utf-8").splitlines():
        row = re.fullmatch(r"\| (?:`(\S+\.xml)`: )?`([^`]+)`(?: \([a-z ]+\))? \|((?: \d+ \|){5})", line)
        if row is not None:
            file = row[1] or file
            counts = tuple(int(cell) for cell in row[3].strip(" |").split("|"))
            written.setdefault(file, []).append((row[2], counts))
    seen = set()
    for pattern, charts in written.items():
        for path in FIXTURES.glob(f"*/{pattern}"):
            capsys.readouterr()
            main(["info", "--json", str(path)])
            (found,) = json.loads(capsys.readouterr().out)["files"]
            assert [(c["name"], tuple(c[column] for column in columns)) for c in found["charts"]] == charts, path.name
            seen.add(path.relative_to(FIXTURES).as_posix())
    assert seen == {*CODESYS, *TWINCAT, *PLCOPEN}


@pytest.mark.parametrize("name", PLCOPEN)
def test_drawn_charts_have_no_symbol_on_another(name: str) -> None:
    root = parse(name)
    q = f"{{{namespace(root)}}}"
    for body in sfc_bodies(root):
        boxes: list[tuple[str, float, float, float, float]] = []
        for element in with_local_id(body):
            position = element.find(f"{q}position")
            assert position is not None
            x, y = float(position.get("x", "")), float(position.get("y", ""))
            size = (float(element.get("width", "0")), float(element.get("height", "0")))
            boxes.append((element.get("localId", ""), x, y, x + size[0], y + size[1]))
        for number, (one, left, top, right, bottom) in enumerate(boxes):
            for other, x, y, x_end, y_end in boxes[number + 1 :]:
                assert not (left < x_end and x < right and top < y_end and y < bottom), (one, other)


@pytest.mark.parametrize(
    ("name", "defects"),
    [
        ("broken/duplicate_local_id.xml", Counter(duplicate=1)),
        ("broken/connection_to_nothing.xml", Counter(dangling=1)),
        ("broken/jump_to_nowhere.xml", Counter(lost=1)),
        ("broken/transition_without_condition.xml", Counter(unconditional=1)),
        ("broken/two_initial_steps.xml", Counter(initial=1)),
    ],
)
def test_broken_charts_have_one_defect_each(name: str, defects: Counter[str]) -> None:
    root = parse(name)
    (body,) = sfc_bodies(root)
    elements = with_local_id(body)
    ids = [e.get("localId") for e in elements]
    names = {e.get("name") for e in elements if local(e) == "step"}
    found = Counter(
        duplicate=len(ids) - len(set(ids)),
        dangling=sum(c.get("refLocalId") not in ids for e in elements for c in wires(e)),
        lost=sum(local(e) == "jumpStep" and e.get("targetName") not in names for e in elements),
        unconditional=sum(local(e) == "transition" and e.find(f"{{{TC6_201}}}condition") is None for e in elements),
        initial=sum(e.get("initialStep") == "true" for e in elements) - 1,
    )
    assert +found == defects


def test_scl_sources_are_written_as_their_tools_write_them() -> None:
    tia, classic = ((FIXTURES / name).read_bytes() for name in SCL)
    assert tia.startswith(b"\xef\xbb\xbf//")
    assert tia.decode("utf-8-sig").count("Grüße") == 1
    assert classic.startswith("// Förderband".encode("cp1252"))
    for data in (tia, classic):
        assert data.count(b"\n") == data.count(b"\r\n") == data.count(b"\r")


def test_texts_say_what_their_sources_say() -> None:
    belt = sfc.load(FIXTURES / "iectext/distribution_belt.st")
    assert belt == sfc.load(FIXTURES / "codesys/distribution_belt.xml")
    for name in IECTEXT:
        data = (FIXTURES / name).read_bytes()
        assert data.endswith(b"\n")
        assert b"\r" not in data
        assert sfc.load(FIXTURES / name).diagnostics == ()
    assert b"{" not in (FIXTURES / "iectext/mixing_plant.st").read_bytes()


def test_unreadable_files_are_unreadable_for_their_reason() -> None:
    for name in ("broken/not_xml.txt", "broken/truncated.xml", "broken/lying_encoding.xml", "broken/empty.xml"):
        with pytest.raises(etree.XMLSyntaxError):
            parse(name)
    with pytest.raises(UnicodeDecodeError):
        (FIXTURES / "broken/lying_encoding.xml").read_bytes().decode("utf-8")
    assert namespace(parse("broken/unknown_version.xml")) == "http://www.plcopen.org/xml/tc6_0305"
    assert local(parse("broken/wrong_root.xml")) != "project"
    assert (FIXTURES / "broken/entity_bomb.xml").read_bytes().count(b"<!ENTITY") == 10
    assert b'SYSTEM "file:' in (FIXTURES / "broken/external_entity.xml").read_bytes()
    assert (FIXTURES / "broken/empty.xml").stat().st_size == 0


# -- the habits of the CODESYS family -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*CODESYS, *TWINCAT])
def test_codesys_charts_follow_the_exporters_habits(name: str) -> None:
    root = parse(name)
    q = f"{{{TC6_200}}}"
    kinds = {
        "step",
        "inVariable",
        "transition",
        "actionBlock",
        "jumpStep",
        "selectionDivergence",
        "selectionConvergence",
    }
    kinds |= {"simultaneousDivergence", "simultaneousConvergence"}
    for body in sfc_bodies(root):
        elements = with_local_id(body)
        numbered = sorted(
            int(e.get("localId", "-1")) for e in body.iter() if isinstance(e.tag, str) and e.get("localId")
        )
        assert numbered == list(range(len(numbered)))
        assert {local(e) for e in elements} <= kinds
        assert local(elements[0]) == "step"
        assert elements[0].get("initialStep") == "true"
        assert local(elements[-1]) == "jumpStep"
        for element in elements:
            own = int(element.get("localId", "-1"))
            flow = element.findall(f"{q}connectionPointIn/{q}connection")
            assert all(int(c.get("refLocalId", "-1")) < own for c in flow)
            marked = local(element) in {"transition", "selectionConvergence", "simultaneousConvergence"}
            assert {c.get("formalParameter") for c in flow} <= ({"sfc"} if marked else {None})
            bare = local(element) in {"inVariable", "actionBlock", "selectionConvergence", "simultaneousConvergence"}
            assert (element.find(f"{q}addData/{q}data[@name='{SFC_ELEMENT}']/attributes") is None) is bare
        by_id = {e.get("localId"): e for e in elements}
        for transition in body.findall(f"{q}transition"):
            (wire,) = transition.findall(f"{q}condition/{q}connectionPointIn/{q}connection")
            expression = by_id[wire.get("refLocalId")].findtext(f"{q}expression")
            shown = [a.text for a in transition.iter("attribute") if a.get("guid") == NAME_GUID]
            assert shown == [expression]


def test_pous_live_in_all_three_places() -> None:
    q = f"{{{TC6_200}}}"
    pool = parse("codesys/sorting_conveyor.xml").findall(f"{q}types/{q}pous/{q}pou")
    application = parse("codesys/distribution_belt.xml").findall(
        f"{q}addData/{q}data/{q}resource/{q}addData/{q}data/{q}pou"
    )
    device = parse("codesys/device_export.xml").findall(
        f"{q}instances/{q}configurations/{q}configuration/{q}resource/{q}addData/{q}data/{q}pou"
    )
    assert (len(pool), len(application), len(device)) == (3, 3, 3)


def quirks(root: etree._Element) -> Counter[str]:
    """Count the wires and names that the textbook grammar does not know."""
    q = f"{{{namespace(root)}}}"
    found: Counter[str] = Counter()
    for body in sfc_bodies(root):
        by_id = {e.get("localId"): e for e in with_local_id(body)}
        for element in by_id.values():
            sources = [
                local(by_id[c.get("refLocalId")]) for c in element.findall(f"{q}connectionPointIn/{q}connection")
            ]
            for source in sources:
                found[f"{local(element)} <- {source}"] += 1
            if local(element).endswith("Convergence") and set(sources) == {"jumpStep"}:
                found["convergence of jumps only"] += 1
        divergences = sum(local(e).endswith("Divergence") for e in by_id.values())
        convergences = sum(local(e).endswith("Convergence") for e in by_id.values())
        found["divergence without convergence"] += divergences - convergences
        action = next((a for a in body.iterancestors() if local(a) == "action"), None)
        if action is not None:
            suffix = f"_{action.get('name')}"
            found["suffixed step name"] += sum(str(s.get("name")).endswith(suffix) for s in body.findall(f"{q}step"))
        for attribute in body.iter("attribute"):
            found["dotted step action"] += attribute.get("guid", "")[:8] in {
                "700a583f",
                "a6b08bd8",
                "a2621e18",
            } and "." in (attribute.text or "")
        for expression in body.iter(f"{q}expression"):
            words = (expression.text or "").split()
            found["keyword in the user's case"] += any(w in {"and", "or", "not", "True", "False"} for w in words)
    return found


def test_every_quirk_of_the_codesys_family_occurs() -> None:
    total: Counter[str] = Counter()
    for name in (*CODESYS, *TWINCAT):
        total += quirks(parse(name))
    for quirk in (
        "selectionConvergence <- jumpStep",
        "convergence of jumps only",
        "simultaneousConvergence <- jumpStep",
        "selectionDivergence <- selectionDivergence",
        "selectionConvergence <- selectionConvergence",
        "selectionConvergence <- step",
        "transition <- selectionConvergence",
        "jumpStep <- step",
        "jumpStep <- selectionConvergence",
        "suffixed step name",
        "dotted step action",
        "keyword in the user's case",
    ):
        assert total[quirk], quirk
    assert total["divergence without convergence"] == 0


def test_sorting_conveyor_sets_every_attribute_that_codesys_knows() -> None:
    guids = {a.get("guid") for a in parse("codesys/sorting_conveyor.xml").iter("attribute") if a.get("guid")}
    assert len(guids) == 14


def test_filling_station_uses_all_twelve_qualifiers() -> None:
    for name in (
        "plcopen/filling_station_2.01.xml",
        "plcopen/filling_station_2.0.xml",
        "plcopen/filling_station_1.01.xml",
    ):
        root = parse(name)
        q = f"{{{namespace(root)}}}"
        used = {a.get("qualifier", "N") for block in root.iter(f"{q}actionBlock") for a in block.findall(f"{q}action")}
        assert used == {"P1", "N", "P0", "R", "S", "L", "D", "P", "DS", "DL", "SD", "SL"}
