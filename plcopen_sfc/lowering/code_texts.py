"""Titles, comments and names in lowered code, in English and German."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy

from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.semantics.net import Net, NetTransition


def step_digits(name: str) -> str:
    """Return the number that is all of a step's name: of ``S3``, ``Step_3``, ``Schritt 3``, ``3``; else empty."""
    found = re.fullmatch(r"(?i:(?:S|X|Step|Schritt)[ _]?)?(\d+)", name)
    return found.group(1) if found is not None else ""


def _transition_digits(name: str) -> str:
    """Return the same of a transition: ``T3``, ``Trans3``, ``Transition 3``, ``3``."""
    found = re.fullmatch(r"(?i:(?:T|Trans|Transition)[ _]?)?(\d+)", name)
    return found.group(1) if found is not None else ""


def _short(step: Step) -> str:
    """Return the end of the names of a step's variables: ``1`` of step 1 or S1, else ``_Fill``."""
    return str(step.number) if step.number is not None else step_digits(step.name) or f"_{step.name}"


def _numbered(step: Step, path: str) -> str:
    digits = step_digits(path)
    if step.number is None or digits == str(step.number):
        return digits or path
    return f"{step.number} {path}"


SUFFIXES: Mapping[str, str] = {
    "acknowledged": "quittiert",
    "again": "neu",
    "before": "vorher",
    "edge": "flanke",
    "end": "ende",
    "entered": "erreicht",
    "entry": "eingang",
    "exit": "ausgang",
    "fault": "stoerung",
    "last": "zuletzt",
    "late": "zu_lange",
    "left": "verlassen",
    "main": "aktion",
    "mode": "art",
    "next": "danach",
    "old": "alt",
    "on": "laeuft",
    "over": "abgelaufen",
    "pulse": "impuls",
    "runs": "laeuft",
    "seen": "durchlaufen",
    "start": "start",
    "starts": "startet",
    "time": "zeit",
    "timer": "zeitglied",
}
"""Ends of the names of variables that belong to something else: the English ones, each with the German one."""


class CodeWords:
    """Text in English and in German; an object with a `language` has it in that one."""

    def __init__(self, english: str, german: str) -> None:
        self.english, self.german = english, german

    def __get__(self, texts: Texts, kind: object = None) -> str:
        return self.german if texts.language == "de" else self.english


class Phrase:
    """Words with a place ``{}`` for each argument with which they are called."""

    def __init__(self, english: str, german: str) -> None:
        self._words = CodeWords(english, german)

    def __get__(self, texts: Texts, kind: object = None) -> Callable[..., str]:
        return self._words.__get__(texts).format


class Texts:
    """Texts in one `language`: ``en`` or ``de``."""

    culture = CodeWords("", "de-DE")
    init = CodeWords("Restart the sequence", "Kette initialisieren")
    init_input = CodeWords("Init", "Init")
    stop = CodeWords("holds the chain at its initial step", "hält die Kette im Initialschritt")
    restart = CodeWords("Restart", "Grundstellung")
    restart_comment = CodeWords("the sequence restarts", "die Kette beginnt neu")
    initial_steps = CodeWords("First scan: initial steps", "Richtimpuls: Initialschritte")
    flag_list = CodeWords("StepFlags", "Schrittmerker")
    drive = CodeWords("Actions", "Ansteuerung")
    drive_call = CodeWords("Actions", "Ansteuerung der Aktionen")
    drive_stored = CodeWords("StoredActions", "Speicherung")
    drive_stored_call = CodeWords("Stored actions", "Gespeichert wirkende Aktionen")
    event = CodeWords("event", "ereignis")
    modes = CodeWords("Operating modes", "Betriebsarten")
    enable = CodeWords("Enable", "Freigabe")
    enable_comment = CodeWords("transitions may fire", "Transitionen dürfen schalten")
    single_step = CodeWords("SingleStep", "Einzelschritt")
    single_step_comment = CodeWords(
        "transitions fire by a push of Advance only", "Transitionen schalten nur mit Weiterschalten"
    )
    without_conditions = CodeWords("WithoutConditions", "OhneBedingungen")
    without_conditions_comment = CodeWords(
        "a push of Advance leads on whatever the conditions are", "Weiterschalten wirkt ohne Rücksicht auf Bedingungen"
    )
    advance = CodeWords("Advance", "Weiterschalten")
    advance_comment = CodeWords("leads one step on", "schaltet um einen Schritt weiter")
    select = CodeWords("Select", "Anwahl")
    select_comment = CodeWords(
        "makes the selected step the only active one", "macht den angewählten Schritt zum einzigen aktiven"
    )
    selected = CodeWords("SelectedStep", "Schrittanwahl")
    selected_comment = CodeWords("number of the step to be selected", "Nummer des Schritts, der angewählt wird")
    selecting = CodeWords("Selecting", "Anwahlimpuls")
    selection = CodeWords("Selected step", "Angewählter Schritt")
    free = CodeWords("MayFire", "Schaltfreigabe")
    forced = CodeWords("Forced", "Zwangsweiterschaltung")
    transitions = CodeWords("Transitions", "Transitionen")
    logic = CodeWords("Logic drawn in the chart", "Logik im Ablauf")
    times = CodeWords("Step times", "Schrittzeiten")
    step_actions = CodeWords("Steps that have changed: their actions", "Aktionen bei Schrittwechsel")
    main_actions = CodeWords("Actions of the active steps", "Aktionen der aktiven Schritte")
    conditions = CodeWords("Conditions of actions", "Bedingungen der Aktionen")
    actions_end = CodeWords("Back at the initial step", "Zurück im Initialschritt")
    quit_error = CodeWords("The error is quitted", "Fehler quittieren")
    pause = CodeWords("Pause", "Pause")
    tip = CodeWords("Step by step", "Schrittweise")
    current_step = CodeWords("Active step", "Aktiver Schritt")
    table_row = CodeWords("table_row", "tabellenzeile")
    first_scan = CodeWords("End of the first scan", "Ende des Richtimpulses")
    pulse = CodeWords("FirstScan", "Richtimpuls")
    condition = CodeWords("Condition", "Bedingung")
    chain = CodeWords("Step sequence", "Schrittfolge")
    state = CodeWords("step_number", "schrittnummer")
    state_comment = CodeWords("number of the active step", "Nummer des aktiven Schritts")
    next_state = CodeWords("next_step_number", "neue_schrittnummer")
    next_state_comment = CodeWords("number of the step that will be active", "Nummer des Schritts, der aktiv wird")
    last_state = CodeWords("last_step_number", "letzte_schrittnummer")
    last_step = CodeWords("last_step", "letzter_schritt")
    step_time = CodeWords("step_time", "schrittzeit")
    entered = CodeWords("step_entered", "schritt_neu")
    entered_comment = CodeWords(
        "the active step has just become active", "der aktive Schritt ist gerade aktiv geworden"
    )
    held = CodeWords("no transition fires meanwhile", "solange schaltet keine Transition")
    last_state_comment = CodeWords(
        "number of the step that was active in the scan before", "Nummer des Schritts, der im Zyklus davor aktiv war"
    )
    active_step = CodeWords("active_step", "aktiver_schritt")
    active_step_comment = CodeWords("the active step", "der aktive Schritt")
    next_step = CodeWords("next_step", "neuer_schritt")
    next_step_comment = CodeWords("the step that will be active", "der Schritt, der aktiv wird")
    moves = CodeWords("Steps that become active", "Schritte, die aktiv werden")
    control = CodeWords("Which actions are active", "Welche Aktionen aktiv sind")
    ended = CodeWords("Actions that have ended", "Beendete Aktionen")
    steps_before = CodeWords("Active steps, for the next scan", "Aktive Schritte, für den nächsten Zyklus")
    until_joined = CodeWords(
        "until the simultaneous branches are joined", "bis die parallelen Zweige zusammengeführt werden"
    )
    step_constant = CodeWords("STEP", "SCHRITT")
    waiting_constant = CodeWords("PARALLEL", "PARALLEL")
    no_step = CodeWords("NO_STEP", "KEIN_SCHRITT")
    no_step_comment = CodeWords("no step", "kein Schritt")
    enumeration = CodeWords("Step", "Schritt")
    actions = CodeWords("Actions", "Aktionen")
    transition = CodeWords("Transition", "Transition")
    set_action = CodeWords("set action", "Aktion setzen")
    reset_action = CodeWords("reset action", "Aktion zurücksetzen")
    reset_actions = CodeWords("reset actions", "Aktionen zurücksetzen")
    stability = CodeWords("Search for a stable situation", "Suche nach einer stabilen Situation")
    next_evolution = CodeWords("NextEvolution", "NaechsterLauf")
    next_evolution_title = CodeWords(
        "Next evolution, until the situation is stable", "Nächster Durchlauf, bis die Situation stabil ist"
    )
    skipped = CodeWords("GoOn", "Weiter")
    first_evolution = CodeWords("FirstEvolution", "ErsterLauf")
    first_evolution_ends = CodeWords("End of the first evolution", "Ende des ersten Durchlaufs")
    start = CodeWords("Start", "Start")
    terms = CodeWords("Edges and times", "Flanken und Zeiten")
    events = CodeWords("Actions on events", "Aktionen bei Ereignissen")
    before = CodeWords("Steps as they were before", "Schritte, wie sie zuvor waren")
    forcing = CodeWords("Charts that others rule", "Zwangsgesteuerte und eingeschlossene Teilpläne")
    passed = CodeWords("Steps that the scan passes", "Durchlaufene Schritte")
    stored = CodeWords("Stored actions", "Gespeichert wirkende Aktionen")
    evolutions = CodeWords("evolutions", "durchlaeufe")
    moving = CodeWords("moving", "in_bewegung")
    moving_comment = CodeWords("a transition was cleared", "eine Transition hat geschaltet")
    unstable = CodeWords("unstable", "instabil")
    unstable_comment = CodeWords("no stable situation was found", "es wurde keine stabile Situation gefunden")
    not_compared = CodeWords("Not compared with the chart.", "Nicht mit dem Ablauf verglichen.")
    read_flags = CodeWords(
        "X.. are the active steps, T.. the transitions that fire in this scan.",
        "X.. sind die aktiven Schritte, T.. die Transitionen, die in diesem Zyklus schalten.",
    )

    # -- comments and titles of parts of the chart, by their paths and names

    flag_of = Phrase("step {} is active", "Schritt {} ist aktiv")
    flag_title = Phrase("Step flag {} ({})", "Schrittmerker {} ({})")
    transition_title = Phrase("Transition {}", "Transition {}")
    transition_of = Phrase("transition {} fires", "Transition {} schaltet")
    again_of = Phrase("step {} restarts", "Schritt {} beginnt neu")
    part = Phrase("Step sequence from {}", "Schrittfolge ab {}")
    enumeration_of = Phrase("steps of {}", "Schritte von {}")
    maximum_time = Phrase("Maximum time of step {}", "Höchstzeit von Schritt {}")
    main_actions_of = Phrase("Actions of the active steps from {}", "Aktionen der aktiven Schritte ab {}")
    maximum_time_inside = CodeWords("Maximum time", "Höchstzeit")
    action = Phrase("Action {}", "Aktion {}")
    set_while = Phrase("set action while {}", "Aktion setzen, solange {} aktiv")

    # -- sequencers of S7-GRAPH

    before_sequence = CodeWords("Permanent operations before the sequence", "Permanente Operationen vor der Kette")
    after_sequence = CodeWords("Permanent operations after the sequence", "Permanente Operationen nach der Kette")
    commands = CodeWords("Commands and operating mode", "Befehle und Betriebsart")
    checks = CodeWords(
        "Interlocks and supervisions of the active steps", "Verriegelungen und Überwachungen der aktiven Schritte"
    )
    checks_behind = CodeWords("Interlocks and supervisions", "Verriegelungen und Überwachungen")
    undisturbed = CodeWords("Step times without disturbance", "Schrittzeiten ohne Störung")
    manual = CodeWords("Steps switched by hand", "Von Hand geschaltete Schritte")
    sequence_start = CodeWords("Start of the sequence", "Start der Kette")
    off = CodeWords("End of the sequence", "Ende der Kette")
    skips = CodeWords("Steps that are skipped", "Übersprungene Schritte")
    more_skipped = CodeWords("more_skipped", "weitere_uebersprungen")
    step_events = CodeWords("Events of steps", "Ereignisse der Schritte")
    switched = CodeWords(
        "Steps that actions switch on and off", "Schritte, die von Aktionen ein- und ausgeschaltet werden"
    )
    reports = CodeWords("Operating mode and errors", "Betriebsart und Fehler")
    display = CodeWords("Step displayed", "Angezeigter Schritt")
    shown_data = CodeWords("Data of steps that other blocks read", "Schrittdaten, die andere Bausteine lesen")
    mode = CodeWords("operating_mode", "betriebsart")
    mode_comment = CodeWords(
        "0: automatic, 1: manual, 2: inching, 3: automatic or step by step",
        "0: Automatik, 1: Hand, 2: Tippen, 3: Automatik oder Tippen",
    )
    permitted = CodeWords("satisfied_switch", "erfuellte_schalten")
    pushed = CodeWords("all_switch", "alle_schalten")
    shown = CodeWords("displayed_step", "angezeigter_schritt")
    shown_comment = CodeWords("number of the step displayed", "Nummer des angezeigten Schritts")
    shown_active = CodeWords("displayed_step_active", "angezeigter_schritt_aktiv")
    any_active = CodeWords("any_step_active", "ein_schritt_aktiv")
    leaving_one = CodeWords("Actions of the step that was left", "Aktionen des verlassenen Schritts")
    acting_one = CodeWords("Actions of the active step", "Aktionen des aktiven Schritts")
    timer_mode = CodeWords(
        "0: stopped, 1: extended pulse, 2: on-delay, 3: off-delay",
        "0: angehalten, 1: verlängerter Impuls, 2: Einschaltverzögerung, 3: Ausschaltverzögerung",
    )
    first_cycle = CodeWords("the sequence has not been started yet", "die Kette wurde noch nicht gestartet")

    wanted_of = Phrase(
        "step {} is active at the start of the next cycle", "Schritt {} ist zu Beginn des nächsten Zyklus aktiv"
    )
    leaving = Phrase("Step {}: actions when it is left", "Schritt {}: Aktionen beim Verlassen")
    acting = Phrase("Step {}: actions", "Schritt {}: Aktionen")
    timer = Phrase("Timer {}", "Zeitglied {}")

    # -- the header of code in a file

    proven = Phrase(
        "equal, proven in {} states with all inputs", "gleich, bewiesen in {} Zuständen mit allen Eingängen"
    )
    tested = Phrase(
        "equal in {} directed runs of {} scans, not proven",
        "gleich in {} gezielten Läufen mit {} Zyklen, nicht bewiesen",
    )
    _from = Phrase(" of {}", " aus {}")
    _made_of = Phrase("Chart {}{}, as code by plcopen-sfc {}.", "Ablauf {}{}, als Code von plcopen-sfc {}.")
    _state = Phrase("{} is the active step.", "{} ist der aktive Schritt.")
    _states = Phrase(
        "{} are the active steps, one of each part of the chart.",
        "{} sind die aktiven Schritte, einer für jeden Teil des Ablaufs.",
    )
    _branches = CodeWords(
        "Each branch is a step with its transitions in their order; what steps do comes behind.",
        "Jeder Zweig ist ein Schritt mit seinen Transitionen; was Schritte tun, kommt dahinter.",
    )
    _branches_with_actions = CodeWords(
        "Each branch is a step: what it does, then its transitions in their order.",
        "Jeder Zweig ist ein Schritt: was er tut, dann seine Transitionen der Reihe nach.",
    )
    _compared = Phrase(
        "Compared with the chart under the profile {}: {}{}.", "Verglichen mit dem Ablauf unter dem Profil {}: {}{}."
    )
    _while_one = Phrase(", while {} is FALSE", ", solange {} FALSE ist")
    _while_some = Phrase(", while {} are FALSE", ", solange {} FALSE sind")
    _reached = Phrase("Reached: {}.", "Erreicht: {}.")
    _of_all = Phrase("{} of {} {}", "{} von {} {}")
    _initial = CodeWords("initial step", "Initialschritt")
    _step = Phrase("Step {}", "Schritt {}")
    _to_first = CodeWords("jump to the first step", "Sprung zum ersten Schritt")
    _back = Phrase("jump to step {}", "Sprung zu Schritt {}")
    _onward = CodeWords("go on to the next step", "In den nächsten Schritt schalten")
    _waiting = Phrase("simultaneous branches from {}", "parallele Zweige ab {}")
    _check = Phrase("step {}: {}", "Schritt {}: {}")
    _rises = CodeWords("rises", "steigt")
    _falls = CodeWords("falls", "faellt")

    def __init__(self, language: str = "en") -> None:
        self.language = language
        self.flag_pattern = ""

    def with_flags(self, pattern: str) -> Texts:
        """Return the same, in which flags of steps are called like that of step 1: ``SR01``, so ``SR12`` of step 12.

        Raises `ValueError` for a pattern that does not end with a 1.
        """
        if re.fullmatch(r"[^\W\d]\w*?0*1", pattern) is None:
            raise ValueError(pattern)
        found = copy(self)
        found.flag_pattern = pattern
        return found

    def captions(self, *texts: Text | None) -> str:
        """Return captions of the chart in this language where they have it, each once."""
        return "\n".join(filter(None, dict.fromkeys(plain(text, self.language) for text in texts)))

    def remark(self, element: Step | Transition) -> str:
        """Return the title and comment of a step or transition."""
        return self.captions(element.title, element.comment)

    def jump(self, step: Step, *, initial: bool, back: bool) -> str:
        """Return the comment of a change of step: to the next one, or back."""
        if initial:
            return self._to_first
        return self._back(step.name) if back else self._onward

    def flag_name(self, step: Step) -> str:
        """Return the flag of a step: ``X1`` of step 1 or S1, else with its name (``X_Fill``)."""
        short = _short(step)
        if not self.flag_pattern:
            return f"X{short}"
        start = self.flag_pattern[:-1].rstrip("0")
        return start + (short.zfill(len(self.flag_pattern) - len(start)) if short.isdigit() else short)

    def transition_name(self, net: Net, transition: NetTransition) -> str:
        """Return the bit of a transition: ``T3`` of transition 3 or Trans3, else with its name (``T_Full``).

        Without a name: with the steps that it joins, the first ones of each side (``T1_2``, ``T_Fill_Drain``). So it is
        the same when other transitions come or go.
        """
        model = transition.transition
        if model.number is not None:
            return f"T{model.number}"
        if model.name:
            return f"T{_transition_digits(model.name) or '_' + model.name}"
        sides = transition.sources, transition.targets
        before, after = (_short(net.steps[side[0]].step) if side else "" for side in sides)
        return f"T{before}_{after.removeprefix('_') or self._suffix('end')}"

    def with_suffix(self, name: str, suffix: str) -> str:
        """Return the name of a variable that belongs to what `name` names: ``Push_edge``."""
        return f"{name}_{self._suffix(suffix)}"

    def _suffix(self, suffix: str) -> str:
        german = SUFFIXES[suffix]
        return german if self.language == "de" else suffix

    def time_name(self, step: Step) -> str:
        """Return the timer of a step."""
        return self.with_suffix(self.flag_name(step), "time")

    def edge_name(self, operands: Sequence[str], *, rising: bool) -> str:
        """Return the variable of ``↑a`` or ``↓a``."""
        return "_".join([*operands[:3], self._rises if rising else self._falls])

    def delay_name(self, operands: Sequence[str], time: str) -> str:
        """Return the timer of ``3s/a`` or ``a/3s``."""
        return "_".join([*operands[:3], time.rpartition("#")[2]])

    def described_flag(self, step: Step, path: str) -> str:
        """Return the same with the captions of the step, where it has no network of its own."""
        return ": ".join(filter(None, [self.flag_of(path), " ".join(self.remark(step).split())]))

    def check(self, path: str, what: str) -> str:
        """Return the comment of the result of a check of S7-GRAPH for a step."""
        return self._check(path, _CHECKS[what].__get__(self))

    def waiting(self, paths: Iterable[str]) -> str:
        """Return the comment of the state that waits for the end of the branches that begin with these steps."""
        return self._waiting(", ".join(paths))

    def step(self, step: Step, path: str, *, initial: bool) -> str:
        """Return the title of a step's network."""
        return self._step(_numbered(step, path)) + (f" – {self._initial}" if initial else "")

    def step_numbers(self, net: Net, numbers: Sequence[int]) -> str:
        """Return the comment that lists the numbers of steps; empty where their names have them."""
        pairs = list(zip(net.steps, numbers, strict=True))
        if all(step_digits(step.path) == str(number) for step, number in pairs):
            return ""
        return "\n".join(f"{number} = {step.path}" for step, number in sorted(pairs, key=lambda pair: pair[1]))

    def made_of(self, chart: str, source: str, version: str) -> str:
        """Return a comment on the origin of the code: chart, source and version."""
        return self._made_of(chart, self._from(source) if source else "", version)

    def read_states(self, variables: Sequence[str]) -> str:
        """Return the meanings of the variables of states."""
        return (self._state if len(variables) == 1 else self._states)(", ".join(variables))

    def read_branches(self, *, actions: bool) -> str:
        """Return how a CASE is read. `actions`: its branches have what steps do."""
        return self._branches_with_actions if actions else self._branches

    def compared(self, profile: str, verdict: str, resting: Sequence[str]) -> str:
        """Return the verdict of the comparison, and the inputs that were FALSE in it."""
        while_ = self._while_one if len(resting) == 1 else self._while_some
        return self._compared(profile, verdict, while_(", ".join(resting)) if resting else "")

    def reached(self, counts: Mapping[str, tuple[int, int]]) -> str:
        """Return how much of the chart the comparison has reached, by ``step``, ``transition`` and ``action``."""
        parts = [
            self._of_all(found, all_, _REACHED[kind].__get__(self))
            for kind, (found, all_) in counts.items()
            if kind in _REACHED and all_
        ]
        return self._reached(", ".join(parts))


_REACHED: Mapping[str, CodeWords] = {
    "step": CodeWords("steps", "Schritten"),
    "transition": CodeWords("transitions", "Transitionen"),
    "action": CodeWords("actions", "Aktionen"),
}
"""Things that a header counts."""

_CHECKS: Mapping[str, CodeWords] = {
    "LS": CodeWords("the interlock is satisfied", "die Verriegelung ist erfüllt"),
    "LA": CodeWords("an error, the interlock is not satisfied", "ein Fehler, die Verriegelung ist nicht erfüllt"),
    "L1": CodeWords("the interlock is not satisfied any more", "die Verriegelung ist nicht mehr erfüllt"),
    "L0": CodeWords("the interlock is satisfied again", "die Verriegelung ist wieder erfüllt"),
    "fault": CodeWords("the supervision is satisfied now", "die Überwachung ist jetzt erfüllt"),
    "VS": CodeWords("the supervision is satisfied", "die Überwachung ist erfüllt"),
    "VA": CodeWords("a fault holds the step", "eine Störung hält den Schritt"),
    "V1": CodeWords("the supervision becomes satisfied", "die Überwachung wird erfüllt"),
    "V0": CodeWords("the supervision is not satisfied any more", "die Überwachung ist nicht mehr erfüllt"),
    "A1": CodeWords("the fault is acknowledged now", "die Störung wird quittiert"),
    "acknowledged": CodeWords("the fault is acknowledged", "die Störung ist quittiert"),
}

TEXTS = {language: Texts(language) for language in ("en", "de")}
"""The texts by language."""
