"""The register of assumptions and errata, and the paper's equations with it.

Names A1-A19 (readings) and E1-E3 (errors in the printed theory) are those of the study's science brief; B1-B5 say where
that brief itself is wrong; D1-D7 are disclosures of the study itself.
"""

from robins.papers.hajiyev2023.equations import EQUATIONS
from robins.papers.protocol import Assumption

__all__ = ["ASSUMPTIONS", "EQUATIONS"]

_ERRATA = (
    Assumption(
        "E1",
        "erratum",
        r"The differenced noise is not white when $Q_v\ne 0$: $E[\xi(k)\xi^T(k-1)]=-A_nQ_v$ (around (9)).",
        "MDKF, AMDKF and BH mis-weight it; only the augmented filter, or differencing with $v$ in the state, is optimal.",
    ),
    Assumption(
        "E2",
        "erratum",
        r"$C$ is applied at the wrong time index in (14), (16), (18) and (24), and is missing in (13) and (15).",
        "The corrected filter (BH, ABH) is run beside the printed one in every table.",
    ),
    Assumption(
        "E3",
        "erratum",
        "Statement 1 is false: the innovation of the printed filter has neither covariance (18) nor independent epochs.",
        "Matching against (18), equations (20) and (21), matches against a wrong target.",
    ),
)

_READINGS = (
    Assumption(
        "A1",
        "ambiguity",
        r"$\hat x(k/k)$ uses $z(k+1)$; it is scored against $x(k)$, as printed.",
        "The printed filters look one step ahead. They are compared with delayed estimates of the others, and the filtered ones are "
        "shown too.",
    ),
    Assumption(
        "A2",
        "ambiguity",
        r"The authors' program may have processed $\mu(k-1)$ at $k$ as if it were a measurement of $x(k)$.",
        "Run once as the variants one step late, never as a main result.",
    ),
    Assumption("A3", "ambiguity", "The noise is claimed white in (9).", "Kept in the printed variants; see E1."),
    Assumption("A4", "ambiguity", "The index of $C$ in (14), (16), (18).", "Kept in the printed variants; see E2."),
    Assumption(
        "A5",
        "ambiguity",
        "(20)-(24) scale all of $R$, the process noise in it included, which no sensor fault touches.",
        "Printed variants scale $R$; ABH scales only $Q_v+A_nQ_vA_n^T$.",
    ),
    Assumption(
        "A6",
        "ambiguity",
        "The feedthrough $HBu$ of (12) and (17) is easy to drop.",
        "Kept everywhere. Without it the errors depend on the input, which a test shows.",
    ),
    Assumption(
        "A7",
        "ambiguity",
        "(16) is a covariance only at the optimal gain and loses symmetry by round-off.",
        "The Joseph form is used; equal at this gain.",
    ),
    Assumption(
        "A8",
        "ambiguity",
        "$S$ multiplies $R$ from the left and $R^{-1}$ stands on the right in (21).",
        r"No difference here, where $R$ is diagonal. The code's form is $R^{1/2}SR^{T/2}$ with the Cholesky factor as root, the brief's "
        r"is $S^{1/2}RS^{1/2}$: equal for diagonal $R$ only, and only the second multiplies the diagonal by $s_i$ in general.",
    ),
    Assumption(
        "A9",
        "ambiguity",
        "$C$ is not scaled in (24).",
        "Right: a sensor fault does not touch it, and the joint covariance stays positive since $s_i\\ge 1$.",
    ),
    Assumption(
        "A10",
        "ambiguity",
        "The covariance after adaptation is not given.",
        "$S^*R$ is used in (16), the only choice for which it is a covariance; the unscaled form is an ablation.",
    ),
    Assumption(
        "A11",
        "ambiguity",
        "The window holds the current innovation; its start is undefined; old innovations are kept after adaptation.",
        "$S^*=I$ until $M$ innovations exist; a partial window is an ablation.",
    ),
    Assumption(
        "A12",
        "ambiguity",
        "Whether adaptation is always on.",
        "Always on; the gated variant scales only channels beyond the 99.9 % quantile.",
    ),
    Assumption("A13", "ambiguity", "Steady-state or recursive gains.", "Recursive."),
    Assumption(
        "A14",
        "ambiguity",
        "(27) and (28) add $8v$ and $5v$; the text multiplies the deviation by 8 and 5.",
        "The text is followed; 9 and 6 are in the sweep.",
    ),
    Assumption(
        "A15",
        "ambiguity",
        r"The noise changes at $k=80\ldots150$, so $\mu$ changes at $k=79\ldots150$.",
        r"The first affected estimate is $\hat x(79/79)$, one epoch before the score begins.",
    ),
    Assumption(
        "A16",
        "erratum",
        "(29) divides 71 squares by 70.",
        "Levels are larger by 1.0071 than a mean square would give; ratios are unaffected.",
    ),
    Assumption(
        "A17",
        "assumption",
        "How the errors of (25) and (26) enter the eight outputs, and their parameters, are not given.",
        r"Each channel has its own error with $A_n=(1-\Delta t/\tau)I$, $B_n=\Delta t\,I$, $\tau=100$ s; $\tau$ is swept from 2 to "
        "500 s.",
    ),
    Assumption(
        "A18", "assumption", "$H$ and $G$ are not printed.", "$H=I_8$ from the eight rows of Table 1 and the names in (27), (28); $G=I$."
    ),
    Assumption(
        "A19",
        "assumption",
        "The angular units of Table 1 are labelled deg and deg/s; the numbers fit radians better.",
        "Two branches, `deg` and `rad`; both are shown everywhere and never averaged (D5).",
    ),
)

_BRIEF = (
    Assumption(
        "B1",
        "correction",
        "The brief's sections 2.4 and 3.1: lateral results are not identical in both branches for the rules with one factor for all "
        "channels, which couple the two blocks.",
        "They are identical, and hence count once, for filters without adaptation and with one factor for each channel only.",
    ),
    Assumption(
        "B2",
        "correction",
        r"The brief's section 1.3: $\mathrm{diag}(H_d)\approx(F_{ii}+1/\tau)\Delta t$ holds for $u$, $\theta$, $\phi$ and roughly $p$. "
        r"For $w$, $q$, $\beta$ and $r$ terms of second order in $\Delta t$ are not small: $-0.0213$ instead of $-0.0047$ for $\beta$.",
        r"$H_d$ is small on its diagonal only: the element of row $w$ and column $q$ is about $U_0\Delta t$, 17.5 m/s per rad/s.",
    ),
    Assumption(
        "B3",
        "correction",
        r"The norm of a gain column, by which C11 is to be judged, depends on the units of the states: its rows are in m/s and rad, and "
        "row $w$ decides it.",
        "The brief's norm decides, since its rule was fixed beforehand; it can grow while the channel's own element of the gain falls.",
    ),
    Assumption(
        "B4",
        "correction",
        r"The absolute differences that the brief expects in T2 depend on the noise drawn; only their fall as $1/P_{\lambda 0}$ is exact.",
        "The test holds the scaling and the tolerance, not the listed values.",
    ),
    Assumption(
        "B5",
        "correction",
        r"The corrected matching of A8 takes $H_dP(k)H_d^T+R$ of BH for the covariance of its innovations, false for $Q_v>0$ (E1).",
        "ABH matches against a target that is exact for $Q_v=0$ only; with $v$ it is an approximation like the filter it adapts.",
    ),
)

_DISCLOSURES = (
    Assumption(
        "D1",
        "disclosure",
        "Noise levels are calibrated on the published MDKF column only. That column cannot be fitted jointly on the substitute aircraft.",
        "Levels of RMSE are untestable; the misfit of every state is reported. Only ratios and directions are judged.",
    ),
    Assumption(
        "D2",
        "disclosure",
        r"After the fit, $\sigma_0$ was lowered by hand ($\phi$ 0.5 to 0.1 deg, $\theta$ and $\beta$ 0.5 to 0.2 deg), and "
        r"$\sigma_\lambda$ of $\phi$ from 0.3 to 0.1 deg.",
        r"Brings the level of $\phi$ into range. Levels of $u$, $\theta$ and $\phi$ mostly show the initial error.",
    ),
    Assumption(
        "D3",
        "disclosure",
        "AMDKF output at the parameters before the fit had been seen before the fit.",
        "The calibration is blind to the AMDKF column by construction, but not strictly blind. The values were frozen before scoring.",
    ),
    Assumption(
        "D4",
        "substitute",
        "The matrices of the paper's BRAVO aircraft (McLean 1990) were not found in public sources. An F-4C Phantom II at about Mach "
        "0.6 and 35 000 ft stands in; "
        "its longitudinal matrix and lateral derivatives come from public scripts that cite NASA CR-2144, which could not be opened.",
        "No number here is a number of BRAVO. The pitch damping, the least certain derivative, is swept.",
    ),
    Assumption(
        "D5",
        "disclosure",
        "The `rad` branch was proposed after results of the `deg` branch were known, though on evidence of the MDKF column alone.",
        "That the printed angles are radians is a hypothesis. With one factor for each channel, or none, lateral ratios are equal "
        "in both branches (B1); longitudinal ones can differ, and then the verdict says so.",
    ),
    Assumption(
        "D6",
        "assumption",
        "Sampling time, window, inputs, initial values, number of steps and seed are not printed: 0.1 s, 20, one-degree doublets, "
        "zero state, 200 steps, many runs. Random numbers come from streams named by paper, scenario, run and kind of noise, not from "
        "the two generators that the brief names.",
        "Inputs do not change any error. Sampling time and window are swept, and a specification curve varies all levels at once. "
        "Numbers of single runs cannot be compared with those of another program that follows the brief.",
    ),
    Assumption(
        "D7",
        "disclosure",
        "After the first run of the reporting seeds a reviewer found that the autocorrelation interval of C10's controls used the number "
        "of products of lag 0 for every lag.",
        "It was corrected; no overall verdict changed.",
    ),
)

ASSUMPTIONS: tuple[Assumption, ...] = (*_ERRATA, *_READINGS, *_BRIEF, *_DISCLOSURES)
"""The register of errata, readings, corrections of the brief, assumptions and disclosures."""
