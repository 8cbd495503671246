"""The register of errata, assumptions, verified facts, decisions and propositions, and the paper's equations with it.

E names errors in the printed theory, A what the paper does not say and what is assumed instead; V verified facts, D decisions and
disclosures, Prop proofs and B deviations from the study's own brief stand in `register_choices` and `register_decisions`.
"""

from robins.papers.ghouneem2024 import equations_filters, equations_mechanisation
from robins.papers.ghouneem2024.register_choices import CHOICES
from robins.papers.ghouneem2024.register_decisions import BRIEF, DECISIONS, FACTS, PROPOSITIONS
from robins.papers.protocol import Assumption, Equation

EQUATIONS: tuple[Equation, ...] = (*equations_mechanisation.EQUATIONS, *equations_filters.EQUATIONS)
"""Equations (1)-(31), in the paper's order."""

_MECHANISATION = (
    Assumption(
        "E1",
        "erratum",
        r"(1) has $\lambda_{t+1}$ on the right.",
        "Not causal, so there is no literal form to run; the epoch before is used.",
    ),
    Assumption(
        "E2",
        "erratum",
        "(1) is circular: the azimuth needs the east velocity of the same epoch, which needs the azimuth.",
        "Pitch and roll first, then azimuth with latitude, velocity and height of the epoch before, then velocity, then position.",
    ),
    Assumption(
        "E3",
        "erratum",
        r"$V^e=V\sin A$ in (1) is that of a clockwise azimuth, to which a z-up gyro adds with the wrong sign. A z-down gyro has the right "
        "sign, but then the rates of the Earth and of transport have the wrong one.",
        "With z up a car that turns right is computed to turn left. With z down a constant error of 21.0 deg/h is left at 44.23 deg north "
        "(twice 15.04 deg/h times the sine), which a bias state can absorb. The whole bracket is subtracted; the printed sign is an "
        "ablation.",
    ),
    Assumption(
        "E4",
        "erratum",
        "Pitch in (1) has the sign of an accelerometer that reports minus the specific force; roll is right for both.",
        "With specific force the vertical velocity is upside down. The sign is mended everywhere; the literal one is an ablation.",
    ),
    Assumption(
        "E5",
        "erratum",
        "Pitch and roll in (1) take the car's own acceleration for slope, unlike the usual mechanisation, which subtracts the odometer's "
        "acceleration and the centripetal one.",
        "Prop3: an error of height with every change of speed, and of vertical velocity. It is kept as printed in all filters; the mended "
        "form is an ablation.",
    ),
    Assumption(
        "E6",
        "erratum",
        "Gyro and odometer errors are states, but (1), through which the sigma points go, does not contain them.",
        r"$\omega^z-b$ and $V^{od}-d$ are used in place of $\omega^z$ and $V^{od}$.",
    ),
    Assumption("E7", "erratum", "(2) has no derivative in time on its left side.", "The derivative is put in."),
    Assumption(
        "E8",
        "erratum",
        r"(3) leaves out what a turn does to the error of velocity, $V\dot A\,\delta A$ and $V\,\delta\dot A$; it has no process noise and "
        "no error of pitch.",
        "The filter is told that errors in a turn are those of a straight road, and can become too sure of itself: NEES and NIS are "
        "reported. The printed model is run; `ekf-pi` with the terms added is an ablation.",
    ),
    Assumption(
        "E9",
        "erratum",
        "(4) drives the azimuth by the slowly varying gyro error alone; the white noise of the gyro has no place.",
        "The level `ds` adds white noise of 1.3 times the sensor's to the azimuth.",
    ),
)

_FILTERS = (
    Assumption(
        "E10",
        "erratum",
        "(12) and (13) put the mean of a signed error where a variance belongs.",
        "It can be negative, which no covariance is, or cancel to nothing; its unit is that of the state, not of its square. How many of "
        "the seven are negative on the tuning runs is reported.",
    ),
    Assumption(
        "E11",
        "erratum",
        "(12) averages the drift over a whole drive, and (23) adds it at every step.",
        "At 20 Hz that is 20 times a second. The increment of the error over a second, a twentieth of it per step, is what process noise "
        "means; it is run as `st-inc`.",
    ),
    Assumption(
        "E12",
        "erratum",
        "The abstract calls the tuning dynamic and real-time. By section II-A Q is constant, and both matrices are means of errors "
        "against the reference unit, adjusted by hand afterwards.",
        "The method needs the truth of the drive it is judged on. Settings are frozen on other runs for every headline number; what the "
        "truth of the same run is worth is measured apart.",
    ),
    Assumption(
        "E13",
        "erratum",
        r"(15) and (16) take the $i$-th row of a Cholesky factor with $i$ up to $2n$.",
        r"Columns of the lower factor, with $i-n$ in (16).",
    ),
    Assumption(
        "E14",
        "erratum",
        r"(18) multiplies by $1-\alpha^2+\beta$ what should be added.",
        "Harmless on linear problems (Prop5). The sum is used; the product is run at three values of alpha, and failures are counted.",
    ),
    Assumption(
        "E15",
        "erratum",
        "(25) observes the propagated points, which do not hold the process noise of (23).",
        r"Gain and innovation covariance belong to $P^--Q$. Points are drawn again; the printed way is an ablation.",
    ),
    Assumption(
        "E16",
        "erratum",
        "(29) is a fraction of two matrices, and (30) updates a sigma point.",
        "The inverse from the right, and the mean.",
    ),
    Assumption(
        "E17",
        "erratum",
        "Tables II and III have two rows Longitude.",
        "The second is read as altitude: it is the third of the position.",
    ),
    Assumption(
        "E18",
        "erratum",
        "The text calls the numbers of the tables maximum RMSE values, and gives errors of latitude and longitude in metres.",
        "One RMSE over the whole drive at 20 Hz. Metres are radians times the radii of curvature.",
    ),
    Assumption(
        "E19",
        "erratum",
        "Table I says that an EKF predicts the error of the navigation state and a UKF the whole state.",
        "That is a choice of model, not of filter: `ekf-f` is an EKF on the whole state. Without it the change of model would pass for the "
        "unscented transform.",
    ),
)

ASSUMPTIONS: tuple[Assumption, ...] = (*_MECHANISATION, *_FILTERS, *CHOICES, *FACTS, *DECISIONS, *PROPOSITIONS, *BRIEF)
"""The whole register, in this order."""
