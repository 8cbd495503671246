"""The part of the register that is about this study: V verified facts, D decisions and disclosures, Prop proofs, B against its brief.

Names with E and A are those of `register` and `register_choices`.
"""

from robins.papers.protocol import Assumption

FACTS = (
    Assumption(
        "V1",
        "verified",
        "SCC1300-D04: ±300 deg/s and ±6 g by the front page of its data sheet (Doc. 82 1131 00); 18 counts per deg/s and 650 per g by "
        "public code of its maker.",
        "Resolution is that of the sensor. The table of its noise was not read; the sibling D02 is advertised with a bias stability below "
        "1 deg/h (A16).",
    ),
    Assumption(
        "V2",
        "verified",
        "By the paper: inertial data at 20 Hz, a fix each second, speed from a CarChip logger at the OBD-II socket, reference a NovAtel "
        "SPAN.",
        "20 Hz and 1 Hz are used.",
    ),
    Assumption(
        "V3",
        "verified",
        "Public course code on what looks like data of the same kind has 50 061 samples at 20 Hz, 2503 s, speed at 1 Hz, reference at 5 "
        "Hz.",
        "Not the data of the paper. Its drives may be about 42 minutes long, longer than those used here.",
    ),
)

DECISIONS = (
    Assumption(
        "D1",
        "decision",
        "The GPS environment was chosen from five candidates by one rule: the median horizontal RMSE of `ekf-pi` without tuning or gate on "
        "twelve calibration runs, against the published 112 m (T1) and 288 m (T2).",
        "Nothing else had been looked at: no UKF, no gate, no tuning had run on it. A level that agrees says nothing.",
    ),
    Assumption(
        "D2",
        "decision",
        "Then it was frozen. `ekf-pm` and the terms of the turn were added afterwards, as checks of robustness.",
        "The environment is calibrated on one reading of the baseline only. With the generator of this study it is not tuned again: the "
        "medians of `ekf-pi` and `ekf-pm` and their distance from the target are reported.",
    ),
    Assumption(
        "D3",
        "decision",
        "The physical Q was set once, a priori; R as reported and R four times as large were both to be run.",
        "Both are reported.",
    ),
    Assumption(
        "D4",
        "decision",
        "The paper's method stands as `ukf-st-gate`, and its headline has settings frozen on the tuning runs of T1. A ratio is judged "
        "against `ekf-pi` and against `ekf-pm`.",
        "A claim that holds against one reading only is called dependent on the baseline.",
    ),
    Assumption(
        "D5",
        "decision",
        "Rules of the claims, grids and settings were fixed before the reporting seed was run; a development seed was looked at.",
        "Calibration, tuning, reporting and side studies have runs of their own, which never overlap.",
    ),
    Assumption(
        "D6",
        "decision",
        "All filters of a comparison read the same samples. Ratios are of geometric means, with medians and 90 % quantiles beside them.",
        "Intervals are over runs on fixed drives: they do not cover other drives, and two drives are no sample of roads.",
    ),
    Assumption(
        "D7",
        "decision",
        "A covariance that has no Cholesky factor, or a horizontal error beyond 100 km, ends a run: it is recorded with its epoch and "
        "counted.",
        "Nothing is repaired in silence, and a failed run has no error.",
    ),
    Assumption(
        "D8",
        "substitute",
        "The recordings are not public. Drives, sensors and satellites are simulated.",
        "Levels of RMSE cannot be tested. Ratios, directions and attributions can, for a configuration that the paper may have had.",
    ),
    Assumption(
        "D9",
        "disclosure",
        "Tuning has one criterion, the mean log RMSE over seven channels, and one grid, the same for every filter.",
        "Another criterion may choose other thresholds; every setting's objective is published. Near ties there are decided by a few "
        "tuning "
        "runs, and a scale may stand at the end of the grid.",
    ),
    Assumption(
        "D10",
        "disclosure",
        "Tuning with the truth of the evaluated run, and the side studies, have fewer runs than the factorial; the first only for `ekf-pi` "
        "and `ukf`.",
        "Every row has its n.",
    ),
    Assumption(
        "D11",
        "disclosure",
        "Figures 1 and 2 are drawings of our own after the text; no image of the paper was used.",
        "Figure 2 marks where the method needs the truth, which the text says and the abstract does not.",
    ),
)

PROPOSITIONS = (
    Assumption(
        "Prop1",
        "proposition",
        r"A heading error that is uniform over the circle has an RMSE of $180/\sqrt 3=103.92$ deg.",
        "The published 103.38 deg on T2 is what a heading without any information has.",
    ),
    Assumption(
        "Prop2",
        "proposition",
        r"If a fraction $f$ of the samples is wrong by one turn and the rest is right, the RMSE is $360\sqrt f$ deg.",
        "The published 103.38 and 45.88 deg are also what 8.25 % and 1.62 % of samples with a turn too much have. Either way they measure "
        "no filter; which it is cannot be told without the data.",
    ),
    Assumption(
        "Prop3",
        "proposition",
        r"Pitch from (1) is wrong by about $a/g$, so a change of speed raises the computed height by $\int Va/g\,dt=\Delta(V^2)/2g$.",
        "From rest to 15 m/s 11.5 m, to 12.4 m/s 7.8 m; the error goes back when the car stops, so it is bounded. No filter has a state "
        "for it.",
    ),
    Assumption(
        "Prop4",
        "proposition",
        "In (1) the three velocities are functions of two states, azimuth and odometer error: to first order, and without noise of their "
        "own, their covariance has rank two at most.",
        "A combination of the velocities is certain, and the predicted covariance singular. A Cholesky factor needs the floor of A11.",
    ),
    Assumption(
        "Prop5",
        "proposition",
        "The weight of the centre multiplies the square of its distance from the mean, which is zero in a linear problem.",
        "There (18) as printed and the sum agree. The distance is of the order of the curvature, so only a nonlinear problem tells them "
        "apart.",
    ),
    Assumption(
        "Prop6",
        "proposition",
        r"A mean of 100 m in latitude is $1.57\times 10^{-5}$ rad, and as rad² it is a deviation of $3.96\times 10^{-3}$ rad.",
        "25 km at every step: with such a mean the filter forgets its position between two fixes.",
    ),
    Assumption(
        "Prop7",
        "proposition",
        "A jump of J in one fix is a difference of J to the fix before and of J to the fix after it, apart from what the car has driven.",
        "If J exceeds the second threshold of (24), the good fix after the jump is rejected too. A jump of 200 m costs two fixes at a "
        "multiple of 4 (160 m) and passes at 8 (240 and 320 m).",
    ),
    Assumption(
        "Prop8",
        "proposition",
        "With a linear observation the mean and covariance of points drawn again are exactly the predicted ones, and (26)-(31) are the "
        "Kalman update.",
        "Only the prediction differs between `ukf` and `ekf-f`: what the unscented transform can give, it gives there.",
    ),
)

BRIEF = (
    Assumption(
        "B1",
        "correction",
        r"The brief's true rate of the gyro has the term $-\dot p\sin r$.",
        r"With its axes it is $+\dot p\sin r$, which the truth has. On a slope of 6 % and a crossfall of 2.8 % it is 0.1 deg; the term "
        "changes its sign with the slope, and no filter models it.",
    ),
    Assumption(
        "B2",
        "correction",
        "The brief lets a literal self-tuned value in radians act in a metric state by multiplying once with the Earth's radius.",
        "Once is 100 m² for a mean of 100 m, a deviation of 10 m. As the number acts it is a variance in rad² and takes the radius twice, "
        "which gives the 25 km that the brief itself derives (Prop6). That is run.",
    ),
    Assumption(
        "B3",
        "correction",
        r"The brief gives the variance of a Gauss-Markov step twice, as $\sigma^2(1-e^{-2\Delta t/\tau})$ and as $2\sigma^2\Delta t/\tau$.",
        "They differ by the part $\\Delta t/\\tau$, less than 0.1 %; the second is used, with the exact decay.",
    ),
    Assumption(
        "B4",
        "correction",
        "The brief says that (4) needs a minus sign with a clockwise azimuth and a z-up gyro.",
        "So it does for the error of the gyro. For the state that it subtracts from the gyro plus is right, and the odometer's column of "
        "(3) gets the minus.",
    ),
    Assumption(
        "B5",
        "correction",
        "The brief names seeds: 0 to 11, 100 to 149, 400 to 699 and 1000 to 1007 for runs, 101 and 202 for drives.",
        "The runs have these numbers; their random numbers come from streams that are named by paper, drive, run and sensor and have the "
        "configuration's seed. The drives are the first from 101 and 202 on that have the brief's length, and do not depend on that seed.",
    ),
)
