"""The part of the register that says what the paper leaves open, and what is assumed instead: A.

Names with other letters are those of `register` and `register_decisions`.
"""

from robins.papers.protocol import Assumption

_FILTERS = (
    Assumption(
        "A1",
        "ambiguity",
        "The loop of the EKF is called closed, but what the correction of the velocity does is not said: (1) computes it anew from the "
        "odometer at every step, (3) integrates its error.",
        "`ekf-pi` keeps the corrected velocity and adds increments, nearer to (3); `ekf-pm` overwrites it, nearer to (1); `ekf-f` is the "
        "control, with the exact Jacobian of (1). The increment is taken with the corrected azimuth at both ends. No verdict rests on "
        "one of the first two alone.",
    ),
    Assumption(
        "A2",
        "ambiguity",
        r"$\delta od$ is an error of acceleration in (3); in (1), which the UKF propagates, it can only be one of speed.",
        "`ekf-pi` and `ekf-pm` have the first, `ekf-f` and `ukf` the second.",
    ),
    Assumption(
        "A3",
        "assumption",
        "No number of Q, P0 or of the Gauss-Markov models is printed.",
        "Level `ds`: gyro bias 10 deg/h, 300 s; odometer 60 s, 0.3 m/s or 0.113 m/s²; azimuth 1.3 times the gyro's white noise; nothing "
        "for the position. Deviations of P0: 3, 3 and 5 m, 0.3 m/s, 5 deg, 0.03 deg/s, 0.3 m/s or 0.12 m/s².",
    ),
    Assumption(
        "A4",
        "assumption",
        "How well the first position and azimuth were known is not said.",
        "Errors of 2.5, 2.5 and 4 m and 5 deg (one sigma), no velocity, no bias. A sweep goes to 179 deg, with the P0 of 5 deg and with "
        "one that "
        "knows the error: the first decides from where a filter never settles.",
    ),
    Assumption(
        "A5",
        "assumption",
        r"$\alpha$ is said to lie between $10^{-4}$ and 1, $\beta$ to be 2 and $\kappa$ to be 0; the values used are not.",
        r"0.1, 2 and 0; $\alpha$ is also run at $10^{-3}$ and 1.",
    ),
    Assumption(
        "A6",
        "ambiguity",
        "The differences in (24) are vectors of radians, metres and m/s, the thresholds are single symbols without a value, tuned by hand.",
        "By component, in metres and m/s: 30, 30, 30 m and 5, 5, 2 m/s from the prediction, 40, 40, 20 m and 6, 6, 2 m/s from the fix "
        "before, both times one multiple of 0.5, 1, 2, 4, 8 or infinity. At 0.5 every fix of a car at more than 20 m/s along an axis is "
        "rejected.",
    ),
    Assumption(
        "A7",
        "ambiguity",
        "Whether the fix before in (24) is the last received or the last accepted is not said.",
        "The last received. The last accepted would lock out for good a car that has moved on.",
    ),
    Assumption(
        "A8",
        "ambiguity",
        "No rule says what happens after an outage, or how a gate that has closed opens again.",
        "The first fix of a run has no second test; after an outage the last received fix is as old as the outage. There is no "
        "re-acquisition: the longest run of rejections is reported.",
    ),
    Assumption(
        "A9",
        "assumption",
        "What the manual adjustment of P0 and Q did is not said.",
        "`st-ms` with a scalar on Q from 1 to $10^{-10}$ stands for it in the factorial; also run are the printed means (`st-printed`), "
        "mean squares without a scalar (`st-ms`) and increments (`st-inc`). Thresholds and scalar are those of the least mean log RMSE "
        "over the seven channels of the tables.",
    ),
    Assumption(
        "A10",
        "assumption",
        "Which filter gives the integrated state in (13), and what fills the places of the states without a reference, is not said.",
        "The same filter with `ds` and no gate; gyro bias and odometer keep `ds`. Statistics are means over the tuning runs.",
    ),
    Assumption(
        "A11",
        "assumption",
        "The covariance that (1) gives the velocity is singular (Prop4).",
        "$10^{-6}$ (m/s)² are added to each velocity at every step, in `ekf-f` and `ukf` alike; in the printed error models an ablation "
        "adds them too, which changes their altitude.",
    ),
    Assumption(
        "A12",
        "ambiguity",
        "Whether the azimuth is kept within a turn, in the filter and in the tables, is not said.",
        "Never wrapped in the filter nor between its sigma points, wrapped in every error. That matters where the azimuth's deviation is "
        "radians: in the UKF with unscaled self-tuned Q, whose errors rounding decides anyway; of them only divergence is told. An RMSE "
        "without wrapping stands beside it (Prop2).",
    ),
    Assumption(
        "A13",
        "assumption",
        "Position is latitude and longitude in radians, height in metres.",
        "Every filter has north and east in metres in the plane of the origin, whose radii convert at input and output. Truth and filters "
        "have the same plane, so no error comes from it.",
    ),
    Assumption(
        "A14",
        "assumption",
        "R is what the GPS module reports, at each fix.",
        "The same here: 2.2, 2.2, 4.0 m and 0.12 m/s for a clean fix, up to four times as much in multipath, not more in a misleading fix. "
        "Errors are correlated over 120 s, which no filter models.",
    ),
)

_SCENARIO = (
    Assumption(
        "A15",
        "assumption",
        "Length, speeds and slopes of the two drives are not given in the text.",
        "T1: 1800 s, about 22 km on arterial roads at 44.23 deg north. T2: 1500 s, about 10 km in a dense city at 51.05 deg north. One "
        "truth each; slopes of 2.2 % and 2.8 % (rms).",
    ),
    Assumption(
        "A16",
        "assumption",
        "[assumed] Noise of gyro and accelerometers, typical of the class (V1).",
        "Gyro: turn-on 0.03 deg/s, drift 10 deg/h over 300 s, white 0.0237 deg/s per sample, scale 0.3 %. Accelerometers: bias 8 mg, drift "
        "2 mg over 600 s, vibration 0.1 m/s², a bias of 8 mg being 0.46 deg of pitch.",
    ),
    Assumption(
        "A17",
        "assumption",
        "[assumed] The car's speed: 1 Hz, whole km/h, 0.4 s late, scale 1.2 %.",
        "Interpolated to 20 Hz, which looks up to a second ahead; holding the last value is an ablation. The odometer's acceleration is "
        "the derivative over about a second.",
    ),
    Assumption(
        "A18",
        "assumption",
        "[assumed] GPS once a second: correlated error of 2.0, 2.0 and 3.5 m over 120 s, white 0.7, 0.7 and 1.1 m; velocity 0.05 m/s over "
        "20 s and white 0.08 m/s.",
        "The reported deviations are honest where nothing disturbs the signal.",
    ),
    Assumption(
        "A19",
        "assumption",
        "[assumed] Outages, multipath bursts and misleading fixes. Outages and interference are spoken of in the paper, none is numbered.",
        "Mean numbers per run. T1: 4 outages of 30 to 240 s, 10 bursts of 10 to 60 s with a median of 40 m, 6 misleading events. T2: 5 of "
        "60 to 300 s, 15 of 10 to 90 s with 60 m, 10. Misleading: 1 to 5 s, 100 to 400 m. Severity scales the numbers and decides the "
        "sizes of all errors: it is swept.",
    ),
    Assumption(
        "A20",
        "assumption",
        "A gate on the normalised innovation and a recovery are what a textbook would do; the paper has neither.",
        "`ekf-f` with noise set a priori from physics rejects beyond 22.46, the 99.9 % quantile of chi-square with six degrees; after more "
        "than ten rejections in a row it accepts once with enlarged R. R is also run four times as large.",
    ),
)

CHOICES: tuple[Assumption, ...] = (*_FILTERS, *_SCENARIO)
"""What is not reported and what was chosen."""
