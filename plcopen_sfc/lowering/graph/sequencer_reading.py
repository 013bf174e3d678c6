"""Reading of a sequencer of S7-GRAPH, of the data of its steps that other blocks ask for, and its interface."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.binding.name_uses import Names
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.lowering.code.boolean_logic import TRUE, assignment
from plcopen_sfc.lowering.code.lowered_code import BOOL, LoweredCode
from plcopen_sfc.lowering.graph.sequencer_source import (
    QUANTITIES,
    ActionRow,
    GraphSource,
)
from plcopen_sfc.lowering.lowering_options import LoweringRules, tool_of
from plcopen_sfc.lowering.reading.chart_reading import OF_GRAFCET
from plcopen_sfc.lowering.reading.chart_source import ConditionText
from plcopen_sfc.lowering.reading.text_reading import REPAIR, TextReader
from plcopen_sfc.model.actions import COILS, COUNTERS, NEED_EVENT, NEED_TIME, SWITCHES, ActionEvent, Qualifier
from plcopen_sfc.model.declaration import Declaration
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, StructType, Variable
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.graph.graph_parameters import OPERATING, PARAMETERS, operating_inputs
from plcopen_sfc.semantics.charts.graph.interlock_conditions import programmed
from plcopen_sfc.semantics.net import Net, NetStep
from plcopen_sfc.semantics.profile import Profile

_TYPES = dict.fromkeys(("T", "U", "T_MAX", "T_WARN"), Elementary.TIME) | {"SNO": Elementary.INT}

Asked = tuple[int, str]
"""A step and a quantity of it."""


def asked_outside(project: Project, pou: Pou, net: Net, target: str | None) -> tuple[Asked, ...]:
    """Return the data of steps of `pou` that other blocks of `project` ask for.

    Raises `LoweringError` for what is no single quantity, and where `target` has no structures in blocks that others
    could read.
    """
    names = Names(project)
    steps = {step.step.name.casefold(): step for step in net.steps}
    found: dict[Asked, None] = {}
    declarations: dict[int, Declaration] = {}
    for occurrence in names.occurrences(*steps):
        # texts of the block itself are lowered with it
        if occurrence.text_site.site.pou is pou:
            continue
        step = steps[occurrence.reference.name.casefold()]
        if step.index not in declarations:
            declarations[step.index] = names.resolver.original(names.declaration_of(step.step))
        if not occurrence.refers_to(declarations[step.index]):
            continue
        quantity = occurrence.reference.access.upper()
        place = Location(path=occurrence.use.path)
        if quantity not in QUANTITIES:
            raise LoweringError(
                f"step {step.path} of {pou.name} is used in a way that is not lowered",
                location=place,
                hint="Ask for one quantity of a step: X, T ...",
            )
        if tool_of(target, Dialect.SCL) is not Tool.S7:
            raise LoweringError(
                f"{step.path}.{quantity} of {pou.name} is read here, which code for {target} does not show",
                location=place,
                hint="Let the block have an output for it.",
            )
        found[step.index, quantity] = None
    return tuple(found)


def show(asked: Sequence[Asked], values: Sequence[n.Expression], net: Net, code: LoweredCode) -> list[n.Statement]:
    """Declare structures that are called as the steps are; return the statements that write their members."""
    statements: list[n.Statement] = []
    members: dict[int, list[Variable]] = {}
    for (step, quantity), value in zip(asked, values, strict=True):
        kind: DataType = ElementaryType(name=_TYPES[quantity]) if quantity in _TYPES else BOOL
        members.setdefault(step, []).append(Variable(name=quantity, type=kind))
        name = net.steps[step].step.name
        # ``"Drill_DB".Clamp.X`` in other blocks stays as it is: the block has a structure of that name
        quoting = n.Quoting.LOCAL_QUOTED if needs_quotes(name) else n.Quoting.LOCAL
        statements.append(assignment(n.Member(n.Name(name, quoting), n.Name(quantity)), value))
    for step, variables in members.items():
        code.declare_as(net.steps[step].step.name, StructType(members=variables))
    return statements


_SYSTEM_TYPE = re.compile(r"G7_\w+", re.IGNORECASE)


def without_step_data(pou: Pou) -> Pou:
    """Return the POU without the variables that only TIA Portal declares, for steps and transitions."""
    if pou.interface is None:
        return pou
    interface = pou.interface.model_copy(deep=True)
    for section in interface.sections:
        section.variables = [
            v
            for v in section.variables
            if not (isinstance(v.type, DerivedType) and _SYSTEM_TYPE.fullmatch(v.type.name))
        ]
    return pou.model_copy(update={"interface": interface})


_WITHOUT_EVENT = frozenset({Qualifier.D, Qualifier.L, Qualifier.TF})
_ALL_STEPS = "s_all"
_NOT_KNOWN = frozenset(
    """HALT_SQ HALT_TM ZERO_OP EN_IL EN_SV EN_ACKREQ EN_SSKIP DISP_SACT DISP_SEF DISP_SALL S_SELOK ACK_S T_PREV T_NEXT
    S_TIME S_TIMEOK S_CRITLOC S_CRITLOCERR S_CRITSUP S_STATE T_NO T_MORE T_CRIT T_CRITOLD T_CRITFLT SQ_ISOFF SQ_HALTED
    TM_HALTED OP_ZEROED IL_ENABLED SV_ENABLED ACKREQ_ENABLED SSKIP_ENABLED SACT_DISP SEF_DISP SALL_DISP""".split()
)
"""Parameters of S7-GRAPH beyond the standard set (V6, user-defined), which the profile does not know."""


def read_sequencer(
    pou: Pou, chart: SfcNetwork, dialect: Dialect, rules: LoweringRules, project: Project
) -> GraphSource:
    """Read a sequencer of `pou`, a part of `project`.

    Raises `LoweringError` for what has no meaning that could be lowered.
    """
    source = _at_rest(_Reader(pou, chart, dialect, rules.profile).source(), rules.at_rest)
    return replace(source, shown=asked_outside(project, pou, source.net, rules.target))


def _at_rest(source: GraphSource, wanted: Collection[str]) -> GraphSource:
    """Return the same without the inactive inputs. Raises `ModelError` for a name that no such input has."""
    names = operating_inputs(wanted).intersection(OPERATING)
    resting = {
        variable.name.upper(): variable.name
        for variable in source.pou.variables(SectionKind.INPUT)
        if variable.name.upper() in names
    }
    parameters = {name: own for name, own in source.parameters.items() if name not in resting}
    return replace(source, parameters=parameters, at_rest=tuple(resting.values()))


class _Reader(TextReader):
    def __init__(self, pou: Pou, chart: SfcNetwork, dialect: Dialect, profile: Profile) -> None:
        super().__init__(pou, chart, dialect)
        self._profile = profile
        self._net = Net.of_sequencer(chart)
        self._variables = {v.name.casefold(): v for v in pou.interface.variables()} if pou.interface else {}

    def source(self) -> GraphSource:
        """Return the sequencer."""
        net, chart = self._net, self.chart
        if net.problems:
            self.refuse(f"the chart is broken: {net.problems[0].message}", net.problems[0].path, REPAIR)
        if net.macros or net.hierarchy:
            self.refuse("S7-GRAPH has no macro-steps, enclosing steps and forcing orders", "", OF_GRAFCET)
        settings = chart.graph_settings
        if settings is not None and (unknown := sorted(filter(self._declares, _NOT_KNOWN))):
            self.refuse(
                f"the profile has no rule for the parameters {', '.join(unknown)}",
                "",
                "Take the standard set of parameters, or delete these.",
            )
        before = [s for p in chart.permanent_pre for s in self.statements(p.body, "permanent operations before")]
        logic = self.logic()
        conditions = [self._stated(t.chart, t.transition.condition, f"transition {t.path}") for t in net.transitions]
        interlocks = dict(self._conditions("interlock"))
        supervisions = dict(self._conditions("supervision"))
        rows = tuple(tuple(self._rows(step)) for step in net.steps)
        after = [s for p in chart.permanent_post for s in self.statements(p.body, "permanent operations after")]
        always = ConditionText(TRUE, ())
        return GraphSource(
            self.pou,
            self.dialect,
            net,
            tuple((condition or always).value for condition in conditions),
            tuple((condition or always).preparation for condition in conditions),
            logic,
            tuple(self.helpers),
            actions=(),
            step_code=(),
            minimum_times={},
            instances=self.instances,
            interlocks=interlocks,
            supervisions=supervisions,
            rows=rows,
            before=tuple(before),
            after=tuple(after),
            parameters={name: self._variables[name.casefold()].name for name in PARAMETERS if self._declares(name)},
            acknowledged=bool(settings is not None and settings.acknowledge_errors_required),
            locked=bool(settings is not None and settings.lock_operating_mode),
            skips=bool(settings is not None and settings.skip_steps),
        )

    def _declares(self, name: str) -> bool:
        return name.casefold() in self._variables

    def _stated(self, chart: SfcNetwork, condition: Condition | None, path: str) -> ConditionText | None:
        """Return a condition; None for an empty network, which is satisfied."""
        stated = programmed(condition)
        if stated is None:
            return None
        return self.condition(chart, stated, path)

    def _conditions(self, kind: str) -> Iterator[tuple[int, ConditionText]]:
        for step in self._net.steps:
            found = self._stated(step.chart, step.step.conditions.get(kind), f"{kind} of step {step.path}")
            if found is not None:
                yield step.index, found

    def _rows(self, step: NetStep) -> Iterator[ActionRow]:
        model = step.step
        if any(model.step_actions.values()):
            self.refuse(
                "S7-GRAPH has no entry, main and exit actions of steps",
                f"step {step.path}",
                "Take actions with the events S1 and S0, and N.",
            )
        for number, association in enumerate(model.actions, 1):
            if not association.exclude:
                yield self._row(step, association, f"step {step.path} / action {association.target or number}")

    def _row(self, step: NetStep, model: ActionAssociation, path: str) -> ActionRow:
        qualifier = model.qualifier
        # C is no event but the interlock, written in the same column
        event = model.event if model.event is not ActionEvent.C else None
        interlock = model.interlock or model.event is ActionEvent.C
        unknown = f"the profile {self._profile.name} has no rule for the qualifier {qualifier}"
        grafcet = model.kind is not None or model.forcing is not None
        conditional = model.negated or step.step.negated or model.condition is not None
        negated = "S7-GRAPH has no negated actions and no conditions of actions"
        lacks, has = qualifier in NEED_EVENT and event is None, qualifier in _WITHOUT_EVENT and event is not None
        self.refuse_any(
            path,
            (qualifier not in self._profile.qualifiers, unknown, "Take one of S7-GRAPH: N, S, R, D, L, CALL .."),
            (grafcet, "S7-GRAPH has no actions of GRAFCET", OF_GRAFCET),
            (conditional, negated, "Take an interlock, or an assignment in an action."),
            (lacks, f"{qualifier} needs an event", "Give it one: S1 is the activation of the step."),
            (has, f"{qualifier} has no event", "Delete the event: it acts while the step is active."),
        )
        row = ActionRow(model.target or step.path, qualifier, event, interlock)
        return self._completed(row, model, path)

    def _completed(self, row: ActionRow, model: ActionAssociation, path: str) -> ActionRow:
        """Return the row with its operand or its statements."""
        qualifier, name = row.qualifier, model.target
        if qualifier in SWITCHES:
            return replace(row, switched=self._steps_named(name or "", path))
        value = model.value if qualifier in COUNTERS else model.duration
        read = self.expression(value, path) if value else None
        if model.body is not None:
            return replace(row, statements=self.statements(model.body, path))
        if name is None:
            self.refuse(f"{qualifier} has no operand", path, "Give it the operand that it acts on.")
        if qualifier in COUNTERS:
            return replace(row, target=self.expression(name, path), value=read)
        if model.value is not None:
            assigned = assignment(self.expression(name, path), self.expression(model.value, path))
            return replace(row, statements=(assigned,))
        statements = self._called(name, qualifier, path)
        if statements:
            return replace(row, statements=statements)
        target = self.expression(name, path)
        # S5 timers and counters are set by instructions only, not by an assignment
        written = isinstance(target, n.Address) and target.text.lstrip("%")[:1].upper() in "TCZ"
        lasts = qualifier in NEED_TIME and read is None
        other = f"{name} is a timer or counter of S5: other code cannot write it"
        self.refuse_any(
            path,
            (lasts, f"{qualifier} needs a time", "Give the action one, such as T#5s."),
            (written, other, "Take an instance of an IEC timer or counter."),
        )
        return replace(row, target=target, value=read)

    def _called(self, target: str, qualifier: Qualifier, path: str) -> tuple[n.Statement, ...]:
        """Return the code of a target that is no Boolean operand: an action of the POU, or the call of an instance."""
        action = self.pou.find_action(target)
        if action is not None:
            return self.statements(action.body, f"action {target}")
        if qualifier is Qualifier.CALL:
            return self.read(f"{target}();", path)
        declared = self._variables.get(target.strip('#"').casefold())
        if declared is None or declared.type == BOOL:
            return ()
        if isinstance(declared.type, ElementaryType) or qualifier not in COILS | {Qualifier.S, Qualifier.R}:
            self.refuse(
                f"{target} is no Boolean variable, and only such a one can be an action",
                path,
                f"Let an action assign it: {target} := ..",
            )
        return self.read(f"{target}();", path)

    def _steps_named(self, name: str, path: str) -> tuple[int, ...]:
        # exports name steps with or without quotes, and by number (``S3``)
        bare = name.strip('"#').casefold()
        if bare == _ALL_STEPS:
            return tuple(step.index for step in self._net.steps)
        found = [s.index for s in self._net.steps if bare in (s.step.name.casefold(), f"s{s.step.number}")]
        if not found:
            self.refuse(f"there is no step {name}", path, "Name one of the chart, by its name or number (S3).")
        return (found[0],)
