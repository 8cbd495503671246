"""The part of the register that does not correct the paper: S choices of this study, D disclosures and substitutes, Prop proofs.

Names with E and A are those of `register`.
"""

from robins.papers.protocol import Assumption

CHOICES = (
    Assumption(
        "S1",
        "assumption",
        "What drives the prediction and what the update compares is not settled by the paper (E2, Prop1).",
        "F0: the sample drives, and the update compares it with a vehicle at rest. F1: nothing drives, force and rate are "
        "states, each sample is used once. F2: a classical inertial unit drives and the atomic one is compared with it. No verdict without "
        "its formulation; F1 is the headline.",
    ),
    Assumption(
        "S2",
        "assumption",
        "In F0 and F2, which have no state for them, acceleration and rate are the last sample less its estimated bias, turned into ENU.",
        "Filters differ in these channels only through bias and attitude there; in F1 they are filtered.",
    ),
    Assumption(
        "S3",
        "assumption",
        r"F1 has $\tau=50$ s and process noise that gives force and rate the spread of the drive, coupled into velocity and attitude over "
        "each interval.",
        "A short time constant (2 s) makes the filter level on centripetal force and lose part of each turn; it is not used.",
    ),
    Assumption(
        "S4",
        "assumption",
        "The law of the gyro noise is known by two moments only. A normal-inverse-Gaussian law with exactly these is used, and a mixture "
        "of two Gaussians with the same two as an alternative; accelerometers have a symmetric law with excess kurtosis 6.",
        "Two moments name no law: sampling alone spreads them over 1.7 to 4.0 and 9 to 44 in a record of 3300 samples (95 %).",
    ),
    Assumption(
        "S5",
        "assumption",
        "Skewed noise can have zero mean or zero mode; the paper does not say which.",
        "Zero mean is the headline, zero mode a condition: it decides whether filters that neglect large innovations are biased (Prop7).",
    ),
    Assumption(
        "S6",
        "assumption",
        r"(22) has three readings: as printed per step; `printed-dt` with $\sigma_v^2\Delta t^2$ and the other variances times $\Delta t$; "
        "`tuned` for the formulation.",
        "F0 uses `printed-dt`, F1 and F2 use `tuned`. In the error state the deviation of an attitude angle is twice that of a quaternion "
        "component.",
    ),
    Assumption(
        "S7",
        "assumption",
        r"$R$ is not given: the total variance of the simulated noise, 0.05 m/s$^2$ and 0.002 rad/s per sample at 10 Hz.",
        "Every filter is told the true variance and none the true law. The sensor grade of an ideal atomic unit is a condition.",
    ),
    Assumption(
        "S8",
        "assumption",
        r"Kernel widths and mixing weights are not given: 1.5, 3 and 8 standard deviations of the innovation with 0.3, 0.4 and 0.3.",
        "A convention, and the start of the tuning; the width is swept from far below to far above.",
    ),
    Assumption(
        "S9",
        "assumption",
        r"The paper's CI-RKF stands as `ci-seq` (sequential increments, linear factor), its MKMC-EKF as `mk-norm-gain` (weights "
        r"normalised, gain $KW$, Joseph form).",
        "Both are charitable: as printed the first inflates too little, and the second (`mk-raw`) overshoots wherever the weight times the "
        "gain exceeds two.",
    ),
    Assumption(
        "S10",
        "assumption",
        "The paper tuned the MKMC-EKF offline for low RMSE and says nothing of the kind for the CI-RKF.",
        "Every family of filters is tuned with the same budget of 16 settings, on runs that no result uses, for the mean log RMSE of the "
        "12 channels against truth in F1; then the settings are frozen. Retuning at 2 % outliers is a separate condition.",
    ),
    Assumption(
        "S11",
        "assumption",
        "Rates of 1 to 10 Hz are called usual; that of the experiment is not given.",
        "10 Hz is the headline; 1 to 100 Hz are swept, with equal noise per sample and with equal noise density.",
    ),
    Assumption(
        "S12",
        "assumption",
        "Duration, route in numbers, speeds and initial errors are not given, beyond six way points and zero initial velocity and bias.",
        "A drive of 330 s and 1872 m past six way points; tilt errors of 0.02 deg and yaw errors of 0.5 deg, drawn alike for "
        "every filter and formulation.",
    ),
    Assumption(
        "S13",
        "assumption",
        r"Gravity 9.80 m/s$^2$ and latitude 38.06 deg (Tabriz) are constants of the whole drive.",
        "The simulated truth has the same constants, so no error comes from them.",
    ),
)

DISCLOSURES = (
    Assumption(
        "D1",
        "disclosure",
        "Cells of Tables 1 to 5 were not in the text that was available, nor was any figure.",
        "No number of a single channel can be compared. Published are three ranges of improvement, two moments and four deviations.",
    ),
    Assumption(
        "D2",
        "substitute",
        "No recording of the paper is public. The drive, the sensors and their errors are simulated.",
        "Any agreement in size is agreement with a configuration that the paper may have had.",
    ),
    Assumption(
        "D3",
        "substitute",
        "The VITANS reference is replaced by the truth with slowly varying errors and differentiated angles.",
        "Every score is given against truth and against this reference; the second has a floor (Prop8).",
    ),
    Assumption(
        "D4",
        "disclosure",
        "Controls that the paper does not have are reported beside every figure for its filters: no update, inflated noise, a gate, one "
        "kernel, the corrected increment.",
        "A gain over the CI-RKF can come from correntropy, from leaving outliers out, or from an update that hardly acts.",
    ),
    Assumption(
        "D5",
        "disclosure",
        "Figures 1 to 4 are drawings of our own after the text; no image of the paper or of its sources was used.",
        "They show principles, not the authors' hardware, and no position in them is to scale.",
    ),
    Assumption(
        "D6",
        "disclosure",
        "Rules, grids and settings were fixed before the reporting seed was run; a development seed was looked at. With it a first grid of "
        "the CI-RKF, from a probability of 0.80 to 0.999, was found too short: a wider one took away the MKMC-EKF's lead.",
        "All robust families now reach a factor of four to either side of their conventional setting; `extra-budget` marks what is still "
        "at an edge.",
    ),
    Assumption(
        "D7",
        "disclosure",
        "Sweeps have 20 runs, those above 10 Hz and the one-at-a-time tables 5.",
        "Below fifty runs intervals are Student's on a jackknife and p values count exchanges of the two filters; five runs can never "
        "exclude chance in twelve channels, and such rows say inconclusive.",
    ),
)

PROPOSITIONS = (
    Assumption(
        "Prop1",
        "proposition",
        r"Self-measurement: if $h(\hat x)=(z-\hat b)+\hat b$, the innovation is zero and no gain or weight changes the estimate.",
        "Every filter of the paper is then dead reckoning, and its covariance shrinks without information. A comparison of filters needs "
        "another reading (S1).",
    ),
    Assumption(
        "Prop2",
        "proposition",
        "Position and velocity are unobservable: their columns in the measurement Jacobian are zero and stay so through the transition.",
        "No weight bounds the error of velocity: a tilt of 1 mrad is 9.8 mm/s² and 3.2 m/s after 330 s.",
    ),
    Assumption(
        "Prop3",
        "proposition",
        r"Unnormalised weights: the scalar error is multiplied by $1-w\kappa$ with $\kappa=P/(P+R)$ and $w(0)=\sum\eta_j/\sigma_j^2$.",
        r"It grows where $w\kappa>2$, wide kernels give no update instead of the EKF, and radians or degrees decide the result. Whitened "
        "and normalised weights are free of units.",
    ),
    Assumption(
        "Prop4",
        "proposition",
        r"Printed covariance: with the gain $w\kappa$ the posterior variance is $P(1-\kappa w(2-w))$, whereas (42) says $(1-w\kappa)P$.",
        "Too large for weights below one, too small above, negative where the weight times the gain exceeds one. The Joseph form is right "
        "for every gain.",
    ),
    Assumption(
        "Prop5",
        "proposition",
        r"Under-inflation: $y^2=\chi_\beta^2(P+\alpha R)$ asks for $\alpha=1+(\rho-1)S/R$; the printed $\alpha=\rho$ is right only for "
        "$P=0$.",
        "For an innovation of 8 deviations and $P/R=17.6$ the gain falls from 0.946 to 0.514 instead of 0.057.",
    ),
    Assumption(
        "Prop6",
        "proposition",
        r"Influence where noise dominates: $y$ (EKF), $1/y$ (linear increment), constant (root, Huber), zero (rejection), "
        r"$y\,e^{-y^2/2\sigma^2}$ (correntropy).",
        "The filters differ in how they forget large innovations. Where the prior dominates, weights on the noise hardly act.",
    ),
    Assumption(
        "Prop7",
        "proposition",
        r"Skewed noise: a filter with weights solves $E[w(e)\,e]=0$, not $E[e]=0$.",
        "With zero-mean noise of the published moments a kernel of one deviation is off by -0.141 deviations, of three by -0.063.",
    ),
    Assumption(
        "Prop8",
        "proposition",
        r"Floor of the reference: with its error $s$ independent of the filter, $RMSE_{ref}^2=RMSE^2+s^2$, and an improvement $I$ needs "
        r"$RMSE_{CI}\ge s/(1-I)$.",
        "Angles with white noise of 0.1 deg, differentiated at 10 Hz, have $s=0.0123$ rad/s: an improvement of 99 % in rate needs a CI-RKF "
        "that is wrong by 71 deg/s.",
    ),
    Assumption(
        "Prop9",
        "proposition",
        r"Ratio of one draw: for equal filters with normal final errors, $P(I>x)=(2/\pi)\arctan(1-x)$.",
        "An improvement beyond 90 % comes by chance with 6.3 % in one cell and with 79 % in at least one of 24. One run supports none.",
    ),
    Assumption(
        "Prop10",
        "proposition",
        "With one sample an epoch, a jump of the state and an outlier give the same innovation.",
        "A correntropy filter that starts at the prior rejects manoeuvres where the prior dominates; one that starts at the least-squares "
        "solution accepts outliers. Rate and bandwidth decide, and are swept.",
    ),
)
