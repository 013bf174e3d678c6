"""Structured text: parsing, printing and editing.

`parse_statements` and `parse_expression` give a text its tree, `render` gives the text of a tree that was edited,
`print_node` that of one which was made; `layout` has the edits that lay a text out.

`lexer` has the tokens, `parsing` runs the grammars ``st.lark`` and ``declarations.lark``, whose rules `tree_building`
makes `nodes` and `declaration_nodes` of. `walking` goes through trees, `printing` gives their text, `literals` values.
"""

from plcopen_sfc.languages.st.parsing import (
    Parsed as Parsed,
    bare_condition as bare_condition,
    parse_body as parse_body,
    parse_condition as parse_condition,
    parse_declarations as parse_declarations,
    parse_expression as parse_expression,
    parse_statements as parse_statements,
)
from plcopen_sfc.languages.st.printing import print_node as print_node, render as render
from plcopen_sfc.languages.st.walking import (
    children as children,
    names_of as names_of,
    transform as transform,
    walk as walk,
    without_parentheses as without_parentheses,
)
