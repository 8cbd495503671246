"""The source hash changes with the code that a result depends on, and with nothing else."""

import sys
import time
from functools import partial
from pathlib import Path

import pytest

import robins
from robins.publish.sourcehash import SourceIndex, canonical, source_hash

HUBER = '''"""Huber."""
from robins.low import square


def huber(x):
    """Weight."""
    return square(x)  # (1)
'''
KALMAN = """from robins.kalman.huber import huber
from robins.kalman.gate import gate


def local():
    return 1
"""
MINI = {
    "robins/__init__.py": '"""Top."""\nfrom robins import setup\nsetup.go()\n__version__ = "1"\n',
    "robins/setup.py": "def go():\n    pass\n",
    "robins/low.py": "def square(x):\n    return x * x\n",
    "robins/kalman/__init__.py": KALMAN,
    "robins/kalman/huber.py": HUBER,
    "robins/kalman/gate.py": "def gate(x):\n    return x < 1\n",
    "robins/papers/__init__.py": "import json\n",
    "robins/papers/one.py": "from robins.kalman import huber\nimport numpy\n",
    "robins/papers/two.py": "def late():\n    from ..kalman import gate\n    return gate\n",
    "robins/papers/three.py": "import robins.kalman.gate\nfrom robins.papers import one\n",
    "robins/papers/four.py": "from robins.kalman import local\n",
    "plugin/__init__.py": "",
    "plugin/wing.py": "from . import part\nfrom robins.kalman.huber import huber\nimport unrelated\n",
    "plugin/part.py": "VALUE = 1\n",
    "unrelated.py": "VALUE = 1\n",
}
PAPERS = ["one", "two", "three", "four"]


@pytest.fixture
def mini(tmp_path):
    """A miniature of this package and a plug-in, on disk."""
    for name, text in MINI.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def hashes(folder) -> dict[str, str]:
    index = SourceIndex([str(folder)])
    return {name: index.hash([f"robins.papers.{name}"]) for name in PAPERS} | {"plugin": index.hash(["plugin.wing"])}


def stale(folder, name: str, old: str, new: str) -> set[str]:
    """Which results an edit makes stale."""
    before = hashes(folder)
    assert old in (folder / name).read_text()
    (folder / name).write_text((folder / name).read_text().replace(old, new))
    after = hashes(folder)
    return {key for key in before if before[key] != after[key]}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# (1)", "# (2), a comment"),
        ('"""Weight."""\n', ""),
        ('"""Huber."""', '"""Another\nmodule docstring."""'),
        ("square(x)", "(square( x ))"),
        ("\n\n\n", "\n\n"),
    ],
)
def test_a_comment_a_docstring_and_the_layout_change_nothing(mini, old, new):
    assert stale(mini, "robins/kalman/huber.py", old, new) == set()


@pytest.mark.parametrize(
    ("name", "old", "new", "expected"),
    [
        ("robins/kalman/huber.py", "square(x)", "square(x) / 2", {"one", "three", "plugin", "four"}),
        ("robins/kalman/gate.py", "x < 1", "x <= 1", {"two", "three", "four"}),
        ("robins/low.py", "x * x", "x ** 2", {"one", "three", "plugin", "four"}),
        ("robins/papers/one.py", "numpy", "scipy", {"one", "three"}),
        ("plugin/part.py", "1", "2", {"plugin"}),
        ("unrelated.py", "1", "2", set()),
    ],
)
def test_a_changed_weight_makes_exactly_its_dependents_stale(mini, name, old, new, expected):
    # "four" imports what kalman/__init__ itself makes, so it depends on all that this file imports.
    assert stale(mini, name, old, new) == expected


def test_what_a_package_binds_concerns_only_those_who_import_it_from_there(mini):
    assert stale(mini, "robins/kalman/__init__.py", "return 1", "return 2") == {"four"}
    assert stale(mini, "robins/__init__.py", '"1"', '"2"') == set()
    assert stale(mini, "robins/setup.py", "pass", "return") == set()


def test_what_a_package_does_concerns_everyone_below_it(mini):
    assert stale(mini, "robins/papers/__init__.py", "import json\n", "import json\njson.seed(1)\n") == set(PAPERS)
    assert stale(mini, "robins/__init__.py", "setup.go()", "setup.go(1)") == {*PAPERS, "plugin"}


def test_a_name_passed_on_from_another_module_makes_its_importers_stale(mini):
    assert stale(mini, "robins/kalman/__init__.py", "from robins.kalman.huber import huber", "from robins.kalman.gate import huber") == {
        "one",
        "three",
        "four",
    }


def test_a_submodule_that_its_package_imports_is_still_followed(mini):
    (mini / "robins/papers/__init__.py").write_text("from robins.papers import one\n")
    assert stale(mini, "robins/papers/one.py", "numpy", "scipy") == {"one", "three"}


def test_what_the_caller_adds_changes_the_hash(mini):
    index = SourceIndex([str(mini)])
    assert index.hash(["robins.low"], {"window": 20}) != index.hash(["robins.low"], {"window": 21})
    assert index.hash(["robins.low"], {"a": 1, "b": 2}) == index.hash(["robins.low"], {"b": 2, "a": 1})


def test_a_module_that_does_not_exist_is_an_error(mini):
    with pytest.raises(ModuleNotFoundError, match="robins.nothing"):
        SourceIndex([str(mini)]).hash(["robins.nothing"])


def test_what_has_no_canonical_form_is_refused():
    with pytest.raises(TypeError, match="cannot be part of a source hash"):
        canonical({"x": object()})


def test_in_this_very_package_a_changed_update_reaches_its_importers_and_nobody_else():
    package = Path(robins.__file__).parent
    search = [str(package.parent)]

    def edited(path: Path) -> bytes:
        text = path.read_bytes()
        return text + b"\nEDITED = True\n" if path == package / "kalman" / "update.py" else text

    def commented(path: Path) -> bytes:
        return b"# a comment\n" + path.read_bytes()

    modules = ["robins.kalman.update", "robins.foundation.randomness", "robins.publish.check"]
    plain, changed, same = (SourceIndex(search, read) for read in (Path.read_bytes, edited, commented))
    for module in modules:
        assert (plain.hash([module]) != changed.hash([module])) == (module == "robins.kalman.update")
        assert plain.hash([module]) == same.hash([module])
        assert source_hash([module]) == plain.hash([module])


def test_hashing_the_whole_package_takes_a_moment():
    package = Path(robins.__file__).parent
    modules = [".".join(file.relative_to(package.parent).with_suffix("").parts) for file in package.rglob("*.py")]
    modules = [module.removesuffix(".__init__") for module in modules]
    index = SourceIndex([str(package.parent)])
    began = time.perf_counter()
    index.hash([module for module in modules if index.file(module)])
    assert time.perf_counter() - began < 3.0  # 0.3 s is the aim; a loaded machine may take longer


def test_the_arguments_of_a_partial_function_count():
    hashes = {source_hash((), {"made_by": partial(print, branch)}) for branch in ("deg", "rad")}
    assert len(hashes) == 2


def test_a_module_that_reads_package_data_depends_on_it():
    """The substitute aircraft is a YAML file beside the scenario."""

    def altered(path):
        content = path.read_bytes()
        return content.replace(b"-1.6384e-1", b"-3.2768e-1") if path.name == "f4c.yaml" else content

    modules = ["robins.papers.hajiyev2023.scenario"]
    assert SourceIndex(sys.path, altered).hash(modules) != SourceIndex(sys.path).hash(modules)
