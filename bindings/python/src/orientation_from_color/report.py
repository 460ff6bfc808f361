"""How results show themselves: a few lines in a terminal, a table in a notebook."""

from __future__ import annotations

import html


class Report:
    """A result with lines of a label and a text."""

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        raise NotImplementedError

    def __repr__(self) -> str:
        lines = self.lines()
        width = max(len(label) for label, _ in lines)
        return "\n".join([f"<{type(self).__name__}", *(f"  {label:<{width}}  {text}" for label, text in lines)]) + ">"

    def _repr_html_(self) -> str:
        cells = (
            f"<tr><th>{html.escape(label)}</th><td style='text-align:left'>{html.escape(text)}</td></tr>"
            for label, text in self.lines()
        )
        return f"<table><caption>{type(self).__name__}</caption>{''.join(cells)}</table>"
