"""Settings of charts: the SFC flags of CODESYS, and the block settings and alarms of S7-GRAPH."""

from __future__ import annotations

from enum import StrEnum

from pydantic import Field

from plcopen_sfc.model.base import Model


class SfcFlag(StrEnum):
    """The implicit variables that control and report on a chart (CODESYS V3 "SFC flags")."""

    ENABLE_LIMIT = "EnableLimit"
    INIT = "Init"
    RESET = "Reset"
    QUIT_ERROR = "QuitError"
    PAUSE = "Pause"
    ERROR = "Error"
    TRANS = "Trans"
    ERROR_STEP = "ErrorStep"
    ERROR_POU = "ErrorPOU"
    CURRENT_STEP = "CurrentStep"
    CURRENT_STEPS = "CurrentSteps"
    META_STEPS = "MetaSteps"
    TIP = "Tip"
    TIP_MODE = "TipMode"
    MAX_FLAGS = "MaxFlags"
    ERROR_ANALYZATION = "SFCErrorAnalyzation"
    ERROR_ANALYZATION_TABLE = "SFCErrorAnalyzationTable"

    @property
    def variable(self) -> str:
        """The name of the variable in programs: ``SFCInit``."""
        return self.value if self.value.startswith("SFC") else f"SFC{self.value}"


NEED_ERROR = frozenset(
    {
        SfcFlag.ENABLE_LIMIT,
        SfcFlag.ERROR_STEP,
        SfcFlag.ERROR_POU,
        SfcFlag.QUIT_ERROR,
        SfcFlag.ERROR_ANALYZATION,
        SfcFlag.ERROR_ANALYZATION_TABLE,
    }
)
"""Flags that only work together with SFCError."""

OPERATING_FLAGS = frozenset(
    {SfcFlag.INIT, SfcFlag.RESET, SfcFlag.PAUSE, SfcFlag.QUIT_ERROR, SfcFlag.TIP, SfcFlag.TIP_MODE}
)
"""The flags with which people and programs operate a chart."""

WATCHING_FLAGS = frozenset({SfcFlag.ERROR, SfcFlag.ENABLE_LIMIT})
"""The flags by which a chart watches the maximum times of its steps."""


class FlagUse(Model):
    """`use`: the chart obeys or sets the flag. `declare`: the tool declares its variable."""

    use: bool = False
    declare: bool = True


class RuntimeLibrary(Model):
    """The library that executes charts (CODESYS ``IecSfc``)."""

    title: str = ""
    company: str = ""
    version: str = ""
    namespace: str = ""


class SfcSettings(Model):
    """The SFC settings of a POU or action (CODESYS V3.5 SP8 on)."""

    flags: dict[SfcFlag, FlagUse] = Field(default_factory=dict)
    other_flags: dict[str, FlagUse] = Field(default_factory=dict)
    library: RuntimeLibrary | None = None
    active_transitions_only: bool | None = None
    use_defaults: bool | None = None


GRAPH_INPUTS = (
    *"OFF_SQ INIT_SQ ACK_EF REG_EF REG_S S_ON S_OFF T_PUSH S_PREV S_NEXT SW_AUTO SW_MAN SW_TAP SW_TOP S_SEL".split(),
    *"ACK_S HALT_SQ HALT_TM ZERO_OP EN_IL EN_SV EN_ACKREQ EN_SSKIP DISP_SACT DISP_SEF DISP_SALL".split(),
    *"S_SELOK T_PREV T_NEXT".split(),
)
"""All inputs that operate a sequencer, those of the maximum parameter set included (S7-GRAPH V6)."""
GRAPH_OUTPUTS = (
    *"S_NO S_MORE S_ACTIVE ERR_FLT AUTO_ON MAN_ON TAP_ON TOP_ON".split(),
    *"S_TIME S_TIMEOK S_CRITLOC S_CRITLOCERR S_CRITSUP S_STATE T_NO T_MORE T_CRIT T_CRITOLD T_CRITFLT".split(),
    *"ERROR FAULT SQ_ISOFF SQ_HALTED TM_HALTED OP_ZEROED IL_ENABLED SV_ENABLED ACKREQ_ENABLED".split(),
    *"SSKIP_ENABLED SACT_DISP SEF_DISP SALL_DISP".split(),
)
"""All outputs by which a sequencer tells its state, those of the maximum parameter set included (S7-GRAPH V6)."""


class AlarmCategory(Model):
    """An alarm category of an S7-GRAPH block: `name` as in the file, its id, display class and text."""

    name: str
    id: int
    display_class: int | None = None
    text: str | None = None


class GraphSettings(Model):
    """Block settings of S7-GRAPH (block attributes of TIA Openness). None: not stated.

    `acknowledge_errors_required`: a supervision error stays until ACK_EF acknowledges it. `lock_operating_mode`: the
    operating mode cannot be changed. `permanent_interlock_processing_in_manual_mode`: interlocks are evaluated in
    manual mode too. `skip_steps`: a step is skipped when the transitions before and after it are satisfied at once.
    `with_alarm_handling`: errors make alarms, in the `alarm_categories`. `version` is that of the library of
    S7-GRAPH (``GraphVersion``), `network_language` that of new networks.

    Inputs of the block control the chart: INIT_SQ activates the initial steps and no others; OFF_SQ deactivates all
    steps; ACK_EF acknowledges errors. SW_AUTO, SW_TAP, SW_TOP and SW_MAN choose the operating mode: automatic (a
    satisfied transition switches), inching (it needs a rising edge of T_PUSH too), automatic or inching (one of both
    is enough), and manual (S_SEL is the number of the step, S_ON and S_OFF activate and deactivate it). S_PREV and
    S_NEXT choose the step whose number the output S_NO shows; S_MORE: more steps are active, S_ACTIVE: this one is;
    ERR_FLT: there is an error; AUTO_ON, TAP_ON, TOP_ON, MAN_ON: the mode. (S7-GRAPH V6)
    """

    version: str | None = None
    acknowledge_errors_required: bool | None = None
    lock_operating_mode: bool | None = None
    permanent_interlock_processing_in_manual_mode: bool | None = None
    skip_steps: bool | None = None
    with_alarm_handling: bool | None = None
    initial_values_acquisition: str | None = None
    network_language: str | None = None
    alarm_categories: list[AlarmCategory] = Field(default_factory=list)
