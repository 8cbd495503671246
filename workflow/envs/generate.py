"""Write `robins.yaml`, the environment file that `snakemake --lint` asks every rule to name, from `requirements.lock`.

The file is inert: Snakemake reads it only under ``--software-deployment-method conda``, which this
workflow does not need. Run ``python workflow/envs/generate.py`` after the lock has changed; a test
compares the two.
"""

from pathlib import Path

HERE = Path(__file__).resolve().parent
LOCK = HERE.parents[1] / "requirements.lock"
ENVIRONMENT = HERE / "robins.yaml"

HEADER = """\
# Generated from requirements.lock by workflow/envs/generate.py; not edited by hand.
channels:
  - conda-forge
  - nodefaults
dependencies:
  - python=3.11
  - pip
  - pip:
"""


def requirements(lock: str) -> list[str]:
    """The pinned requirements ``name==version`` of a lock's text, with their markers and without hashes and comments."""
    return [line.removesuffix("\\").strip() for line in lock.splitlines() if line and line[0] not in " #-"]


def environment(lock: str) -> str:
    """The environment file that belongs to a lock's text."""
    return HEADER + "".join(f'      - "{requirement}"\n' for requirement in requirements(lock))


if __name__ == "__main__":
    ENVIRONMENT.write_text(environment(LOCK.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
