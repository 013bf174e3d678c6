"""Titles, comments and names in lowered code, in English and German."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from typing import Literal, TypeAlias

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


Suffix: TypeAlias = Literal[
    "acknowledged",
    "again",
    "before",
    "edge",
    "end",
    "entered",
    "entry",
    "exit",
    "fault",
    "last",
    "late",
    "left",
    "main",
    "mode",
    "next",
    "old",
    "on",
    "over",
    "pulse",
    "runs",
    "seen",
    "start",
    "starts",
    "time",
    "timer",
]
"""Ends of the names of variables that belong to something else, in English."""


class Texts:
    """English texts."""

    language = "en"
    culture = ""
    flag_pattern = ""
    init = "Start the chain anew"
    init_input = "Init"
    stop = "holds the chain at its initial step"
    restart = "Restart"
    restart_comment = "the chain starts anew"
    initial_steps = "First scan: initial steps"
    flag_list = "StepFlags"
    drive = "Actions"
    drive_call = "Actions"
    drive_stored = "StoredActions"
    drive_stored_call = "Stored actions"
    event = "event"
    modes = "Operating modes"
    enable = "Enable"
    single_step = "SingleStep"
    without_conditions = "WithoutConditions"
    advance = "Advance"
    select = "Select"
    selected = "SelectedStep"
    selecting = "Selecting"
    selection = "Selected step"
    free = "MayFire"
    forced = "Forced"
    comments: Mapping[str, str] = {
        "Enable": "transitions may fire",
        "SingleStep": "transitions fire by a push of Advance only",
        "WithoutConditions": "a push of Advance leads on whatever the conditions are",
        "Advance": "leads one step on",
        "Select": "makes the selected step the only active one",
        "SelectedStep": "number of the step to be selected",
    }
    transitions = "Transitions"
    logic = "Logic drawn in the chart"
    times = "Step times"
    step_actions = "Steps that have changed: their actions"
    main_actions = "Actions of the active steps"
    conditions = "Conditions of actions"
    actions_end = "Back at the initial step"
    quit_error = "The error is quitted"
    pause = "Pause"
    tip = "Step by step"
    current_step = "Active step"
    table_row = "table_row"
    first_scan = "End of the first scan"
    pulse = "FirstScan"
    condition = "Condition"
    suffixes: Mapping[Suffix, str] = {}
    chain = "Step sequence"
    state = "step_number"
    state_comment = "number of the active step"
    next_state = "next_step_number"
    next_state_comment = "number of the step that will be active"
    last_state = "last_step_number"
    last_step = "last_step"
    step_time = "step_time"
    entered = "step_entered"
    entered_comment = "the active step has just become active"
    held = "no transition fires meanwhile"
    last_state_comment = "number of the step that was active in the scan before"
    active_step = "active_step"
    active_step_comment = "the active step"
    next_step = "next_step"
    next_step_comment = "the step that will be active"
    moves = "Steps that become active"
    control = "Which actions are active"
    ended = "Actions that have ended"
    steps_before = "Active steps, for the next scan"
    until_joined = "until the simultaneous branches are joined"
    step_constant = "STEP"
    waiting_constant = "PARALLEL"
    no_step = "NO_STEP"
    no_step_comment = "no step"
    enumeration = "Step"
    actions = "Actions"
    transition = "Transition"
    set_action = "set action"
    reset_action = "reset action"
    reset_actions = "reset actions"
    stability = "Search for a stable situation"
    next_evolution = "NextEvolution"
    next_evolution_title = "Next evolution, until the situation is stable"
    first_evolution = "FirstEvolution"
    first_evolution_ends = "End of the first evolution"
    start = "Start"
    terms = "Edges and times"
    events = "Actions on events"
    before = "Steps as they were before"
    forcing = "Charts that others rule"
    passed = "Steps that the scan passes"
    stored = "Stored actions"
    evolutions = "evolutions"
    moving = "moving"
    moving_comment = "a transition was cleared"
    unstable = "unstable"
    unstable_comment = "no stable situation was found"
    not_compared = "Not compared with the chart."
    read_flags = "X.. are the active steps, T.. the transitions that fire in this scan."

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

    def set_while(self, condition: str) -> str:
        """Return the comment of an action with a condition."""
        return f"set action while {condition}"

    def jump(self, step: Step, *, initial: bool, back: bool) -> str:
        """Return the comment of a change of step: to the next one, or back."""
        if initial:
            return "jump to the first step"
        return f"jump to step {step.name}" if back else "go on to the next step"

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
        return f"T{before}_{after.removeprefix('_') or self.suffixes.get('end', 'end')}"

    def with_suffix(self, name: str, suffix: Suffix) -> str:
        """Return the name of a variable that belongs to what `name` names: ``Push_edge``."""
        return f"{name}_{self.suffixes.get(suffix, suffix)}"

    def time_name(self, step: Step) -> str:
        """Return the timer of a step."""
        return self.with_suffix(self.flag_name(step), "time")

    def edge_name(self, operands: Sequence[str], *, rising: bool) -> str:
        """Return the variable of ``↑a`` or ``↓a``."""
        return "_".join([*operands[:3], "rises" if rising else "falls"])

    def delay_name(self, operands: Sequence[str], time: str) -> str:
        """Return the timer of ``3s/a`` or ``a/3s``."""
        return "_".join([*operands[:3], time.rpartition("#")[2]])

    def flag_of(self, path: str) -> str:
        """Return the comment of a step's flag."""
        return f"step {path} is active"

    def flag_title(self, name: str, address: str) -> str:
        """Return the title of the network of a step whose flag has an address."""
        return f"Step flag {name} ({address})"

    def described_flag(self, step: Step, path: str) -> str:
        """Return the same with the captions of the step, where it has no network of its own."""
        return ": ".join(filter(None, [self.flag_of(path), " ".join(self.remark(step).split())]))

    def transition_title(self, path: str) -> str:
        """Return the title of a transition's network."""
        return f"Transition {path}"

    def transition_of(self, path: str) -> str:
        """Return the comment of a transition's bit."""
        return f"transition {path} fires"

    def again_of(self, path: str) -> str:
        """Return the comment of the flag of a step that a transition leaves and enters at once."""
        return f"step {path} starts anew"

    def part(self, path: str) -> str:
        """Return the title of the CASE of a part of the chart, which begins with a step."""
        return f"Step sequence from {path}"

    def enumeration_of(self, pou: str) -> str:
        """Return the comment of the type that has the steps of a POU as values."""
        return f"steps of {pou}"

    def waiting(self, paths: Iterable[str]) -> str:
        """Return the comment of the state that waits for the end of the branches that begin with these steps."""
        return f"simultaneous branches from {', '.join(paths)}"

    def step(self, step: Step, path: str, *, initial: bool) -> str:
        """Return the title of a step's network."""
        return f"Step {_numbered(step, path)}" + (" – initial step" if initial else "")

    def step_numbers(self, net: Net, numbers: Sequence[int]) -> str:
        """Return the comment that lists the numbers of steps; empty where their names have them."""
        pairs = list(zip(net.steps, numbers, strict=True))
        if all(step_digits(step.path) == str(number) for step, number in pairs):
            return ""
        return "\n".join(f"{number} = {step.path}" for step, number in sorted(pairs, key=lambda pair: pair[1]))

    def maximum_time(self, path: str) -> str:
        """Return the title of the network that watches the time of a step."""
        return f"Maximum time of step {path}"

    def action(self, name: str) -> str:
        """Return the title of an action's network."""
        return f"Action {name}"

    # -- the header of code in a file

    def made_of(self, chart: str, source: str, version: str) -> str:
        """Return what the code was made of, and by what."""
        return f"Chart {chart}{f' of {source}' if source else ''}, as code by plcopen-sfc {version}."

    def read_states(self, variables: Sequence[str]) -> str:
        """Return what the variables of states mean."""
        if len(variables) == 1:
            return f"{variables[0]} is the active step."
        return f"{', '.join(variables)} are the active steps, one of each part of the chart."

    def read_branches(self, *, actions: bool) -> str:
        """Return how a CASE is read. `actions`: its branches have what steps do."""
        if actions:
            return "Each branch is a step: what it does, then its transitions in their order."
        return "Each branch is a step with its transitions in their order; what steps do comes behind."

    def compared(self, profile: str, verdict: str, resting: Sequence[str]) -> str:
        """Return the verdict of the comparison, and the inputs that were FALSE in it."""
        while_ = f", while {', '.join(resting)} {'is' if len(resting) == 1 else 'are'} FALSE" if resting else ""
        return f"Compared with the chart under the profile {profile}: {verdict}{while_}."

    def proven(self, states: int) -> str:
        """Return the verdict of a proof."""
        return f"equal, proven in {states} states with all inputs"

    def tested(self, runs: int, scans: int) -> str:
        """Return the verdict of directed runs."""
        return f"equal in {runs} directed runs of {scans} scans, not proven"

    def reached(self, counts: Mapping[str, tuple[int, int]]) -> str:
        """Return how much of the chart the comparison has reached, by ``step``, ``transition`` and ``action``."""
        parts = [
            f"{reached} of {all_} {kind}s" for kind, (reached, all_) in counts.items() if kind in _REACHED and all_
        ]
        return f"Reached: {', '.join(parts)}."


class GermanTexts(Texts):
    """German texts."""

    language = "de"
    culture = "de-DE"
    init = "Kette initialisieren"
    stop = "hält die Kette im Initialschritt"
    restart = "Grundstellung"
    restart_comment = "die Kette beginnt neu"
    initial_steps = "Richtimpuls: Initialschritte"
    flag_list = "Schrittmerker"
    drive = "Ansteuerung"
    drive_call = "Ansteuerung der Aktionen"
    drive_stored = "Speicherung"
    drive_stored_call = "Gespeichert wirkende Aktionen"
    event = "ereignis"
    modes = "Betriebsarten"
    enable = "Freigabe"
    single_step = "Einzelschritt"
    without_conditions = "OhneBedingungen"
    advance = "Weiterschalten"
    select = "Anwahl"
    selected = "Schrittanwahl"
    selecting = "Anwahlimpuls"
    selection = "Angewählter Schritt"
    free = "Schaltfreigabe"
    forced = "Zwangsweiterschaltung"
    comments: Mapping[str, str] = {
        "Freigabe": "Transitionen dürfen schalten",
        "Einzelschritt": "Transitionen schalten nur mit Weiterschalten",
        "OhneBedingungen": "Weiterschalten wirkt ohne Rücksicht auf Bedingungen",
        "Weiterschalten": "schaltet um einen Schritt weiter",
        "Anwahl": "macht den angewählten Schritt zum einzigen aktiven",
        "Schrittanwahl": "Nummer des Schritts, der angewählt wird",
    }
    transitions = "Transitionen"
    logic = "Logik im Ablauf"
    times = "Schrittzeiten"
    step_actions = "Aktionen bei Schrittwechsel"
    main_actions = "Aktionen der aktiven Schritte"
    conditions = "Bedingungen der Aktionen"
    actions_end = "Zurück im Initialschritt"
    quit_error = "Fehler quittieren"
    pause = "Pause"
    tip = "Schrittweise"
    current_step = "Aktiver Schritt"
    table_row = "tabellenzeile"
    first_scan = "Ende des Richtimpulses"
    pulse = "Richtimpuls"
    condition = "Bedingung"
    suffixes: Mapping[Suffix, str] = {
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
    chain = "Schrittfolge"
    state = "schrittnummer"
    state_comment = "Nummer des aktiven Schritts"
    next_state = "neue_schrittnummer"
    next_state_comment = "Nummer des Schritts, der aktiv wird"
    last_state = "letzte_schrittnummer"
    last_step = "letzter_schritt"
    step_time = "schrittzeit"
    entered = "schritt_neu"
    entered_comment = "der aktive Schritt ist gerade aktiv geworden"
    held = "solange schaltet keine Transition"
    last_state_comment = "Nummer des Schritts, der im Zyklus davor aktiv war"
    active_step = "aktiver_schritt"
    active_step_comment = "der aktive Schritt"
    next_step = "neuer_schritt"
    next_step_comment = "der Schritt, der aktiv wird"
    moves = "Schritte, die aktiv werden"
    control = "Welche Aktionen aktiv sind"
    ended = "Beendete Aktionen"
    steps_before = "Aktive Schritte, für den nächsten Zyklus"
    until_joined = "bis die parallelen Zweige zusammengeführt werden"
    step_constant = "SCHRITT"
    no_step = "KEIN_SCHRITT"
    no_step_comment = "kein Schritt"
    enumeration = "Schritt"
    actions = "Aktionen"
    transition = "Transition"
    set_action = "Aktion setzen"
    reset_action = "Aktion zurücksetzen"
    reset_actions = "Aktionen zurücksetzen"
    stability = "Suche nach einer stabilen Situation"
    next_evolution = "NaechsterLauf"
    next_evolution_title = "Nächster Durchlauf, bis die Situation stabil ist"
    first_evolution = "ErsterLauf"
    first_evolution_ends = "Ende des ersten Durchlaufs"
    start = "Start"
    terms = "Flanken und Zeiten"
    events = "Aktionen bei Ereignissen"
    before = "Schritte, wie sie zuvor waren"
    forcing = "Zwangsgesteuerte und eingeschlossene Teilpläne"
    passed = "Durchlaufene Schritte"
    stored = "Gespeichert wirkende Aktionen"
    evolutions = "durchlaeufe"
    moving = "in_bewegung"
    moving_comment = "eine Transition hat geschaltet"
    unstable = "instabil"
    unstable_comment = "es wurde keine stabile Situation gefunden"
    not_compared = "Nicht mit dem Ablauf verglichen."
    read_flags = "X.. sind die aktiven Schritte, T.. die Transitionen, die in diesem Zyklus schalten."

    def set_while(self, condition: str) -> str:
        """Return the comment of an action with a condition."""
        return f"Aktion setzen, solange {condition} aktiv"

    def jump(self, step: Step, *, initial: bool, back: bool) -> str:
        """Return the comment of going on: to the next step, or back."""
        if initial:
            return "Sprung zum ersten Schritt"
        return f"Sprung zu Schritt {step.name}" if back else "In den nächsten Schritt schalten"

    def edge_name(self, operands: Sequence[str], *, rising: bool) -> str:
        """Return the variable of ``↑a`` or ``↓a``."""
        return "_".join([*operands[:3], "steigt" if rising else "faellt"])

    def flag_title(self, name: str, address: str) -> str:
        """Return the title of the network of a step whose flag has an address."""
        return f"Schrittmerker {name} ({address})"

    def flag_of(self, path: str) -> str:
        """Return the comment of a step's flag."""
        return f"Schritt {path} ist aktiv"

    def transition_of(self, path: str) -> str:
        """Return the comment of a transition's bit."""
        return f"Transition {path} schaltet"

    def again_of(self, path: str) -> str:
        """Return the comment of the flag of a step that a transition leaves and enters at once."""
        return f"Schritt {path} beginnt neu"

    def part(self, path: str) -> str:
        """Return the title of the CASE of a part of the chart, which begins with a step."""
        return f"Schrittfolge ab {path}"

    def enumeration_of(self, pou: str) -> str:
        """Return the comment of the type that has the steps of a POU as values."""
        return f"Schritte von {pou}"

    def waiting(self, paths: Iterable[str]) -> str:
        """Return the comment of the state that waits for the end of the branches that begin with these steps."""
        return f"parallele Zweige ab {', '.join(paths)}"

    def step(self, step: Step, path: str, *, initial: bool) -> str:
        """Return the title of a step's network."""
        return f"Schritt {_numbered(step, path)}" + (" – Initialschritt" if initial else "")

    def maximum_time(self, path: str) -> str:
        """Return the title of the network that watches the time of a step."""
        return f"Höchstzeit von Schritt {path}"

    def action(self, name: str) -> str:
        """Return the title of an action's network."""
        return f"Aktion {name}"

    def made_of(self, chart: str, source: str, version: str) -> str:
        """Return what the code was made of, and by what."""
        return f"Ablauf {chart}{f' aus {source}' if source else ''}, als Code von plcopen-sfc {version}."

    def read_states(self, variables: Sequence[str]) -> str:
        """Return what the variables of states mean."""
        if len(variables) == 1:
            return f"{variables[0]} ist der aktive Schritt."
        return f"{', '.join(variables)} sind die aktiven Schritte, einer für jeden Teil des Ablaufs."

    def read_branches(self, *, actions: bool) -> str:
        """Return how a CASE is read. `actions`: its branches have what steps do."""
        if actions:
            return "Jeder Zweig ist ein Schritt: was er tut, dann seine Transitionen der Reihe nach."
        return "Jeder Zweig ist ein Schritt mit seinen Transitionen; was Schritte tun, kommt dahinter."

    def compared(self, profile: str, verdict: str, resting: Sequence[str]) -> str:
        """Return the verdict of the comparison, and the inputs that were FALSE in it."""
        while_ = f", solange {', '.join(resting)} FALSE {'ist' if len(resting) == 1 else 'sind'}" if resting else ""
        return f"Verglichen mit dem Ablauf unter dem Profil {profile}: {verdict}{while_}."

    def proven(self, states: int) -> str:
        """Return the verdict of a proof."""
        return f"gleich, bewiesen in {states} Zuständen mit allen Eingängen"

    def tested(self, runs: int, scans: int) -> str:
        """Return the verdict of directed runs."""
        return f"gleich in {runs} gezielten Läufen mit {scans} Zyklen, nicht bewiesen"

    def reached(self, counts: Mapping[str, tuple[int, int]]) -> str:
        """Return how much of the chart the comparison has reached, by ``step``, ``transition`` and ``action``."""
        parts = [f"{found} von {all_} {_REACHED[k]}" for k, (found, all_) in counts.items() if k in _REACHED and all_]
        return f"Erreicht: {', '.join(parts)}."


_REACHED = {"step": "Schritten", "transition": "Transitionen", "action": "Aktionen"}
"""Things that a header counts, with their German words."""

TEXTS = {"en": Texts(), "de": GermanTexts()}
"""The texts by language."""


class GraphTexts:
    """English texts. `language` is their tag."""

    language = "en-US"
    before = "Permanent operations before the sequence"
    after = "Permanent operations after the sequence"
    commands = "Commands and operating mode"
    checks = "Interlocks and supervisions of the active steps"
    checks_behind = "Interlocks and supervisions"
    undisturbed = "Step times without disturbance"
    manual = "Steps switched by hand"
    start = "Start of the sequence"
    off = "End of the sequence"
    skips = "Steps that are skipped"
    again = "more_skipped"
    events = "Events of steps"
    switched = "Steps that actions switch on and off"
    reports = "Operating mode and errors"
    display = "Step displayed"
    shown_data = "Data of steps that other blocks read"
    mode = "operating_mode"
    mode_comment = "0: automatic, 1: manual, 2: inching, 3: automatic or step by step"
    permitted = "satisfied_switch"
    pushed = "all_switch"
    shown = "displayed_step"
    shown_comment = "number of the step displayed"
    shown_active = "displayed_step_active"
    any_active = "any_step_active"
    leaving_one = "Actions of the step that was left"
    acting_one = "Actions of the active step"
    checks_of: Mapping[str, str] = {
        "LS": "the interlock is satisfied",
        "LA": "an error, the interlock is not satisfied",
        "L1": "the interlock is not satisfied any more",
        "L0": "the interlock is satisfied again",
        "fault": "the supervision is satisfied now",
        "VS": "the supervision is satisfied",
        "VA": "a fault holds the step",
        "V1": "the supervision becomes satisfied",
        "V0": "the supervision is not satisfied any more",
        "A1": "the fault is acknowledged now",
        "acknowledged": "the fault is acknowledged",
    }
    timer_mode = "0: stopped, 1: extended pulse, 2: on-delay, 3: off-delay"
    first_cycle = "the sequence has not been started yet"

    def wanted_of(self, path: str) -> str:
        """Return the comment of the bit that a step is active at the start of the next cycle."""
        return f"step {path} is active at the start of the next cycle"

    def leaving(self, path: str) -> str:
        """Return the title of the code of a step that was left."""
        return f"Step {path}: actions when it is left"

    def acting(self, path: str) -> str:
        """Return the title of the code of a step."""
        return f"Step {path}: actions"

    def check(self, path: str, what: str) -> str:
        """Return the comment of the result of a step's check."""
        return f"step {path}: {self.checks_of[what]}"

    def timer(self, name: str) -> str:
        """Return the title of a timer's network."""
        return f"Timer {name}"


class GermanGraphTexts(GraphTexts):
    """German texts."""

    language = "de-DE"
    before = "Permanente Operationen vor der Kette"
    after = "Permanente Operationen nach der Kette"
    commands = "Befehle und Betriebsart"
    checks = "Verriegelungen und Überwachungen der aktiven Schritte"
    checks_behind = "Verriegelungen und Überwachungen"
    undisturbed = "Schrittzeiten ohne Störung"
    manual = "Von Hand geschaltete Schritte"
    start = "Start der Kette"
    off = "Ende der Kette"
    skips = "Übersprungene Schritte"
    again = "weitere_uebersprungen"
    events = "Ereignisse der Schritte"
    switched = "Schritte, die von Aktionen ein- und ausgeschaltet werden"
    reports = "Betriebsart und Fehler"
    display = "Angezeigter Schritt"
    shown_data = "Schrittdaten, die andere Bausteine lesen"
    mode = "betriebsart"
    mode_comment = "0: Automatik, 1: Hand, 2: Tippen, 3: Automatik oder Tippen"
    permitted = "erfuellte_schalten"
    pushed = "alle_schalten"
    shown = "angezeigter_schritt"
    shown_comment = "Nummer des angezeigten Schritts"
    shown_active = "angezeigter_schritt_aktiv"
    any_active = "ein_schritt_aktiv"
    leaving_one = "Aktionen des verlassenen Schritts"
    acting_one = "Aktionen des aktiven Schritts"
    checks_of: Mapping[str, str] = {
        "LS": "die Verriegelung ist erfüllt",
        "LA": "ein Fehler, die Verriegelung ist nicht erfüllt",
        "L1": "die Verriegelung ist nicht mehr erfüllt",
        "L0": "die Verriegelung ist wieder erfüllt",
        "fault": "die Überwachung ist jetzt erfüllt",
        "VS": "die Überwachung ist erfüllt",
        "VA": "eine Störung hält den Schritt",
        "V1": "die Überwachung wird erfüllt",
        "V0": "die Überwachung ist nicht mehr erfüllt",
        "A1": "die Störung wird quittiert",
        "acknowledged": "die Störung ist quittiert",
    }
    timer_mode = "0: angehalten, 1: verlängerter Impuls, 2: Einschaltverzögerung, 3: Ausschaltverzögerung"
    first_cycle = "die Kette wurde noch nicht gestartet"

    def wanted_of(self, path: str) -> str:
        """Return the comment of the bit that a step is active at the start of the next cycle."""
        return f"Schritt {path} ist zu Beginn des nächsten Zyklus aktiv"

    def leaving(self, path: str) -> str:
        """Return the title of the code of a step that was left."""
        return f"Schritt {path}: Aktionen beim Verlassen"

    def acting(self, path: str) -> str:
        """Return the title of the code of a step."""
        return f"Schritt {path}: Aktionen"

    def check(self, path: str, what: str) -> str:
        """Return the comment of the result of a step's check."""
        return f"Schritt {path}: {self.checks_of[what]}"

    def timer(self, name: str) -> str:
        """Return the title of a timer's network."""
        return f"Zeitglied {name}"


def graph_texts(texts: Texts) -> GraphTexts:
    """Return the texts in the language of `texts`."""
    return GermanGraphTexts() if isinstance(texts, GermanTexts) else GraphTexts()
