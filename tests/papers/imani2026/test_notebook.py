"""The notebook's derivations lead to tests that exist, one at least for each proposition."""

import json
import re

import pytest

from robins.publish.equations import test_exists as exists


@pytest.fixture(scope="module")
def prose(repository) -> str:
    cells = json.loads((repository / "workflow" / "notebooks" / "imani2026.ipynb").read_text(encoding="utf-8"))["cells"]
    return "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")


@pytest.mark.parametrize("number", range(1, 11))
def test_a_proposition_names_a_test_that_exists(prose, repository, number):
    paragraph = next(part for part in prose.split("\n\n") if part.startswith(f"**Proposition {number} "))
    named = re.findall(r"`(tests/[\w/.]+::\w+)`", paragraph)
    assert named
    assert [name for name in named if not exists(name, repository)] == []
