"""Error measures over a window of epochs and over an ensemble.

Errors are estimate minus truth, shape ``(runs, N, n)`` or ``(N, n)``: time is the last axis but one. A run
that failed may hold anything, also infinities: its measures are then not finite, and whoever asks for an
average over runs says which runs survived.
"""

import numpy as np


def window_rms(errors: np.ndarray, first: int, last: int, divisor: float) -> np.ndarray:
    """Root of the summed squares over the epochs `first` to `last`, both included, over `divisor`.

    Parameters
    ----------
    errors : ndarray, shape (..., N, n)
    first, last : int
        Indices of the first and the last epoch that count; ``0 <= first <= last < N``.
    divisor : float
        What the sum of squares is divided by. Papers do not always divide by the number of terms
        (``last - first + 1``), so it is stated and never guessed.

    Returns
    -------
    ndarray, shape (..., n)
        In the unit of the errors; not finite where an error is not finite.

    Raises
    ------
    ValueError
        The window leaves the record, or the divisor is not positive.
    """
    errors = np.asarray(errors, dtype=float)
    epochs = errors.shape[-2]
    if not 0 <= first <= last < epochs:
        raise ValueError(f"the window {first} to {last} leaves a record of {epochs} epochs")
    if not divisor > 0:
        raise ValueError(f"the divisor {divisor} is not positive")
    window = errors[..., first : last + 1, :]
    with np.errstate(over="ignore"):  # a run that diverged may overflow; its measure is then infinite
        return np.sqrt(np.sum(np.square(window), axis=-2) / divisor)


def ensemble_rms(errors: np.ndarray, survived: np.ndarray | None = None) -> np.ndarray:
    """Root mean square over the runs, at each epoch and channel.

    Parameters
    ----------
    errors : ndarray, shape (runs, N, n)
    survived : ndarray of bool, shape (runs,), optional
        Runs that count; all when left out.

    Returns
    -------
    ndarray, shape (N, n)

    Raises
    ------
    ValueError
        No run survives.
    """
    return np.sqrt(np.mean(np.square(surviving(errors, survived)), axis=0))


def ensemble_quantiles(errors: np.ndarray, probabilities, survived: np.ndarray | None = None) -> np.ndarray:
    """Quantiles over the runs at each epoch and channel, shape ``(len(probabilities), N, n)``.

    Parameters and errors as in `ensemble_rms`.
    """
    return np.quantile(surviving(errors, survived), probabilities, axis=0)


def surviving(values: np.ndarray, survived: np.ndarray | None) -> np.ndarray:
    """The rows of `values` (runs first) that count; raises ``ValueError`` when there is none."""
    values = np.asarray(values, dtype=float)
    kept = values if survived is None else values[np.asarray(survived, dtype=bool)]
    if not len(kept):
        raise ValueError("no run survives")
    return kept
