"""The measurement noise that a set of weights leaves: ``R^1/2 diag(1/w) R^T/2 + R_fixed``, in place and without allocation.

``R^1/2`` is the lower Cholesky factor. The other symmetric form, ``S^1/2 R S^1/2`` with ``S = diag(1/w)``, is equal to
this one for diagonal R only: with correlated channels a weight here changes the variances of later channels too.
"""

from robins.foundation.smallmat import assign, cholesky, kernel


@kernel
def kept_noise(R, weights, out):
    """Copy `R`, with rows and columns of the unit matrix for channels of weight zero, and tell whether that is diagonal."""
    assign(R, out)
    for i in range(weights.size):
        if weights[i] == 0.0:
            for j in range(weights.size):
                out[i, j] = out[j, i] = 0.0
            out[i, i] = 1.0
    diagonal = True
    for i in range(weights.size):
        for j in range(i):
            if out[i, j] != 0.0 or out[j, i] != 0.0:
                diagonal = False
    return diagonal


@kernel
def divide_diagonal(out, weights):
    """``out = out diag(1/w)`` for a diagonal matrix, without the channels of weight zero."""
    for i in range(weights.size):
        if weights[i] > 0.0 and weights[i] != 1.0:
            out[i, i] /= weights[i]


@kernel
def divide_between_roots(out, weights):
    """``L diag(1/w) L^T`` for the lower triangular L in `out`, in place from the last row on, without the channels of weight zero."""
    for i in range(weights.size - 1, -1, -1):
        for j in range(i, -1, -1):
            total = 0.0
            for k in range(j + 1):
                total += out[i, k] * out[j, k] / (weights[k] if weights[k] > 0.0 else 1.0)
            out[i, j] = out[j, i] = total


@kernel
def add_kept(R_fixed, weights, out):
    """``out += R_fixed`` between channels whose weights are not zero."""
    for i in range(weights.size):
        for j in range(weights.size):
            if R_fixed[i, j] != 0.0 and weights[i] > 0.0 and weights[j] > 0.0:
                out[i, j] += R_fixed[i, j]


@kernel
def divide_by_weights(weights, diagonal, out):
    """``out = root diag(1/w) root^T`` of `out` itself; False when it has no root."""
    definite = True
    if diagonal:
        divide_diagonal(out, weights)
    else:
        definite = cholesky(out, out)
        divide_between_roots(out, weights)
    return definite


@kernel
def weighted_noise(R, R_fixed, weights, out):
    """``out = R^1/2 diag(1/w) R^T/2 + R_fixed`` with the lower Cholesky factor as root; all ``(m, m)``.

    A channel of weight zero is left out: its row and column are those of the unit matrix. Returns False when the rest
    of `R` is neither diagonal nor positive definite.
    """
    diagonal = kept_noise(R, weights, out)
    definite = divide_by_weights(weights, diagonal, out)
    add_kept(R_fixed, weights, out)
    return definite
