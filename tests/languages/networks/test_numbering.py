"""Networks of one body in which ids start again, as TIA Portal writes them."""

from __future__ import annotations

from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.model import LogicNetwork
from tests.languages.networks.build import coil, contact, lines, rail, told


def rung(result: str, condition: str, source: int = 22) -> LogicNetwork:
    return LogicNetwork(nodes=[rail(21), contact(22, condition, 21), coil(23, result, source)])


def test_each_network_has_ids_of_its_own() -> None:
    networks = [rung("x", "a"), rung("y", "b")]
    before = [network.model_copy(deep=True) for network in networks]
    result = network_statements(networks)
    assert lines(result) == ["x := a;", "y := b;"]
    assert told(result) == []
    assert networks == before


def test_problems_name_the_elements_as_their_network_does() -> None:
    result = network_statements([rung("x", "a"), rung("y", "b", source=99)])
    assert [(problem.node, problem.message) for problem in result.problems if "99" in problem.message] == [
        (23, "a wire starts at element 99, which is not there")
    ]
    assert all(problem.node in (None, 21, 22, 23) for problem in result.problems)
