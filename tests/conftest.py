"""How the tests run: in which order, and how many examples of properties.

A property that takes long is no failure: no deadline. Where `CI` is set they draw the same examples in every run (that
is hypothesis' own rule), and what fails is reported as it was drawn: shrinking a big program takes minutes.
"""

from __future__ import annotations

import gc
import os
from pathlib import Path
from typing import Any
from zlib import crc32

import pytest
from hypothesis import HealthCheck, Phase, settings

from tests.sweeps import WHOLE, examples

settings.register_profile(
    "here", max_examples=examples(100), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile(
    "ci",
    settings.get_profile("here"),
    derandomize=True,
    print_blob=True,
    phases=[Phase.explicit, Phase.generate],
)
settings.load_profile("ci" if os.environ.get("CI") else "here")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Neighbours run in the same process: what they load or compile once, is made once."""
    from xdist.scheduler import WorkStealingScheduling  # noqa: PLC0415  # not without xdist

    return WorkStealingScheduling(config, log)


def pytest_collection() -> None:
    """Let the garbage collector rest while tests are collected: nothing of that is garbage."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Let the garbage collector run less often: a fifth of the time of all tests is its looking through what lives on.

    What is imported and collected is never garbage; 20 000 new objects are fewer than a project of the corpus has.
    """
    gc.collect()
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out seven of eight slow tests, unless these are asked for (``-m slow``, or by ``::``) or all is to be run.

    Which eighth is run is the same for the same files, and another one after most changes of the package.
    What installs a whole environment comes first: at the end the other processes would wait for it.
    """
    asked_for = "slow" in config.option.markexpr or any("::" in argument for argument in config.args)
    if not WHOLE and not asked_for:
        # sizes of modules: another sum after most changes
        turn = sum(path.stat().st_size for path in (Path(__file__).parents[1] / "plcopen_sfc").rglob("*.py"))
        left_out = {
            item
            for item in items
            if item.get_closest_marker("slow") is not None
            and not item.nodeid.startswith(_EACH_ITS_OWN)
            and (crc32(item.nodeid.encode()) + turn) % _SHARES
        }
        config.hook.pytest_deselected(items=[*left_out])
        items[:] = [item for item in items if item not in left_out]
    items.sort(key=lambda item: item.path.name != "test_wheel.py")


_EACH_ITS_OWN = ("tests/test_docs.py::test_examples_of_a_page_run", "tests/fuzz/")
"""Pages, and formats: another one does not stand for them."""
_SHARES = 8
