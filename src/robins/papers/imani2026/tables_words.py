"""Tables 1 to 4: what the two filters are, the symbols of model and filters, and the simulated sensors."""

import numpy as np
import pandas as pd

from robins.papers.columns import LINEAR, keys, make, numbers, texts
from robins.papers.imani2026.table_parts import not_available
from robins.papers.protocol import Results, Table

FEATURES = (
    ("idea", "inflates the noise of channels that fail a chi-square test (35)", "weighs residuals by kernels of several widths (39), (40)"),
    ("statistic", "squared innovation over its covariance, channel after channel (31), (34)", "innovation over its standard deviation"),
    ("small innovation", "factor 1: the EKF exactly, where c0 = 1", "weight near 1: the EKF nearly"),
    ("large innovation", "R grows in proportion to its square; influence falls as 1/y where noise dominates (Prop6)",
     "weight falls as exp(-y^2 / 2 sigma^2); influence falls to zero (Prop6)"),
    ("where the weight acts", "on the noise: R alpha, so an update that trusts the prior little hardly changes (Prop5)",
     "on the gain: K W (43); all of the update shrinks"),
    ("covariance", "Joseph form with R alpha", "Joseph form with K W; (42) as printed is no covariance (Prop4)"),
    ("parameters", "beta, c0, c1", "widths and mixing weights of the kernels"),
    ("as printed", "inflates too little by about S / R (Prop5); without the bar on R the EKF",
     "weights have units and exceed 1; the filter overshoots and fails (Prop3)"),
    ("skewed noise", "biased in proportion to what it inflates", "biased: solves E[w(e) e] = 0 (Prop7)"),
    ("gross errors", "reduced", "reduced more where they are beyond the widest kernel"),
    ("manoeuvres", "look like gross errors where noise dominates (Prop10)", "the same (Prop10)"),
    ("iterations", "none", "none as printed; the cited filter iterates (mk-li)"),
    ("unobservable position and velocity", "no remedy (Prop2)", "no remedy (Prop2)"),
)  # fmt: skip
"""Aspect, CI-RKF and MKMC-EKF, in the words of this study."""

MODEL_SYMBOLS = (
    ("r^n", "position, local metres east, north, up", "m", "(3), (15)"),
    ("v^n", "velocity against the earth", "m/s", "(3), (4), (15)"),
    ("C_b^n", "rotation of body axes (forward, left, up) into navigation axes", "1", "(4), (5)"),
    ("q", "quaternion (w, x, y, z) of C_b^n", "1", "(15)"),
    ("phi, theta, psi", "roll, pitch, yaw; nose up is theta < 0, yaw counter-clockwise from east", "rad", "section 6"),
    ("b_a, b_g", "biases of accelerometer and gyroscope", "m/s^2, rad/s", "(15), (17)"),
    ("f_ib^b", "specific force in body axes", "m/s^2", "(4), (8)"),
    ("omega_ib^b", "rate against inertial space in body axes", "rad/s", "(5), (9)"),
    ("omega_ie^n, omega_en^n", "rate of the earth, and of navigation axes against the earth", "rad/s", "(4)"),
    ("omega_in^n", "their sum, left out in the printed (5)", "rad/s", "(5)"),
    ("g^n", "gravity, (0, 0, -g)", "m/s^2", "(4)"),
    ("x_tr,f, x_tr,omega", "transients of force and rate; states in F1", "m/s^2, rad/s", "(7)-(9)"),
    ("tau", "time constant of the transients", "s", "(7)"),
    ("u(t)", "what drives the transients", "m/s^3, rad/s^2", "(7)"),
    ("w_g, w_ng", "Gaussian and non-Gaussian process noise", "as the state's derivative", "(10)-(14)"),
    ("z", "sample of the atomic sensors, an average over the sampling interval", "m/s^2, rad/s", "(16)"),
    ("Delta Phi", "phase of the atom interferometer", "rad", "(1), (2), (6)"),
    ("k_eff", "effective wave vector", "rad/m", "(1), (6)"),
    ("T", "time between the light pulses in (1), twice that in (6)", "s", "(1), (6)"),
    ("A, Omega, lambda, v", "area, rate, matter wavelength and velocity of the Sagnac phase", "m^2, rad/s, m, m/s", "(2)"),
)
"""Symbol, meaning, unit and equations of the model."""

FILTER_SYMBOLS = (
    ("x_k, P_k", "state and covariance; a minus marks those before the update", "as the state", "(18)-(25)"),
    ("u_k", "input of the prediction: the sample (F0), nothing (F1), the classical unit (F2)", "m/s^2, rad/s", "(18), (19)"),
    ("F_k, Q_k", "transition matrix, discrete, and covariance of the process noise", "as the state", "(20)-(22)"),
    ("H_k, R_k", "measurement matrix and covariance of the measurement noise", "as the sample", "(23), (26)"),
    ("K_k", "gain", "as state over sample", "(23), (36)"),
    ("y_k, e", "innovation (residual)", "m/s^2, rad/s", "(27), (40)"),
    ("S_k", "covariance of the innovation", "as the sample squared", "(28)"),
    ("chi^2_k, Delta chi^2", "normalised innovation squared, and its increment", "1", "(29)-(34)"),
    ("beta", "probability of the threshold chi^2_beta(1)", "1", "(35)"),
    ("rho_i", "increment over the threshold", "1", "(35)"),
    ("c_0, c_1", "where the factor begins to grow, and where it changes form", "1", "(35)"),
    ("alpha_i", "factor on the noise variance of channel i", "1", "(35)"),
    ("sigma_j, eta_j", "width of kernel j, in standard deviations of the innovation, and its mixing weight", "1", "(39), (40)"),
    ("V", "correntropy", "1", "(39)"),
    ("w_i, W", "weight of channel i, normalised to 1 at zero innovation, and their diagonal matrix", "1", "(40)-(43)"),
    ("RMSE, mean, sd", "measures of an error over the epochs, with the roots put back", "as the channel", "(44)-(46)"),
    ("e_N", "final drift: the error at the last epoch", "as the channel", "section 6.2"),
)
"""Symbol, meaning, unit and equations of the filters."""

IN_DEGREES = {"rad": "deg", "rad/s": "deg/s"}


def table_1(results: Results) -> pd.DataFrame:
    """Table 1: the two filters side by side, in words."""
    return pd.DataFrame(FEATURES, columns=["feature", "ci_rkf", "mkmc_ekf"])


def symbols(rows: tuple) -> pd.DataFrame:
    """Symbols with their meaning, unit and equations."""
    return pd.DataFrame(rows, columns=["symbol", "meaning", "unit", "equations"])


def table_2(results: Results) -> pd.DataFrame:
    """Table 2: symbols of the model."""
    return symbols(MODEL_SYMBOLS)


def table_3(results: Results) -> pd.DataFrame:
    """Table 3: symbols of the filters."""
    return symbols(FILTER_SYMBOLS)


def table_4(results: Results) -> pd.DataFrame:
    """Table 4: parameters of the simulated sensors, angles in degrees."""
    found = results.table("drive")[["parameter", "symbol", "value", "unit", "source"]]
    angular = found["unit"].isin(IN_DEGREES)
    value = found["value"].where(~angular, np.degrees(found["value"]))
    return found.assign(value=value, unit=found["unit"].replace(IN_DEGREES))


SYMBOL_COLUMNS = (keys("symbol"), texts("meaning", "unit", "equations"))

WORD_TABLES: tuple[Table, ...] = (
    make(
        "table-1", "CI-RKF and MKMC-EKF, feature by feature", table_1, (keys("feature"), texts("ci_rkf", "mkmc_ekf")), (),
        f"{not_available(1)} In words, for the filters as they are run here; Prop: propositions of the register.", "", "Table 1",
    ),
    make("table-2", "Symbols of the model", table_2, SYMBOL_COLUMNS, (), not_available(2), "", "Table 2"),
    make("table-3", "Symbols of the filters", table_3, SYMBOL_COLUMNS, (), not_available(3), "", "Table 3"),
    make(
        "table-4", "Parameters of the simulated sensors", table_4,
        (keys("parameter"), texts("symbol"), numbers("value", relative=LINEAR), texts("unit", "source")), ("drive",),
        f"{not_available(4)} The sensors are simulated (D2). source: printed in the paper, or chosen here; standard deviations of noise "
        "are per sample at 10 Hz.", "", "Table 4",
    ),
)  # fmt: skip
"""Tables 1 to 4."""
