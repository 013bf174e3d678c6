"""Random GRAPH blocks with all that a model can say of them: saved, loaded, compared."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.graph_reader import USUAL_CATEGORIES
from plcopen_sfc.model import (
    AlarmCategory,
    DataBlock,
    Expression,
    GraphSettings,
    Interface,
    MultilingualText,
    PermanentOperation,
    Pou,
    Project,
    Sequence,
    SfcBody,
    SfcNetwork,
    StBody,
    Supervised,
    Tag,
    TagTable,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.body import LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Coil, Connection, Contact, InputPin, LeftPowerRail, LogicNetwork
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.types import ArrayType, DerivedType
from plcopen_sfc.model.variables import SectionKind
from tests.drawing.nets import nested_net
from tests.formats.simaticml.test_actions import rows

WORDS = st.text(alphabet="aäß €<&>\"'\n-—日", min_size=1, max_size=8).filter(lambda text: text.strip() == text)
TEXTS = st.dictionaries(st.sampled_from(("de-DE", "en-US", "zh-CN")), WORDS, min_size=1).map(
    lambda texts: MultilingualText(texts=texts)
)
LOGIC = st.sampled_from(("#a", "NOT #a", '#a AND NOT "Tag"', "#a OR #b AND #c", "#n > 3"))
TIMES = st.none() | st.sampled_from(("T#10S", "T#0MS"))
SUPERVISED = st.none() | st.builds(
    Supervised,
    condition=LOGIC.map(lambda text: Expression(text=text)),
    title=st.none() | TEXTS,
    alarm=st.none() | TEXTS,
)
FLAGS = st.none() | st.booleans()
TYPES = st.sampled_from(
    (
        "BOOL",
        "INT",
        DerivedType(name="Valve"),
        ArrayType.model_validate({"dimensions": [{"lower": "0", "upper": "3"}], "base": "INT"}),
    )
)


CATEGORIES = [
    AlarmCategory(name=name, id=number + 1, display_class=display, text="Text" if display is not None else None)
    for name, number, display, _ in USUAL_CATEGORIES[1]
]


def rung(variable: str) -> LogicNetwork:
    """A contact and a coil."""
    contact = Contact(id=2, variable=variable, input=InputPin(connections=[Connection(source=0)]))
    coil = Coil(id=3, variable='"Out"', input=InputPin(connections=[Connection(source=2)]))
    return LogicNetwork(nodes=[LeftPowerRail(id=0), contact, coil])


OPERATIONS = st.lists(
    st.builds(
        PermanentOperation,
        title=st.none() | TEXTS,
        body=st.sampled_from(("#a", '"DB".x')).map(lambda name: LdBody(networks=[rung(name)])),
    ),
    max_size=2,
)


@st.composite
def charts(draw: st.DrawFn) -> SfcNetwork:
    """A chart with times, texts, conditions, actions, permanent operations and settings."""
    chart = draw(nested_net(jumps=False))
    numbers = draw(st.permutations(range(1, len(chart.steps) + 1)))
    following = 1000
    for step, number in zip(chart.steps, numbers, strict=True):
        step.number = number
        step.max_time, step.warning_time = draw(TIMES), draw(TIMES)
        step.comment, step.title = draw(st.none() | TEXTS), draw(st.none() | TEXTS)
        step.interlock, step.supervision = draw(SUPERVISED), draw(SUPERVISED)
        for action in draw(st.lists(rows(), max_size=2)):
            following += 1
            step.actions.append(action.model_copy(update={"id": following}))
    for number, transition in enumerate(chart.transitions, 1):
        transition.name, transition.number = f"T{number}", number
        transition.comment = draw(st.none() | TEXTS)
        transition.condition = Expression(text=draw(LOGIC))
    chart.sequences = [
        Sequence(title=draw(st.none() | TEXTS), comment=draw(st.none() | TEXTS), steps=[s.id for s in chart.steps])
    ]
    chart.permanent_pre, chart.permanent_post = draw(OPERATIONS), draw(OPERATIONS)
    chart.graph_settings = GraphSettings(
        version="6.0",
        acknowledge_errors_required=draw(FLAGS),
        lock_operating_mode=draw(FLAGS),
        permanent_interlock_processing_in_manual_mode=draw(FLAGS),
        skip_steps=draw(FLAGS),
        with_alarm_handling=draw(FLAGS),
        alarm_categories=draw(st.sampled_from(([], CATEGORIES))),
    )
    return chart


@st.composite
def interfaces(draw: st.DrawFn, kinds: tuple[SectionKind, ...]) -> Interface:
    """Sections with variables."""
    sections = []
    for kind in kinds:
        names = draw(st.lists(st.sampled_from(("p", "q", "with blank", "Größe")), unique=True, max_size=3))
        variables = [
            Variable(
                name=f"{name} {kind.value}",
                type=draw(TYPES),
                comment=draw(st.none() | TEXTS),
                attributes=draw(st.sampled_from(({}, {"Remanence": "Retain"}, {"ExternalVisible": "false"}))),
            )
            for name in names
        ]
        sections.append(VariableSection(kind=kind, variables=variables))
    return Interface(sections=sections)


@st.composite
def projects(draw: st.DrawFn) -> Project:
    """A GRAPH block, a data block and a tag table."""
    kinds = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.LOCAL)
    block = Pou(
        name="Ablauf",
        kind=PouKind.FUNCTION_BLOCK,
        number=draw(st.integers(1, 9999)),
        title=draw(st.none() | TEXTS),
        comment=draw(st.none() | TEXTS),
        interface=draw(interfaces(kinds)),
        bodies=[SfcBody(chart=draw(charts()))],
    )
    data = DataBlock(name="Daten", comment=draw(st.none() | TEXTS), interface=draw(interfaces((SectionKind.LOCAL,))))
    tags = [Tag(name="Tag", type="Bool", address="%I0.0", comment=draw(st.none() | TEXTS))]
    constants = [Variable(name="LIMIT", type="INT", initial="5", comment=draw(st.none() | TEXTS))]
    return Project(
        pous=[block, Pou(name="FC_1", kind=PouKind.FUNCTION, bodies=[StBody(text="#a := 1;")])],
        data_blocks=[data],
        tag_tables=[TagTable(name="Table", tags=tags, constants=constants)],
        dialect=Dialect.SCL,
    )


def content_of(project: Project) -> dict[str, object]:
    """The content of a project, but for ids, drawings and additions of the format."""
    block = project.pou("Ablauf")
    chart = block.sfc
    assert chart is not None
    names = {step.id: step.name for step in chart.steps}
    skip = {"id", "extension_data", "interlock", "supervision", "actions"}
    return {
        "block": block.model_dump(exclude={"bodies", "extension_data"}),
        "steps": [
            (
                step.model_dump(exclude=skip),
                [action.model_dump(exclude={"id", "extension_data"}) for action in step.actions],
                [part and part.model_dump() for part in (step.interlock, step.supervision)],
            )
            for step in chart.steps
        ],
        "transitions": sorted(
            repr(
                (
                    t.model_dump(exclude={"id", "sources", "targets", "priority", "extension_data"}),
                    sorted(names[i] for i in t.sources),
                    sorted(names[i] for i in t.targets),
                )
            )
            for t in chart.transitions
        ),
        "sequences": [sequence.model_dump(exclude={"steps", "extension_data"}) for sequence in chart.sequences],
        "settings": chart.graph_settings,
        "titles": [operation.title for operation in (*chart.permanent_pre, *chart.permanent_post)],
        "data": [block.model_dump() for block in project.data_blocks],
        "tags": [table.model_dump() for table in project.tag_tables],
    }


@pytest.mark.slow
@settings(deadline=None, max_examples=8)
@given(project=projects())
def test_a_random_model_comes_back(project: Project) -> None:
    wanted = content_of(project)
    again = sfc.loads(sfc.dumps(project, format="simaticml", tia="V21"))
    found = content_of(again)
    for part, value in wanted.items():
        assert found[part] == value, part
    assert sfc.loads(sfc.dumps(again, fresh=True)) == again
