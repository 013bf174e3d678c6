"""The refactoring `plant-names`: give steps the prefix of the plant."""

from __future__ import annotations

import plcopen_sfc as sfc


class PlantNames:
    """Rename steps that lack the prefix, in every chart."""

    prefix: str = "S_"

    def refactor(self, project: sfc.Project) -> None:
        """Rename all of them in one pass."""
        project.rename_many(
            {
                f"{chart.name}.{step.name}": self.prefix + step.name
                for chart in project.charts()
                for step in chart.chart.steps
                if not step.name.startswith(self.prefix)
            }
        )
