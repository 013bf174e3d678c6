"""Pages: projects and what came of them as HTML files that stand alone.

* `project_page`: a project with its charts, declarations, program text, cross references and findings
* `comparison_page`: the differences of two projects, and what a conversion did, with charts beside each other
* `conversion_overview`: verdicts, what a person has to do, tools and digests of files
* `conversion_items`: the items of a report as lists
* `step_cells`: steps with their actions and transitions in tables, of one chart or of two side by side
* `page_index`: anchors of objects, links in program text, places that use an object
* `timing_diagram`: a trace as a picture, and in the page of its project, to play on the chart
* `html_text`: elements and documents; `page.css` and `page.js` for the browser
* `page_words`: English and German, messages too; `verdict_words`: those of comparisons, which are composed; `phrases`
  recognises them by the tables in ``german/``
"""

from plcopen_sfc.pages.comparison_page import conversion_page, diff_page
from plcopen_sfc.pages.project_page import page

__all__ = ["conversion_page", "diff_page", "page"]
