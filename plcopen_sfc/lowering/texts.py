"""What lowered code says to its readers: titles, comments and names, in English or German."""

from __future__ import annotations

from plcopen_sfc.model.sfc import Step


class Texts:
    """English texts."""

    init = "Start the chain anew"
    transitions = "Transitions"
    resets = "Steps that are left"
    sets = "Steps that are entered"
    chain = "Step sequence"
    state = "step_number"
    state_comment = "number of the active step"
    actions = "Actions"
    transition = "Transition"
    set_action = "set action"
    reset_action = "reset action"
    reset_actions = "reset actions"

    def set_while(self, condition: str) -> str:
        """The comment of an action with a condition."""
        return f"set action while {condition}"

    def jump(self, step: Step, *, initial: bool, back: bool) -> str:
        """The comment of going on: to the next step, or back."""
        if initial:
            return "jump to the first step"
        return f"jump to step {step.name}" if back else "go on to the next step"

    def flag_name(self, step: Step) -> str:
        """The flag of a step: ``X1`` of step 1 or S1, else with its name (``X_Fill``)."""
        if step.number is not None:
            return f"X{step.number}"
        digits = step.name[1:] if step.name[:1].upper() in {"S", "X"} else step.name
        return f"X{digits}" if digits.isdigit() else f"X_{step.name}"

    def flag_of(self, path: str) -> str:
        """The comment of a step's flag."""
        return f"step {path} is active"

    def transition_of(self, path: str) -> str:
        """The comment of a transition's bit."""
        return f"transition {path} fires"

    def step(self, step: Step, path: str, *, initial: bool) -> str:
        """The title of a step's network."""
        title = f"Step {path}" if step.number is None else f"Step {step.number} {path}"
        return f"{title} (initial step)" if initial else title

    def action(self, name: str) -> str:
        """The title of an action's network."""
        return f"Action {name}"


class GermanTexts(Texts):
    """German texts."""

    init = "Kette initialisieren"
    transitions = "Transitionen"
    resets = "Verlassene Schritte"
    sets = "Erreichte Schritte"
    chain = "Schrittfolge"
    state = "schrittnummer"
    state_comment = "Nummer des aktiven Schritts"
    actions = "Aktionen"
    transition = "Transition"
    set_action = "Aktion setzen"
    reset_action = "Aktion zurücksetzen"
    reset_actions = "Aktionen zurücksetzen"

    def set_while(self, condition: str) -> str:
        """The comment of an action with a condition."""
        return f"Aktion setzen, solange {condition} aktiv"

    def jump(self, step: Step, *, initial: bool, back: bool) -> str:
        """The comment of going on: to the next step, or back."""
        if initial:
            return "Sprung zum ersten Schritt"
        return f"Sprung zu Schritt {step.name}" if back else "In den nächsten Schritt schalten"

    def flag_of(self, path: str) -> str:
        """The comment of a step's flag."""
        return f"Schritt {path} ist aktiv"

    def transition_of(self, path: str) -> str:
        """The comment of a transition's bit."""
        return f"Transition {path} schaltet"

    def step(self, step: Step, path: str, *, initial: bool) -> str:
        """The title of a step's network."""
        title = f"Schritt {path}" if step.number is None else f"Schritt {step.number} {path}"
        return f"{title} (Initialschritt)" if initial else title

    def action(self, name: str) -> str:
        """The title of an action's network."""
        return f"Aktion {name}"
