"""The configuration: read, checked at the door and handed to each paper.

A configuration is made of layers: config/config.yaml, then files and values given on the command line.
Each layer is checked by itself, so that a message names the place where the mistake stands.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

import yaml

from robins.foundation.errors import InputError
from robins.papers import all_papers
from robins.papers.protocol import Paper, Settings
from robins.publish.sourcehash import canonical

COMMAND_LINE = "--config"
"""The name of the layer that comes from ``snakemake --config key=value``."""


@dataclass(frozen=True)
class Configuration:
    """A checked configuration.

    Attributes
    ----------
    ensemble, seed : str, int
        See `robins.papers.protocol.Settings`.
    papers : tuple of str
        Keys of the chosen papers, in the registry's order.
    recordings : Path or None
        The folder of real recordings.
    sizes, options : mapping
        By paper key (and ensemble), as far as the configuration says anything.
    """

    ensemble: str
    seed: int
    papers: tuple[str, ...]
    recordings: Path | None = None
    sizes: Mapping = field(default_factory=dict)
    options: Mapping = field(default_factory=dict)

    @property
    def values(self) -> dict:
        """The configuration as plain values; `from_values` makes it again."""
        recordings = None if self.recordings is None else str(self.recordings)
        return {**asdict(self), "papers": list(self.papers), "recordings": recordings}


def load(path, overrides: Mapping | None = None, extra_files: Iterable = ()) -> Configuration:
    """Read and check the configuration.

    Parameters
    ----------
    path : path
        ``<repository>/config/config.yaml``; the schema and relative folders are found from there.
    overrides : mapping, optional
        Values given on the command line; they win.
    extra_files : paths, optional
        Configuration files given on the command line, each wins over the ones before.

    Raises
    ------
    InputError
        Naming the layer, the key, what was found and what was expected.
    """
    path = Path(path).absolute()
    root = path.parent.parent
    for key, paper in all_papers().items():
        for name in paper.first_runs:
            require_known(f"robins.papers.{key}", "first_runs", name, {name for sizes in paper.sizes.values() for name in sizes})
        check_runs(f"robins.papers.{key}", paper, paper.sizes)
    main = read_yaml(path)
    check_layer(path, main, root, complete=True)
    values = main
    for extra in extra_files:
        layer = read_yaml(extra)
        check_layer(extra, layer, root)
        values = merged(values, layer)
    if overrides:
        layer = spoken(overrides)
        check_layer(COMMAND_LINE, layer, root)
        values = merged(values, layer)
    return from_values(values, root)


def from_values(values: Mapping, root: Path) -> Configuration:
    """The configuration that merged and checked `values` stand for; a relative folder is relative to `root`."""
    known = all_papers()
    chosen = known if values["papers"] == "all" else values["papers"]
    recordings = values.get("recordings")
    return Configuration(
        ensemble=values["ensemble"],
        seed=values["seed"],
        papers=tuple(key for key in known if key in chosen),
        recordings=None if recordings is None else root / Path(recordings).expanduser(),
        sizes=values.get("sizes", {}),
        options=values.get("options", {}),
    )


def spoken(value):
    """A value of the command line with the numbers, truth values and nulls that Snakemake leaves as text inside mappings."""
    if isinstance(value, Mapping):
        return {key: spoken(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [spoken(inner) for inner in value]
    if isinstance(value, str):
        try:
            read = yaml.safe_load(value)
        except yaml.YAMLError:
            return value
        return read if read is None or isinstance(read, int | float) else value
    return value


def settings_for(paper: Paper, configuration: Configuration) -> Settings:
    """What the configuration says to `paper`; where it says nothing, what the wing says."""
    ensemble = configuration.ensemble
    sizes = {**paper.sizes.get(ensemble, {}), **configuration.sizes.get(paper.key, {}).get(ensemble, {})}
    options = {**paper.options, **configuration.options.get(paper.key, {})}
    return Settings(ensemble, configuration.seed, sizes, options)


def digest(settings: Settings) -> str:
    """The sha256 of what the configuration says to one paper."""
    return hashlib.sha256(canonical(asdict(settings)).encode()).hexdigest()


def read_yaml(path) -> dict:
    """The mapping in a YAML file; an empty file is an empty mapping."""
    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(path, "", "no file", "a configuration file") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(path, "", " ".join(str(error).split()), "YAML") from None
    return {} if values is None else values


def merged(below: Mapping, above: Mapping) -> dict:
    """`below` with the values of `above`, mappings merged key by key (as Snakemake does)."""
    result = dict(below)
    for key, value in above.items():
        both = isinstance(value, Mapping) and isinstance(result.get(key), Mapping)
        result[key] = merged(result[key], value) if both else value
    return result


@cache
def schema(path: Path, complete: bool):
    """The validator of a whole configuration, or of a layer that may leave keys out.

    It is JSON Schema 2020-12, except that 8.0 is not a whole number.
    """
    from jsonschema import Draft202012Validator, validators  # takes a second, and only the Snakefile needs it, not its jobs

    types = Draft202012Validator.TYPE_CHECKER.redefine("integer", lambda _, value: isinstance(value, int) and not isinstance(value, bool))
    content = json.loads(path.read_text(encoding="utf-8"))
    return validators.extend(Draft202012Validator, type_checker=types)(content if complete else {**content, "required": []})


def check_layer(source, values, root: Path, complete: bool = False) -> None:
    """Raise an `InputError` for the first mistake in one layer: form first, then names of papers, sizes and options."""
    validator = schema(root / "workflow" / "schemas" / "config.schema.json", complete)
    for error in sorted(validator.iter_errors(values), key=lambda error: [str(key) for key in error.path]):
        raise input_error(source, error)
    check_names(source, values)


def input_error(source, error) -> InputError:
    """One line for a schema violation: the schema's ``description`` says what was expected."""
    place = ".".join(str(key) for key in error.path)
    if error.validator == "required":
        missing = next(key for key in error.validator_value if key not in error.instance)
        return InputError(source, missing, "nothing", error.schema["properties"][missing]["description"])
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        unknown = next(key for key in error.instance if key not in known)
        return InputError(source, f"{place}.{unknown}".lstrip("."), "an unknown key", f"one of {', '.join(known)}")
    return InputError(source, place, repr(error.instance), error.schema.get("description", error.message))


def check_names(source, values: Mapping) -> None:
    """Raise an `InputError` where a layer names a paper, size or option that no wing offers, or a size that no wing can have."""
    known = all_papers()
    papers = values.get("papers", "all")
    for key in [] if papers == "all" else papers:
        require_known(source, "papers", key, known)
    for key, by_ensemble in values.get("sizes", {}).items():
        require_known(source, "sizes", key, known)
        offered = {name for sizes in known[key].sizes.values() for name in sizes}
        for ensemble, sizes in by_ensemble.items():
            for name in sizes:
                require_known(source, f"sizes.{key}.{ensemble}", name, offered)
        check_runs(source, known[key], by_ensemble)
    for key, options in values.get("options", {}).items():
        require_known(source, "options", key, known)
        for name, value in options.items():
            require_known(source, f"options.{key}", name, known[key].options)
            default = known[key].options[name]
            if default is not None and type(value) is not type(default):
                raise InputError(source, f"options.{key}.{name}", repr(value), f"a value like {default!r}")


def check_runs(source, paper: Paper, by_ensemble: Mapping[str, Mapping[str, int]]) -> None:
    """Raise an `InputError` where runs of one size reach into those of a size that begins later: nothing is reported from tuning runs."""
    for ensemble, sizes in by_ensemble.items():
        for name, size in sizes.items():
            first = paper.first_runs.get(name, 0)
            later = {begin: other for other, begin in paper.first_runs.items() if begin > first}
            if later and (name.endswith("runs") or first) and first + size > min(later):
                expected = f"at most {min(later) - first}: {later[min(later)]} are the runs from {min(later)} on"
                raise InputError(source, f"sizes.{paper.key}.{ensemble}.{name}", size, expected)


def require_known(source, place: str, name, known: Iterable) -> None:
    """Raise an `InputError` unless `name` is one of `known`."""
    if name not in known:
        raise InputError(source, place, repr(name), f"one of {', '.join(sorted(known)) or 'nothing'}")
