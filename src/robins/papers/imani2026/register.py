"""The register of errata, readings, assumptions and propositions, and the paper's equations with it.

E names errors in the printed theory, A readings of what is ambiguous or may be lost in the available text, B where the study's own
brief is wrong; S, D and Prop stand in `register_choices`.
"""

from robins.papers.imani2026 import equations_filters, equations_navigation
from robins.papers.imani2026.register_choices import CHOICES, DISCLOSURES, PROPOSITIONS
from robins.papers.protocol import Assumption, Equation

EQUATIONS: tuple[Equation, ...] = (*equations_navigation.EQUATIONS, *equations_filters.EQUATIONS)
"""Equations (1)-(46), in the paper's order; (35a) is the display between (35) and (36) that has no number."""

_ERRATA = (
    Assumption(
        "E1",
        "erratum",
        r"(5) and (14) leave out the rotation of the navigation frame, $[\omega_{in}^n\times]C_b^n$.",
        r"$7.3\times 10^{-5}$ rad/s over 330 s is 1.4 deg, more than the effects that the sensors are praised for. It is included; the "
        "ablation *omega_in left out* in `extra-ablations` leaves it out.",
    ),
    Assumption(
        "E2",
        "erratum",
        "(17) holds a force and a rate that are no functions of the state (15), and its text calls specific force compensated for gravity "
        "while it says that attitude does not appear, although (26) differentiates for it.",
        "What the filter compares its sample with is not defined. Three formulations are run (S1).",
    ),
    Assumption(
        "E3",
        "erratum",
        "(21) is the Jacobian of the continuous-time system; its Coriolis blocks follow from $2\\omega_{ib}\\times v$ with the body's "
        "rate.",
        "As a transition in (20) it cannot be run, which a test shows. With the body's rate the term would reach 2.4 m/s² in a turn of "
        "0.3 rad/s at 4 m/s. The discrete transition with the Earth's and the transport rate is used.",
    ),
    Assumption(
        "E4",
        "erratum",
        r"(22) gives $\sigma_v=0.1$ m/s$^2$, an acceleration, in the place of a velocity, and does not say per step or per second.",
        r"Per step, $\sigma_{b_g}=10^{-4}$ rad/s lets the bias of a drift-free gyro wander by $5.7\times 10^{-3}$ rad/s in 3300 steps. "
        "See S6.",
    ),
    Assumption(
        "E5",
        "erratum",
        "(30) defines the increment as a difference in time, (31) as the statistic itself; (34) gives it a law that (30) cannot have.",
        r"Under the null hypothesis (30) exceeds the 95 % quantile with probability 0.195 ($n=6$) or 0.034 ($n=1$). It is run as "
        "`ci-temp`.",
    ),
    Assumption(
        "E6",
        "erratum",
        "The increment of one channel, which (34) and (35) need, is never defined.",
        "Sequential increments stand for the paper's CI-RKF (S9); they depend on the order of the channels, which is accelerations, "
        "then rates. Marginal ones are run as `ci-marg`.",
    ),
    Assumption(
        "E7",
        "erratum",
        r"$\bar R=\alpha R$ with the factor of (35) inflates too little: the innovation returns to the threshold only if $P=0$.",
        r"`ci-corr` uses $\alpha_i=1+(\rho_i-1)S_{ii}/R_{ii}$ and is run beside it; see Prop5.",
    ),
    Assumption(
        "E8",
        "erratum",
        r"The weights (40) are not normalised and have the unit of one over the square of the innovation's.",
        "With kernel widths in proportion to the residuals, as the text wants, a zero innovation weighs 73 (accelerometer) or 46 000 "
        "(gyro). Run as printed as `mk-raw`; the other forms whiten and normalise. See Prop3.",
    ),
    Assumption(
        "E9",
        "erratum",
        r"$W_kK_k$ in (42) and (43) does not conform: six rows of weights against one row of the gain for each state.",
        r"$K_kW_k$ is used. Weights for states, which would conform, are defined nowhere.",
    ),
    Assumption(
        "E10",
        "erratum",
        "Section 5 reports an excess kurtosis of 19.91 and compares it with 3, the kurtosis of a Gaussian; its excess kurtosis is 0.",
        "The number is taken as excess kurtosis. Read as kurtosis it would be an excess of 16.91, which is an ablation.",
    ),
    Assumption(
        "E11",
        "erratum",
        r"The text under (6) defines $T$ as under (1), the time between pulses; the factors 1/4 and 1/2 belong to the whole time $2T_\pi$.",
        "As described, (1) and (6) differ by a factor of four. Neither is used by the filters.",
    ),
    Assumption(
        "E12",
        "erratum",
        "The transients of (7)-(9) are not in the state (15), their excitation is not given, and they are added to a force and a rate that "
        "are called measured.",
        "A measured force holds them already. In F0 they are part of the truth at most, in F1 they are states.",
    ),
    Assumption(
        "E13",
        "erratum",
        "(39) is a mixture of kernels, one for all channels; the multi-kernel correntropy of the works that the paper cites gives each "
        "channel its own width.",
        "The mixture is used where the paper is followed; the cited filter is run as `mk-li` and `mk-li-warm`, with "
        "weight one for the prior; in the ensemble `full` also with the prior weighed.",
    ),
)

_READINGS = (
    Assumption(
        "A1",
        "ambiguity",
        "(7) reads as growth with $+1/\\tau$; the available text has lost every minus sign, so the print may be right.",
        "Decay is used, as the text under (7) says.",
    ),
    Assumption(
        "A2",
        "ambiguity",
        r"The third case of (35) repeats the second or has lost its form, equality is in no case, and $c_0$, $c_1$ and $\beta$ are not "
        "given.",
        r"As read, linear in both cases, in the main variants, with $\beta=0.95$, $c_0=1$ (no jump) and $c_1=3$ or tuned. The root form "
        "(`ci-sqrt`) and the rejecting form (`ci-reject`) are run too.",
    ),
    Assumption(
        "A3",
        "ambiguity",
        "The bar on $R$ in (36) is lost in the available text or forgotten.",
        "It is put in. Without it (`ci-nobar`) the filter is the EKF, exactly.",
    ),
    Assumption(
        "A4",
        "ambiguity",
        "(44) and (46) have no root, which may be lost in the available text only.",
        "Roots are taken. Without them an error reduced by 90 % would count as an improvement of 99 %.",
    ),
    Assumption(
        "A5",
        "ambiguity",
        "Final drift is called the accumulated error at the end of the record.",
        r"The error at the last epoch, $|e_N|$, is reported; the integral of the error stands beside it.",
    ),
    Assumption(
        "A6",
        "ambiguity",
        "The Shapiro-Wilk test is said to return a p-value 0.05; a relation sign is missing.",
        "Read as below 0.05.",
    ),
    Assumption(
        "A7",
        "ambiguity",
        "The vehicle is said to have reversed along the same path after P4.",
        "Read as having turned and driven back. Driving backwards is a switch of the scenario.",
    ),
    Assumption(
        "A8",
        "ambiguity",
        "Latitude, longitude and altitude are called outputs in a frame of east, north and up; body axes are said to be set to these.",
        "Metres in the local tangent frame. Body axes are forward, left and up, so zero attitude points east, yaw grows counter-clockwise "
        "from east, and nose up is a negative pitch.",
    ),
    Assumption(
        "A9",
        "ambiguity",
        "(14) adds noise to a rotation matrix, and the quaternion of (15) is corrected by a sum in (24).",
        "Noise and corrections of the attitude are rotations, multiplied from the body's side. The literal sum, with the "
        "quaternion made a unit again, differs in second order and is not run.",
    ),
    Assumption(
        "A10",
        "ambiguity",
        r"Acceleration and rate are scored but are not in the state; whether the sample or its interval is meant is not said.",
        "They are compared with the truth at the sample's time and with the mean over its interval: a sample that averages lags.",
    ),
)

_BRIEF = (
    Assumption(
        "B1",
        "correction",
        r"The brief's proposition 9: the probability of an improvement beyond 90 % is $(2/\pi)\arctan 0.1$, which it gives as 6.4 %.",
        "It is 6.3 %; what follows from it is unchanged.",
    ),
    Assumption(
        "B2",
        "correction",
        "The brief's point 2: in F0 and F1 one further eigenvalue, 1e-9 to 1e-10 of the largest, is yaw by gyrocompassing.",
        "It is 1.9e-7 in F0 and 5.6e-11 in F1; the brief's ranks at both thresholds hold if F and H are taken along the drive that the "
        "model itself integrates and the transport rate is left aside (with it a velocity shows in F0, 1.7e-8).",
    ),
    Assumption(
        "B3",
        "correction",
        "The brief's sampling spread of the excess kurtosis at 3300 samples begins at 8.9.",
        "Over 30 000 records it begins at 9.35; the conclusion, that one record identifies no law, is unchanged.",
    ),
    Assumption(
        "B4",
        "correction",
        "The brief's design values of check A6: 0.0425 m/s and 2.95e-5 rad without noise.",
        "A step that takes half the turn of both frames before the specific force leaves 0.0171 m/s and 1.8e-5 rad, of second order in the "
        "step; the bounds of the check hold.",
    ),
    Assumption(
        "B5",
        "correction",
        "The brief's pitfall 2: a diagonal transient noise loses about 2.5 % of each turn when tau is 2 s.",
        "With the transient steps that the brief gives it loses 4.1 % of a full turn; the coupled noise less than 0.3 %.",
    ),
)

ASSUMPTIONS: tuple[Assumption, ...] = (*_ERRATA, *_READINGS, *CHOICES, *DISCLOSURES, *PROPOSITIONS, *_BRIEF)
"""The whole register, in this order."""
