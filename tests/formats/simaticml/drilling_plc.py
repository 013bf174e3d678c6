"""Makes `fixtures/simaticml-plc`, a PLC as Openness exports it: ``python -m tests.formats.simaticml.drilling_plc``.

The chart is built with the model, as a script of a user would do it; the other blocks come from a source text.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.chart_settings import GraphSettings
from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockParameters,
    BlockVariable,
    Coil,
    Contact,
    InputPin,
    LeftPowerRail,
    LogicNetwork,
)
from plcopen_sfc.model.network import Connection as Wire
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import FileHeader, Tag, TagTable
from plcopen_sfc.model.sfc import ActionAssociation, PermanentOperation, Sequence, SfcBody, SfcNetwork, Supervised
from plcopen_sfc.model.text import MultilingualText
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from tests.corpus import ROOT

FOLDER = ROOT / "fixtures" / "simaticml-plc"
TIA = "V21"

SOURCE = """
TYPE "typeDrillData"
VERSION : 0.1
   STRUCT
      partsGood : Int;   // since the last reset
      partsBad : Int;
      feed : Real := 120.5;   // mm/min
   END_STRUCT;
END_TYPE

FUNCTION_BLOCK "FB_Chips"
TITLE = Chip conveyor
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_INPUT
      run : Bool;
      backwards : Bool;
   END_VAR
   VAR_OUTPUT
      motor : Bool;
   END_VAR
   VAR
      hours : Int;
   END_VAR
BEGIN
    IF #run AND NOT #backwards THEN
        #motor := TRUE;
        #hours := #hours + 1;
    ELSE
        #motor := FALSE;
    END_IF;
END_FUNCTION_BLOCK

DATA_BLOCK "Production"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
   VAR
      data : "typeDrillData";
      batch : Array[1..4] of Int;
      done : Bool;
   END_VAR
BEGIN
END_DATA_BLOCK

DATA_BLOCK "FB_Drilling_DB"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
"FB_Drilling"
BEGIN
END_DATA_BLOCK

DATA_BLOCK "FB_Chips_DB"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
"FB_Chips"
BEGIN
END_DATA_BLOCK
"""

STEPS = {
    "Home": ("Grundstellung", "Home position", "T#0ms", "T#0ms"),
    "Clamp": ("Spannen", "Clamp the part", "T#4s", "T#3s"),
    "Drill": ("Bohren", "Drill", "T#20s", "T#15s"),
    "Cool": ("Kühlen", "Cool the tool", "T#20s", "T#15s"),
    "Dwell": ("Freischneiden", "Dwell at the bottom", "T#3s", "T#2s"),
    "Lift": ("Heben", "Lift the spindle", "T#6s", "T#5s"),
    "Release": ("Lösen", "Release the part", "T#4s", "T#3s"),
}


def texts(german: str, english: str) -> MultilingualText:
    return MultilingualText(texts={"de-DE": german, "en-US": english})


def section(kind: SectionKind, **types: str) -> VariableSection:
    variables = [Variable.model_validate({"name": name, "type": kind_of}) for name, kind_of in types.items()]
    return VariableSection(kind=kind, variables=variables)


class DrillingActions:
    """Actions of one chart; they are numbered as they come."""

    def __init__(self, chart: SfcNetwork) -> None:
        self.chart = chart

    def act(
        self,
        step: str,
        qualifier: Qualifier,
        target: str | None = None,
        *,
        event: ActionEvent | None = None,
        interlock: bool = False,
        value: str | None = None,
        duration: str | None = None,
        call: str | None = None,
    ) -> None:
        action = ActionAssociation(id=self.chart.new_id(), qualifier=qualifier, target=target, event=event)
        action.interlock, action.value, action.duration = interlock, value, duration
        action.body = StBody(text=call) if call is not None else None
        self.chart.step(step).actions.append(action)


def drilling_chart() -> SfcNetwork:
    """Two sequences: the machine, and the conveyor for its chips, which ends when the batch is done."""
    chart = SfcNetwork()
    for name, (german, english, longest, warning) in STEPS.items():
        step = chart.add_step(name, initial=name == "Home")
        step.comment, step.max_time, step.warning_time = texts(german, english), longest, warning
    for name in ("ChipsOff", "ChipsOn"):
        chart.add_step(name, initial=name == "ChipsOff")
    step_of = {step.name: step for step in chart.steps}

    def go(name: str, sources: str, targets: str, condition: str) -> None:
        found = [[step_of[each] for each in side.split()] for side in (sources, targets)]
        transition = chart.add_transition(found[0], found[1], condition)
        transition.name, transition.priority = name, None

    go("T_Start", "Home", "Clamp", '#start AND #guard AND NOT "Production".done')
    go("T_Clamped", "Clamp", "Drill Cool", "#clamped")
    go("T_Deep", "Drill Cool", "Dwell", "#atBottom")
    go("T_Clean", "Dwell", "Lift", '#Dwell.T > T#500ms OR #pressure < "MIN_PRESSURE"')
    go("T_Worn", "Dwell", "Release", "#worn")
    go("T_Top", "Lift", "Release", "#atTop")
    go("T_Again", "Release", "Clamp", "NOT #clamped AND #start")
    go("T_Ready", "Release", "Home", "NOT #clamped AND NOT #start")
    go("T_Chips", "ChipsOff", "ChipsOn", "#Drill.X")
    go("T_NoChips", "ChipsOn", "ChipsOff", "NOT #Drill.X AND #start")
    go("T_Batch", "ChipsOn", "", '"Production".done')
    ids = {step.name: step.id for step in chart.steps}
    machine = [ids[name] for name in STEPS]
    chart.sequences = [
        Sequence(title=texts("Bearbeiten", "Machining"), steps=machine),
        Sequence(title=texts("Späneförderer", "Chip conveyor"), steps=[ids["ChipsOff"], ids["ChipsOn"]]),
    ]
    _actions(chart)
    clamp, drill, cool = chart.step("Clamp"), chart.step("Drill"), chart.step("Cool")
    clamp.interlock = Supervised(condition="#guard", title=texts("Schutz", "Guard"))
    drill.interlock = Supervised(
        condition="#guard AND #coolantOk", title=texts("Schutz und Kühlung", "Guard and coolant")
    )
    drill.supervision = Supervised(
        condition="#pressure < 2.5 AND NOT #worn",
        title=texts("Druck", "Pressure"),
        alarm=texts("Druck zu klein", "Pressure too low"),
    )
    cool.supervision = Supervised(condition="NOT #coolantOk", alarm=texts("Kühlmittel fehlt", "No coolant"))
    chart.permanent_pre = [
        PermanentOperation(
            title=texts("Meldung Schutz offen", "Message: guard open"), body=ladder("#guard", "#guardOpen")
        )
    ]
    chart.permanent_post = [PermanentOperation(title=texts("Fertig", "Done"), body=ladder("#ChipsOff.X", "#ready"))]
    chart.graph_settings = GraphSettings(version="6.0", network_language="LAD", with_alarm_handling=True)
    return chart


def _actions(chart: SfcNetwork) -> None:
    build, q, e = DrillingActions(chart), Qualifier, ActionEvent
    build.act("Clamp", q.S, "#hold", interlock=True)
    build.act("Drill", q.N, "#spindle", interlock=True)
    build.act("Drill", q.D, "#feedDown", duration="T#500ms")
    build.act("Drill", q.N, "#guardOpen", event=e.L1, value="TRUE")
    build.act("Drill", q.N, "#guardOpen", event=e.L0, value="FALSE")
    build.act("Drill", q.N, "#feedUp", event=e.V1, value="FALSE")
    build.act("Drill", q.S, "#lamp", event=e.V1)
    build.act("Drill", q.R, "#lamp", event=e.A1)
    build.act("Drill", q.N, '"Production".data.partsBad', event=e.V0, value="0")
    build.act("Cool", q.L, "#coolant", duration="T#8s")
    build.act("Cool", q.N, "#registered", event=e.R1, value="TRUE")
    build.act("Lift", q.N, "#feedUp")
    build.act("Release", q.R, "#hold", event=e.S1)
    build.act("Release", q.CALL, call='"FC_Release"();', event=e.S0)
    build.act("Release", q.ON, "ChipsOff", event=e.S0)
    build.act("ChipsOn", q.N, "#chips")


def ladder(contact: str, coil: str) -> LdBody:
    """A network with one contact and one coil."""
    nodes = [
        LeftPowerRail(id=0),
        Contact(id=1, variable=contact, negated=coil == "#guardOpen", input=InputPin(connections=[Wire(source=0)])),
        Coil(id=2, variable=coil, input=InputPin(connections=[Wire(source=1)])),
    ]
    return LdBody(networks=[LogicNetwork(nodes=nodes)])


def call(block: str, instance: str, **inputs: str) -> LogicNetwork:
    """A network that calls an instance."""
    pins = [BlockVariable(name="EN", input=InputPin())]
    for name, operand in inputs.items():
        pin = BlockVariable(name=name, input=InputPin(expression=operand))
        pin.extension_data = ExtensionData(attributes={"Type": "Bool"})
        pins.append(pin)
    parameters = BlockParameters(inputs=pins)
    node = Block(id=1, type_name=block, instance=instance, call=BlockCall.FUNCTION_BLOCK, parameters=parameters)
    return LogicNetwork(nodes=[node], title=texts("Aufruf", "Call"))


def main_block() -> Pou:
    """The organization block that calls the machine and its conveyor."""
    networks = [
        call("FB_Drilling", '"FB_Drilling_DB"', start='"Start"', guard='"GuardClosed"'),
        call("FB_Chips", '"FB_Chips_DB"', run='"FB_Drilling_DB".chips'),
    ]
    block = Pou(name="Main", kind=PouKind.ORGANIZATION_BLOCK, number=1, bodies=[FbdBody(networks=networks)])
    block.interface = Interface(sections=[VariableSection(kind=SectionKind.TEMP)])
    return block


def interface() -> Interface:
    bools = ("start", "guard", "clamped", "atBottom", "atTop", "worn", "coolantOk")
    outputs = ("hold", "spindle", "feedDown", "feedUp", "coolant", "chips", "lamp", "guardOpen", "ready")
    return Interface(
        sections=[
            section(
                SectionKind.INPUT,
                **dict.fromkeys(("OFF_SQ", "INIT_SQ", "ACK_EF", *bools), "Bool"),
                pressure="Real",
            ),
            section(SectionKind.OUTPUT, **dict.fromkeys(outputs, "Bool")),
            section(SectionKind.LOCAL, registered="Bool"),
        ]
    )


def project() -> sfc.Project:
    """The whole program."""
    plc = sfc.loads(SOURCE.encode(), format="scl")
    plc.header = FileHeader(product="TIA Portal", version=TIA)
    for thing in plc.objects():
        thing.extension_data = None
    block = Pou(name="FB_Drilling", kind=PouKind.FUNCTION_BLOCK, number=20, interface=interface())
    block.title, block.comment = texts("Bohrmaschine", "Drilling machine"), texts("Schrittkette", "Step chain")
    block.bodies = [SfcBody(chart=drilling_chart())]
    release = sfc.load(ROOT / "fixtures" / "simaticml" / "FC_Release.xml").pous[0].model_copy(deep=True)
    assert isinstance(release.bodies[0], FbdBody)
    plc.pous += [main_block(), block, release]
    plc.pou("FB_Chips").number = 21
    for number, data_block in enumerate(plc.data_blocks, 1):
        data_block.number = number
    tags = TagTable(name="Bohrmaschine")
    for place, name in enumerate(("Start", "GuardClosed", "Stop")):
        tags.tags.append(Tag(name=name, type="Bool", address=f"%I0.{place}"))
    tags.tags[0].comment = texts("Taster", "Button")
    limit = Variable.model_validate({"name": "MIN_PRESSURE", "type": "Real", "initial": "2.5"})
    tags.constants.append(limit)
    plc.tag_tables.append(tags)
    return plc


def make(folder: Path) -> None:
    """Write all documents into `folder`.

    Where a condition was text, a comment beside its network says so: an export of TIA Portal has none of these.
    """
    sfc.save(project(), f"{folder}/", format="simaticml", tia=TIA)
    for path in sorted(folder.rglob("*.xml")):
        data = path.read_bytes()
        path.write_bytes(re.sub(rb"\r\n *<!--plcopen_sfc .*?-->", b"", data))


if __name__ == "__main__":
    shutil.rmtree(FOLDER, ignore_errors=True)
    make(FOLDER)
