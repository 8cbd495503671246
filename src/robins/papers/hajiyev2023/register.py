"""The register of assumptions and errata, and the paper's equations with it.

Names A1-A19 (readings) and E1-E3 (errors in the printed theory) are those of the study's science brief; D1-D6 are
disclosures of the study itself.
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
        "Statement 1 is false: the innovation of the printed filter has neither covariance (18) nor, with white noise, independent epochs.",
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
        "No difference here, where $R$ is diagonal; the general form is $R^{1/2}S R^{T/2}$ with ratios of diagonals.",
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
        "That the printed angles are radians is a hypothesis. Lateral ratios are equal in both branches; longitudinal ones can "
        "differ, and then the verdict says so.",
    ),
    Assumption(
        "D6",
        "assumption",
        "Sampling time, window, inputs, initial values, number of steps and seed are not printed: 0.1 s, 20, one-degree doublets, "
        "zero state, 200 steps, many seeds.",
        "Inputs do not change any error. Sampling time and window are swept, and a specification curve varies all levels at once.",
    ),
)

ASSUMPTIONS: tuple[Assumption, ...] = (*_ERRATA, *_READINGS, *_DISCLOSURES)
"""The register of errata, readings, assumptions and disclosures."""
