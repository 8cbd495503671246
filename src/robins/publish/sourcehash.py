"""One number for the code that a result depends on.

The hash covers the modules named by a job and everything they import inside this package (or inside the plug-in
package that a named module belongs to), each as a syntax tree without docstrings and comments, and whatever else
the caller hands in (a job's definition, its section of the configuration). So a comment changes nothing, and a
changed weight makes exactly those results stale that use it.

What counts as an import
------------------------
``import a.b``, ``from a import b`` and their relative forms, anywhere in a file (a late import is still a dependency).
``from package import name`` follows ``name`` alone when the package's ``__init__`` merely passes it on from another
module; when the name is made in the ``__init__`` itself, the whole file and its imports count.

Importing ``a.b.c`` also runs ``a/__init__`` and ``a/b/__init__``. What those files *bind* (imports, functions, classes,
names) is seen only by modules that import it from there, and those name it; what they *do* (bare statements such as
``numpy.seterr(...)``) acts on everyone below. Hence only the latter counts for a package that is merely passed through:
a paper whose ``__init__`` registers one more claim does not make its simulations stale.

A module that imports `importlib.resources` depends on the data files of its package as well.
"""

import ast
import hashlib
import json
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field, is_dataclass
from enum import Enum
from functools import cache, partial
from importlib.machinery import PathFinder
from pathlib import Path

import numpy as np

_BINDING = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_ALWAYS = "robins"


@dataclass(frozen=True)
class Source:
    """What is known about one module's file.

    ``imports`` are pairs (module, name): name is "" for ``import module``, "*" for a star import. ``passed_on`` maps
    a name bound by an import at the top of the file to the import that binds it.
    """

    digest: str
    acts: str
    imports: tuple[tuple[str, str], ...]
    passed_on: Mapping[str, tuple[str, str]] = field(default_factory=dict)


class SourceIndex:
    """The modules of this package and its plug-ins, each parsed at most once.

    Parameters
    ----------
    search_path : list of str, optional
        Where top-level packages are looked for (default: ``sys.path``).
    read : callable, optional
        ``read(path) -> bytes``; tests hand in altered sources.
    """

    def __init__(self, search_path: list[str] | None = None, read: Callable[[Path], bytes] = Path.read_bytes):
        self._search_path, self._read = search_path, read
        self._files: dict[str, Path | None] = {}
        self._sources: dict[str, Source] = {}

    def file(self, module: str) -> Path | None:
        """The file of `module`, or None when there is no such Python source."""
        if module not in self._files:
            self._files[module] = self._locate(module)
        return self._files[module]

    def _locate(self, module: str) -> Path | None:
        parent, _, name = module.rpartition(".")
        if not parent:
            spec = PathFinder.find_spec(name, self._search_path)
            return Path(spec.origin) if spec and spec.origin and spec.origin.endswith(".py") else None
        package = self.file(parent)
        if package is None or package.name != "__init__.py":
            return None
        for candidate in (package.parent / name / "__init__.py", package.parent / f"{name}.py"):
            if candidate.is_file():
                return candidate
        return None

    def source(self, module: str) -> Source:
        """The facts about `module`'s file (it must exist)."""
        if module not in self._sources:
            path = self.file(module)
            self._sources[module] = _examine(ast.parse(self._read(path)), module, path.name == "__init__.py")
        return self._sources[module]

    def closure(self, modules: Iterable[str]) -> dict[str, str]:
        """Digest of every module that `modules` depend on, themselves included, by name.

        Packages that are merely passed through appear under ``name/`` with the digest of what they do.

        Raises
        ------
        ModuleNotFoundError
            A named module has no Python source.
        """
        named = list(modules)
        for module in named:
            if self.file(module) is None:
                raise ModuleNotFoundError(f"no Python source for the module {module!r}", name=module)
        inside = {_ALWAYS, *(module.partition(".")[0] for module in named)}
        found: dict[str, str] = {}
        queue, seen = [(module, "") for module in named], set()
        while queue:
            wanted = queue.pop()
            if wanted in seen:
                continue
            seen.add(wanted)
            module, name = wanted
            if module.partition(".")[0] in inside:
                queue.extend(self._visit(module, name, found))
        return dict(sorted(found.items()))

    def _visit(self, module: str, name: str, found: dict[str, str]) -> list[tuple[str, str]]:
        """Enter what ``from module import name`` depends on into `found`; return the imports to follow."""
        onward = self._passed_on(module, name)
        if onward is None and name and name != "*" and self.file(f"{module}.{name}"):
            module = f"{module}.{name}"
        while module and self.file(module) is None:  # `import a.b.c` where c is no module: an attribute of the nearest module
            module = module.rpartition(".")[0]
        if not module:
            return []
        parts = module.split(".")
        for depth in range(1, len(parts) + (onward is not None)):
            package = ".".join(parts[:depth])
            found[f"{package}/"] = self.source(package).acts
        if onward is not None:
            return [onward]
        source = self.source(module)
        found[module] = source.digest
        if ("importlib", "resources") in source.imports:
            found[f"{module} data"] = self._data(module)
        return list(source.imports)

    def _data(self, module: str) -> str:
        """Digest of the files beside and below `module` that are not Python: what it may read as package data."""
        folder = self.file(module).parent
        files = sorted(file for file in folder.rglob("*") if file.is_file() and file.suffix not in (".py", ".pyc"))
        content = {file.relative_to(folder).as_posix(): hashlib.sha256(self._read(file)).hexdigest() for file in files}
        return hashlib.sha256(canonical(content).encode()).hexdigest()

    def _passed_on(self, package: str, name: str) -> tuple[str, str] | None:
        """The import by which `package` merely passes `name` on, or None (also where `name` is a module of its own)."""
        path = self.file(package)
        if path is None or path.name != "__init__.py":
            return None
        onward = self.source(package).passed_on.get(name)
        return None if onward == (package, name) else onward

    def hash(self, modules: Iterable[str], extra: Mapping | None = None) -> str:
        """SHA-256 (hex) of the closure of `modules` and of `extra`."""
        facts = {"modules": self.closure(modules), "extra": extra or {}}
        return hashlib.sha256(canonical(facts).encode()).hexdigest()


@cache
def installed() -> SourceIndex:
    """The index of this process's installed sources."""
    return SourceIndex(sys.path)


def source_hash(modules: Iterable[str], extra: Mapping | None = None) -> str:
    """The hash that says whether a result is stale: the code it depends on, and `extra`.

    Parameters
    ----------
    modules : iterable of str
        Names of modules; their imports inside this package (and inside their own) are followed.
    extra : mapping, optional
        Whatever else decides the result: definition, section of the configuration, digests of input files.
    """
    return installed().hash(modules, extra)


def canonical(value) -> str:
    """`value` as JSON in one form only: sorted keys, no blanks; arrays as lists, enumerations and callables by name."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), default=_plain)


def _plain(value):
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if is_dataclass(value):
        return asdict(value)
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, partial):
        return {"function": value.func, "arguments": value.args, "keywords": value.keywords}
    if hasattr(value, "__qualname__"):
        return f"{value.__module__}.{value.__qualname__}"
    raise TypeError(f"{value!r} ({type(value).__name__}) cannot be part of a source hash")


def _examine(tree: ast.Module, module: str, is_package: bool) -> Source:
    imports, passed_on = [], {}
    for node in ast.walk(tree):
        imports.extend(wanted for _, wanted in _imported(node, module, is_package))
    for node in tree.body:
        passed_on.update(_imported(node, module, is_package))
    _strip_docstrings(tree)
    acts = ast.Module(body=[node for node in tree.body if not _only_binds(node)], type_ignores=[])
    return Source(_digest(tree), _digest(acts), tuple(dict.fromkeys(imports)), passed_on)


def _imported(node: ast.AST, module: str, is_package: bool) -> list[tuple[str, tuple[str, str]]]:
    """Pairs (bound name, (module, name)) of an import statement; nothing for any other node."""
    if isinstance(node, ast.Import):
        return [(alias.asname or alias.name.partition(".")[0], (alias.name, "")) for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        origin = node.module or ""
        if node.level:
            parts = module.split(".")
            parts = parts[: len(parts) - node.level + is_package]
            origin = ".".join([*parts, origin] if origin else parts)
        return [(alias.asname or alias.name, (origin, alias.name)) for alias in node.names]
    return []


def _only_binds(node: ast.stmt) -> bool:
    if isinstance(node, ast.Assign):
        return all(isinstance(target, ast.Name | ast.Tuple | ast.List) for target in node.targets)
    return isinstance(node, _BINDING) or (isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name))


def _strip_docstrings(tree: ast.Module) -> None:
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) and node.body:
            first = node.body[0]
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
                del node.body[0]


def _digest(tree: ast.AST) -> str:
    pieces: list[str] = []
    _spell(tree, pieces.append)
    return hashlib.sha256("".join(pieces).encode()).hexdigest()


def _spell(node, put: Callable[[str], None], joined: bool = False) -> None:
    """Spell a syntax tree out.

    Unlike `ast.dump` it skips empty fields and the empty pieces of f-strings, so that what a later Python adds to its
    trees (``type_params``, for one) does not change the hash.
    """
    if isinstance(node, ast.AST):
        put(f"({node.__class__.__name__}")
        for name in node._fields:
            value = getattr(node, name, None)
            if value is None and node.__class__ is ast.Constant and name == "value":
                put(" None")
            elif value is not None and value != [] and name != "kind" and not isinstance(value, ast.expr_context):
                put(f" {name}=")
                _spell(value, put, node.__class__ is ast.JoinedStr)
        put(")")
    elif isinstance(node, list):
        put("[")
        for item in node:
            if not (isinstance(item, ast.Constant) and item.value == "" and joined):
                _spell(item, put)
                put(",")
        put("]")
    else:
        put(repr(node))
