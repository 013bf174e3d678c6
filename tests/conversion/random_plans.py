"""Random GRAFCETs with hierarchy, as text, in which no step is only passed and no two transitions compete.

Steps wait for ``/b`` and ``b`` in turn, so that a tool without search for stability does the same, but for what it does
otherwise: that is what a conversion can be compared for.
"""

from __future__ import annotations

from random import Random

_HEAD = """GRAFCET Plan
INPUTS
    a
    b
    c
OUTPUTS
    Q1
    Q2
    Q3
    H
INTERNALS
    u
    v
    w
    n : INT
"""


def random_plan(seed: int) -> str:
    """Return the text of a GRAFCET: a chart with or without branches and a macro-step, often ruled or ruling."""
    return _Plan(Random(seed)).text()  # noqa: S311


class _Plan:
    def __init__(self, random: Random) -> None:
        self._random = random
        self._stored = random.choice(["Q1", "v"])

    def text(self) -> str:
        random = self._random
        count = random.choice([2, 4, 6])
        kind = random.choice(["plain", "macro", "branched", "choice"]) if count > 2 else "plain"
        encloses = " ENCLOSES G3{30}" if random.random() < 0.4 else ""
        lines = [_HEAD, "CHART G1\n"]
        for index in range(count):
            name, following, waits = index + 1, (index + 1) % count + 1, ("/b", "b")[index % 2]
            lines.append(self._step(name, initial=index == 0, more=encloses if index == 1 else ""))
            if kind == "macro" and index == 2:
                lines.append(f"    3 -> M1 : a * /b\n    MACRO M1\n    M1 -> 1 : {self._condition('b')}\n")
                lines.append(f"    3 -> {following} : /a * /b\n")
            elif kind == "branched" and index == 2:
                lines += ["    3 -> 51, 52 : a * /b\n", self._step(51), self._step(52, stored="u")]
                lines += [f"    51 -> 53 : {self._condition('b')}\n", self._step(53), "    53 -> 54 : /b\n"]
                lines += [self._step(54), f"    52, 54 -> 1 : b\n    3 -> {following} : /a * /b\n"]
            elif kind == "choice" and random.random() < 0.5:
                other = random.choice(range(2 - index % 2, count + 1, 2))
                lines.append(f"    {name} -> {following} : a * {waits}\n    {name} -> {other} : /a * {waits}\n")
            else:
                lines.append(f"    {name} -> {following} : {self._condition(waits)}\n")
        if kind == "macro":
            lines += ["EXPANSION M1 FROM E1 TO S1\n", self._step("E1"), f"    E1 -> 41 : {self._condition('b')}\n"]
            lines += [self._step(41), f"    41 -> S1 : {self._condition('/b')}\n    STEP S1\n"]
        if encloses:
            lines += ["ENCLOSED G3\n", self._step(30, stored="w"), f"    30 -> 31 : {self._condition('b')}\n"]
            lines.append(self._step(31, stored="w"))
            lines.append(f"    31 -> 30 : {self._condition('/b')}\n")
        if order := random.choice(["", "{INIT}", "{}", "{1}"]):
            lines.append(f"CHART G2\n    INITIAL STEP 10\n    10 -> 11 : c * b\n    STEP 11\n        FORCE G1{order}\n")
            lines.append("    11 -> 10 : /c * b\n")
        return "".join(lines)

    def _condition(self, waits: str) -> str:
        return self._random.choice([waits, waits, f"a * {waits}", f"/a . {waits}"])

    def _step(self, name: int | str, *, initial: bool = False, more: str = "", stored: str = "") -> str:
        """Return a step; steps that can be active together store in variables of their own."""
        stored = stored or self._stored
        actions = [
            "Q2",
            "Q3",
            "Q2 IF a",
            f"ON ACTIVATION {stored} := {self._random.choice(['TRUE', 'FALSE', 'a'])}",
            f"ON DEACTIVATION {stored} := {self._random.choice(['TRUE', 'FALSE', 'b'])}",
            f"ON EVENT {self._random.choice('↑↓')}a : {stored} := {self._random.choice(['TRUE', 'FALSE'])}",
            "H AFTER 20ms",
            "H FOR 20ms",
            *([f"ON ACTIVATION n := {self._random.randint(0, 2)}"] if stored == self._stored else []),
        ]
        chosen = self._random.sample(actions, self._random.choice([0, 1, 1, 2]))
        head = f"    {'INITIAL ' if initial else ''}STEP {name}{more}\n"
        return head + "".join(f"        {action}\n" for action in chosen)
