"""Reads docs/protocol.md, whose examples some tests execute."""
from pathlib import Path


def block(marker):
    """The fenced block after `<!-- marker -->`."""
    text = (Path(__file__).parents[2] / "docs" / "protocol.md").read_text()
    start = text.index("```", text.index(f"<!-- {marker} -->"))
    return text[text.index("\n", start) + 1:text.index("```", start + 3)]
