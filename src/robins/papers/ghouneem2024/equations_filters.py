"""Equations (14)-(31): sigma points, prediction, integrity gate and correction, as printed and as they are used here.

Names such as E1, A1 and Prop1 are those of `register`. In corrected forms $L$ is the lower Cholesky factor, $\\chi_i$ are
points before the step, $X_i$ after it, and $X_i'$ those that are drawn again for the correction.
"""

from robins.papers.protocol import Equation

_PREDICT = "tests/kalman/test_predict.py"
_AS_PRINTED = "tests/papers/ghouneem2024/test_as_printed.py"

_POINTS = f"{_PREDICT}::test_sigma_points_have_the_mean_and_the_covariance_that_they_are_drawn_from"
_SCALING = f"{_PREDICT}::test_the_weights_are_those_of_the_equations"
_REDRAWN = f"{_AS_PRINTED}::test_with_points_drawn_again_the_update_is_the_kalman_filters"

_SIGMA_POINTS = (
    Equation(
        "14",
        "Central sigma point",
        r"X_{0,k+1}=X_k,\quad \text{for }i=0",
        "ambiguous",
        r"The index on the left is that of the propagated points of (22); these are the points at $k$.",
        _POINTS,
        corrected=r"\chi_{0,k}=\hat X_k",
    ),
    Equation(
        "15",
        "Sigma points above",
        r"X_{i,k+1}=X_k+(\gamma\sqrt{P_{xx}})_i,\quad \text{for }i=1,\dots,n",
        "ambiguous",
        r"Said to be the $i$-th row of the Cholesky factor, which is right for $P=U^TU$ only; rows of a lower factor give other points "
        "with another covariance (E13).",
        f"{_PREDICT}::test_rows_of_the_lower_factor_are_sigma_points_of_another_covariance",
        corrected=r"\chi_{i,k}=\hat X_k+\gamma\,Le_i,\quad LL^T=P",
    ),
    Equation(
        "16",
        "Sigma points below",
        r"X_{i,k+1}=X_k-(\gamma\sqrt{P_{xx}})_i,\quad \text{for }i=n+1,\dots,2n",
        "wrong",
        r"The factor has $n$ rows and columns; the index must be $i-n$ (E13).",
        _POINTS,
        corrected=r"\chi_{i,k}=\hat X_k-\gamma\,Le_{i-n}",
    ),
    Equation(
        "17",
        "Weight of the centre in the mean",
        r"W_0^m=\frac{\lambda}{n+\lambda}",
        "ok",
        r"With $n=9$ and $\kappa=0$ it is -99 for $\alpha=0.1$ and 0 for $\alpha=1$.",
        _SCALING,
    ),
    Equation(
        "18",
        "Weight of the centre in the covariance",
        r"W_0^c=\frac{\lambda}{n+\lambda}(1-\alpha^2+\beta)",
        "wrong",
        r"A product where a sum belongs (E14): for $\alpha=0.1$ it is -296.0 instead of -96.0, for $\alpha=1$ it is 0 instead of 2. On a "
        "linear problem both agree (Prop5); otherwise the product takes away covariance, which can lose its definiteness.",
        f"{_PREDICT}::test_mean_and_variance_of_a_square_are_exact_with_beta_two_and_not_with_the_printed_weight",
        corrected=r"W_0^c=\frac{\lambda}{n+\lambda}+1-\alpha^2+\beta",
    ),
    Equation("19", "Weights of the other points", r"W_i^m=W_i^c=\frac{1}{2(n+\lambda)}", "ok", "", _SCALING),
    Equation(
        "20",
        "Scaling",
        r"\lambda=\alpha^2(n+k)-n",
        "ok",
        r"$k$ is $\kappa$ here. Ranges are printed, the values used are not (A5).",
        _SCALING,
        corrected=r"\lambda=\alpha^2(n+\kappa)-n",
    ),
    Equation("21", "Spread", r"\gamma=\sqrt{n+\lambda}", "ok", r"$\gamma$ is also the inverse time of (5).", _SCALING),
)

_PREDICTION = (
    Equation(
        "22",
        "Predicted mean",
        r"\hat X_{k+1}=\sum_{i=0}^{2n}W_i^mX_{i,k+1}",
        "ok",
        r"Summed as differences from $X_0$, since weights of opposite sign and size $1/\alpha^2$ cancel.",
        f"{_PREDICT}::test_the_unscented_filter_is_filterpys",
        corrected=r"\hat X_{k+1}=X_0+\sum_{i=1}^{2n}W_i^m(X_i-X_0)",
    ),
    Equation(
        "23",
        "Predicted covariance",
        r"P_{xx,k+1}=Q+\sum_{i=0}^{2n}W_i^c[X_{i,k+1}-\hat X_{k+1}][X_{i,k+1}-\hat X_{k+1}]^T",
        "ok",
        "(1) makes velocity a function of azimuth and odometer error, so the sum alone is singular (Prop4); a floor on the velocity's "
        "noise keeps it definite (A11).",
        f"{_PREDICT}::test_every_prediction_of_a_linear_model_is_the_kalman_filters",
    ),
)

_GATE = (
    Equation(
        "24",
        "GPS integrity",
        r"|RISS_{predicted,k+1}-GPS_{measurements,k+1}|>TH_{RISS}\quad\text{or}\quad "
        r"|GPS_{measurements,k+1}-GPS_{measurements,k}|>TH_{GPS}",
        "ambiguous",
        "Norm, units and thresholds are not given, nor whether fix $k$ is the last received or the last accepted (A6, A7). Read by "
        "component with the last received fix; one jump then costs two fixes (Prop7). Nothing lets the filter in again after it has "
        "drifted (A8).",
        "tests/kalman/test_gates.py::test_one_false_fix_is_rejected_and_the_good_one_after_it_too",
        corrected=r"\exists i:\ |\hat z_{k+1,i}-z_{k+1,i}|>m\,\theta_i\quad\text{or}\quad |z_{k+1,i}-z_{last,i}|>m\,\tau_i",
    ),
)

_CORRECTION = (
    Equation(
        "25",
        "Observed sigma points",
        r"Y_{i,k+1}=h(X_{i,k+1})",
        "wrong",
        "The propagated points are used again. They do not hold the noise that (23) has added, so that even on a linear model the filter "
        "is no Kalman filter (E15). Points are drawn again from the predicted covariance; the printed way is run as an ablation.",
        f"{_AS_PRINTED}::test_points_that_are_not_drawn_again_are_no_kalman_filter",
        corrected=r"X_i'=\hat X^-\pm\gamma\,Le_i,\quad LL^T=P_{xx},\quad Y_i=h(X_i')",
    ),
    Equation("26", "Predicted measurement", r"\hat Y_{k+1}=\sum_{i=0}^{2n}W_i^mY_{i,k+1}", "ok", r"$h$ selects six states.", _REDRAWN),
    Equation(
        "27",
        "Innovation covariance",
        r"P_{yy,k+1}=R+\sum_{i=0}^{2n}W_i^c[Y_{i,k+1}-\hat Y_{k+1}][Y_{i,k+1}-\hat Y_{k+1}]^T",
        "ok",
        r"With points drawn again it is $HP_{xx}H^T+R$; with those of (25) it lacks $HQH^T$.",
        _REDRAWN,
    ),
    Equation(
        "28",
        "Cross-covariance",
        r"P_{xy,k+1}=\sum_{i=0}^{2n}W_i^c[X_{i,k+1}-\hat X_{k+1}][Y_{i,k+1}-\hat Y_{k+1}]^T",
        "ok",
        r"With points drawn again it is $P_{xx}H^T$; with those of (25) it lacks $QH^T$.",
        _REDRAWN,
    ),
    Equation(
        "29",
        "Gain",
        r"K_{k+1}=\frac{P_{xy}}{P_{yy}}",
        "ambiguous",
        "A fraction of matrices; the inverse belongs on the right (E16).",
        _REDRAWN,
        corrected=r"K_{k+1}=P_{xy}P_{yy}^{-1}",
    ),
    Equation(
        "30",
        "Updated state",
        r"X_{i,k+1}=\hat X_{k+1}+K_{k+1}[Z_{k+1}-\hat Y_{k+1}]",
        "wrong",
        "The left side is a sigma point where the mean belongs (E16): as printed every sigma point gets the same value.",
        f"{_AS_PRINTED}::test_the_printed_update_is_the_equations_letter_by_letter",
        corrected=r"\hat X_{k+1}=\hat X_{k+1}^-+K_{k+1}[Z_{k+1}-\hat Y_{k+1}]",
    ),
    Equation(
        "31",
        "Updated covariance",
        r"P_{XX,k+1}=P_{xx,k+1}-K_{k+1}P_{yy,k+1}(K_{k+1})^T",
        "ok",
        r"Since $h$ is linear, the update with points drawn again is the Kalman update, whose Joseph form is used.",
        _REDRAWN,
    ),
)

EQUATIONS: tuple[Equation, ...] = (*_SIGMA_POINTS, *_PREDICTION, *_GATE, *_CORRECTION)
"""Equations (14)-(31), in the paper's order."""
