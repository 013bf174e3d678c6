"""How many scans a second charts and programs run: compiled, as `plcopen_sfc` does, and walked node by node.

    python -m benchmarks.execution              all of it
    python -m benchmarks.execution case         one contestant, as JSON

The chart has 100 steps in a ring, each with an action, and 100 transitions, of which 50 have conditions of several
comparisons and operators; ``parallel`` has the same in five simultaneous branches. The programs are what they are
lowered to: one CASE, and transition and step bits.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import plcopen_sfc as sfc
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements
from plcopen_sfc.languages.st.literals import literal_value
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.model import Project

STEPS = 100
BRANCHES = 5
OUTPUTS = 20
LEVELS = 10
SECONDS = 2.0
ROOT = Path(__file__).resolve().parents[1]

Scan = Callable[[int], None]


def condition(number: int) -> str:
    """Every second condition is that of an engineer, the others ask for one input."""
    if number % 2:
        return f"In{number % OUTPUTS}"
    level = number % LEVELS
    return (
        f"Level{level} > {10 + number} AND (In{number % OUTPUTS} OR NOT Door) AND NOT (Level{level} >= {900 + number})"
    )


def ring() -> tuple[list[tuple[tuple[int, ...], tuple[int, ...]]], int]:
    """Sources and targets of the transitions of a ring, and how many steps it has."""
    return [((i,), ((i + 1) % STEPS,)) for i in range(STEPS)], STEPS


def branches() -> tuple[list[tuple[tuple[int, ...], tuple[int, ...]]], int]:
    """The same for five branches side by side between a fork and a join."""
    length = (STEPS - 2) // BRANCHES
    firsts = [2 + branch * length for branch in range(BRANCHES)]
    links: list[tuple[tuple[int, ...], tuple[int, ...]]] = [((0,), tuple(firsts))]
    for first in firsts:
        links += [((first + i,), (first + i + 1,)) for i in range(length - 1)]
    links.append((tuple(first + length - 1 for first in firsts), (1,)))
    links.append(((1,), (0,)))
    return links, 2 + BRANCHES * length


def _declarations(more: str = "") -> str:
    inputs = [f"In{i} : BOOL;" for i in range(OUTPUTS)] + [f"Level{i} : INT;" for i in range(LEVELS)] + ["Door : BOOL;"]
    outputs = [f"Q{i} : BOOL;" for i in range(OUTPUTS)]
    return f"VAR_INPUT {' '.join(inputs)} END_VAR\nVAR_OUTPUT {' '.join(outputs)} END_VAR\nVAR {more} END_VAR\n"


def _load(text: str) -> Project:
    return sfc.loads(text.encode(), format="iec-text")


def chart(*, parallel: bool) -> Project:
    """The chart in textual SFC."""
    links, steps = branches() if parallel else ring()
    lines = ["PROGRAM Main", _declarations()]
    for step in range(steps):
        kind = "INITIAL_STEP" if step == 0 else "STEP"
        lines.append(f"{kind} S{step}: Q{step % OUTPUTS}(N); END_STEP")
    for number, (sources, targets) in enumerate(links):
        sides = [", ".join(f"S{i}" for i in side) for side in (sources, targets)]
        sides = [f"({side})" if "," in side else side for side in sides]
        lines.append(f"TRANSITION FROM {sides[0]} TO {sides[1]} := {condition(number)}; END_TRANSITION")
    return _load("\n".join([*lines, "END_PROGRAM", ""]))


def case_text() -> str:
    """The ring as one CASE."""
    lines = ["CASE s OF"]
    lines += [f"{i}: IF {condition(i)} THEN s := {(i + 1) % STEPS}; END_IF;" for i in range(STEPS)]
    lines.append("END_CASE;")
    for output in range(OUTPUTS):
        lines.append(f"Q{output} := {' OR '.join(f's = {i}' for i in range(output, STEPS, OUTPUTS))};")
    return "\n".join(lines)


def bits_text() -> str:
    """The ring with transition bits, then step bits, then outputs."""
    lines = [f"T{i} := X{i} AND {condition(i)};" for i in range(STEPS)]
    lines += [f"X{i} := T{(i - 1) % STEPS} OR X{i} AND NOT T{i};" for i in range(STEPS)]
    for output in range(OUTPUTS):
        lines.append(f"Q{output} := {' OR '.join(f'X{i}' for i in range(output, STEPS, OUTPUTS))};")
    return "\n".join(lines)


def _program(text: str, variables: str) -> Project:
    return _load(f"PROGRAM Main\n{_declarations(variables)}{text}\nEND_PROGRAM\n")


CASE_VARIABLES = "s : INT;"
BIT_VARIABLES = " ".join(f"X{i} : BOOL{' := TRUE' if i == 0 else ''}; T{i} : BOOL;" for i in range(STEPS))


# -- compiled


def compiled(project: Project) -> Scan:
    """Scans of an instance; every scan moves some inputs."""
    from plcopen_sfc.semantics.charts import compile_chart  # noqa: PLC0415  # only this contestant
    from plcopen_sfc.semantics.profile import PROFILES  # noqa: PLC0415
    from plcopen_sfc.semantics.programs import Controller  # noqa: PLC0415

    controller = Controller(project, PROFILES["iec"], chart_compiler=compile_chart)
    instance = controller.instance("Main")
    for name, value in _inputs(0).items():
        instance[name] = value
    cell, index = instance.cell("In3")

    def run(scans: int) -> None:
        scan = instance.scan
        for number in range(scans):
            cell[index] = number & 1 == 0
            controller.now += 10_000_000
            scan()

    return run


def recorded(project: Project) -> Scan:
    """`simulate`: the same, with every input and output recorded."""

    def run(scans: int) -> None:
        initial: dict[str, object] = dict(_inputs(0))
        sfc.simulate(
            project, scans=scans, profile="iec", initial=initial, inputs=lambda scan, _: {"In3": scan & 1 == 0}
        )

    return run


def _inputs(scan: int) -> dict[str, Any]:
    return (
        {f"In{i}": True for i in range(OUTPUTS)} | {f"Level{i}": 500 for i in range(LEVELS)} | {"Door": bool(scan & 1)}
    )


# -- walked


def evaluate(node: Any, values: dict[str, Any]) -> Any:
    """The value of an expression, node by node."""
    match node:
        case n.Name():
            return values[node.identifier]
        case n.Literal():
            if node.text not in _LITERALS:
                _LITERALS[node.text] = literal_value(node).value
            return _LITERALS[node.text]
        case n.Parenthesized():
            return evaluate(node.inner, values)
        case n.Unary(operator=Operator.NOT):
            return not evaluate(node.operand, values)
        case n.Operation(operator=Operator.AND):
            return all(evaluate(each, values) for each in node.operands)
        case n.Operation(operator=Operator.OR):
            return any(evaluate(each, values) for each in node.operands)
        case n.Operation():
            left, right = (evaluate(each, values) for each in node.operands)
            return _COMPARE[node.operator](left, right)
    raise NotImplementedError(type(node).__name__)


_LITERALS: dict[str, Any] = {}
_COMPARE: dict[Operator, Callable[[Any, Any], bool]] = {
    Operator.GREATER: lambda a, b: bool(a > b),
    Operator.GREATER_OR_EQUAL: lambda a, b: bool(a >= b),
    Operator.EQUAL: lambda a, b: bool(a == b),
}


def execute(statements: Any, values: dict[str, Any]) -> None:
    """Statements, node by node."""
    branch: Any
    for each in statements:
        node: Any = each
        match node:
            case n.Assignment():
                target: Any = node.target
                values[target.identifier] = evaluate(node.value, values)
            case n.If():
                for branch in node.branches:
                    if evaluate(branch.condition, values):
                        execute(branch.statements, values)
                        break
            case n.Case():
                wanted = evaluate(node.selector, values)
                for branch in node.branches:
                    if any(evaluate(label, values) == wanted for label in branch.labels):
                        execute(branch.statements, values)
                        break


def walked_chart(*, parallel: bool) -> Scan:
    """A chart whose transitions and conditions are looked at one after another."""
    links, steps = branches() if parallel else ring()
    conditions = [parse_condition(condition(number)).tree for number in range(len(links))]
    values: dict[str, Any] = _inputs(0) | {f"Q{i}": False for i in range(OUTPUTS)}
    active = {0}

    def run(scans: int) -> None:
        nonlocal active
        for number in range(scans):
            values["In3"] = number & 1 == 0
            fired = [
                (sources, targets)
                for tree, (sources, targets) in zip(conditions, links, strict=True)
                if all(source in active for source in sources) and evaluate(tree, values)
            ]
            active = active - {i for sources, _ in fired for i in sources} | {i for _, t in fired for i in t}
            for output in range(OUTPUTS):
                values[f"Q{output}"] = any(step in active for step in range(output, steps, OUTPUTS))

    return run


def walked_program(text: str) -> Scan:
    """A program walked statement by statement."""
    statements = parse_statements(text).tree.statements
    values = _inputs(0) | {"s": 0} | {f"X{i}": i == 0 for i in range(STEPS)} | {f"T{i}": False for i in range(STEPS)}

    def run(scans: int) -> None:
        for number in range(scans):
            values["In3"] = number & 1 == 0
            execute(statements, values)

    return run


CONTESTANTS: dict[str, Callable[[], Scan]] = {
    "chart": lambda: compiled(chart(parallel=False)),
    "chart walked": lambda: walked_chart(parallel=False),
    "parallel": lambda: compiled(chart(parallel=True)),
    "parallel walked": lambda: walked_chart(parallel=True),
    "simulate": lambda: recorded(chart(parallel=False)),
    "case": lambda: compiled(_program(case_text(), CASE_VARIABLES)),
    "case walked": lambda: walked_program(case_text()),
    "bits": lambda: compiled(_program(bits_text(), BIT_VARIABLES)),
    "bits walked": lambda: walked_program(bits_text()),
}
GOALS = {"chart": 20_000, "parallel": 20_000, "case": 50_000, "bits": 50_000}


def measure(name: str, seconds: float = SECONDS) -> float:
    """Scans in a second of processor time."""
    run = CONTESTANTS[name]()
    run(200)
    scans, spent = 200, 0.0
    while spent < seconds / 4:
        scans *= 2
        start = time.process_time()
        run(scans)
        spent = time.process_time() - start
    return scans / spent


def in_process(name: str) -> float:
    """The same in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.execution", name]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT)
    return float(json.loads(done.stdout))


def proof() -> str:
    """The ring against its step bits: how many states were searched, and how long that took."""
    from plcopen_sfc.analysis import equivalent  # noqa: PLC0415

    links, steps = ring()
    lines = [
        f"T{t} := {' AND '.join([*(f'X{i}' for i in sources), f'({condition(t)})'])};"
        for t, (sources, _) in enumerate(links)
    ]
    for t, (sources, _) in enumerate(links):
        lines.append(f"IF T{t} THEN {' '.join(f'X{i} := FALSE;' for i in sources)} END_IF;")
    for t, (_, targets) in enumerate(links):
        lines.append(f"IF T{t} THEN {' '.join(f'X{i} := TRUE;' for i in targets)} END_IF;")
    for output in range(OUTPUTS):
        lines.append(f"Q{output} := {' OR '.join(f'X{i}' for i in range(output, steps, OUTPUTS))};")
    variables = " ".join(f"X{i} : BOOL{' := TRUE' if i == 0 else ''};" for i in range(steps))
    variables += " ".join(f"T{t} : BOOL;" for t in range(len(links)))
    start = time.process_time()
    verdict = equivalent(chart(parallel=False), _program("\n".join(lines), variables), "iec", runs=0)
    return f"{verdict.outcome}: {verdict.states:,} states in {time.process_time() - start:.1f} s {verdict.reason}"


def main() -> None:
    """One contestant as JSON, or all as a table."""
    if len(sys.argv) > 1:
        print(json.dumps(measure(" ".join(sys.argv[1:]))))
        return
    for name in CONTESTANTS:
        rate = in_process(name)
        goal = (
            f"   goal {GOALS[name]:,}: {'reached' if rate >= GOALS[name] else 'NOT reached'}" if name in GOALS else ""
        )
        print(f"{name:<16} {rate:>12,.0f} scans/s{goal}")
    print(f"the ring against its step bits: {proof()}")


if __name__ == "__main__":
    main()
