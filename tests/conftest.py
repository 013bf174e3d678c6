"""How the property tests run.

A property that takes long is no failure: no deadline. Where `CI` is set they draw the same examples in every run (that
is hypothesis' own rule), and what fails is reported as it was drawn: shrinking a big program takes minutes.
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, Phase, settings

settings.register_profile("here", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile(
    "ci",
    settings.get_profile("here"),
    derandomize=True,
    print_blob=True,
    phases=[Phase.explicit, Phase.generate],
)
settings.load_profile("ci" if os.environ.get("CI") else "here")
