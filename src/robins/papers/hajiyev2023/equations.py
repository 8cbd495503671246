"""The paper's numbered equations, as printed and, where they are wrong or ambiguous, as they are used here.

Names such as A1 and E1 are those of `register`, T1-T16 those of the acceptance tests. One notation holds for every
corrected form: ``x(k/k)`` and ``P(k)`` are the estimate and its covariance given z(0..k); ``x(k/k+1)`` and ``P(k/k+1)``
are those given z(0..k+1), after ``mu(k)``; ``\\Sigma = H_d P(k) H_d^T + R`` is the innovation covariance.
"""

from robins.papers.protocol import Equation

_TESTS = "tests/papers/hajiyev2023"
_COMPOSED = f"{_TESTS}/test_as_printed.py::test_composed_filter_is_the_printed_equations"
_XI = f"{_TESTS}/test_as_printed.py::test_xi_and_the_noise_of_the_coming_step_have_the_covariances_of_equations_10_and_11"
_SIX = f"{_TESTS}/test_as_printed.py::test_equation_6_holds_for_every_simulated_epoch"
_TRUTH = f"{_TESTS}/test_scenario.py::test_truth_and_measurement_obey_equations_1_2_and_4"
_ERROR_MODEL = f"{_TESTS}/test_scenario.py::test_correlated_error_decays_with_tau_and_keeps_its_variance"
_OTHER_CASE = f"{_TESTS}/test_as_printed.py::test_equation_14_is_the_optimal_gain_of_the_other_textbook_case"
_PETOVELLO = f"{_TESTS}/test_acceptance.py::test_t03_the_non_delayed_form_is_bh"
_MIXES = f"{_TESTS}/test_as_printed.py::test_a8_equation_21_mixes_channels_when_r_is_not_diagonal"
_ROOTS = f"{_TESTS}/test_as_printed.py::test_a8_the_two_symmetric_forms_agree_for_diagonal_r_only"
_LITERAL_FAULT = f"{_TESTS}/test_as_printed.py::test_a14_equations_27_and_28_taken_literally_multiply_by_nine_and_six"

_NO_V = " The corrected form is exact for $Q_v=0$; otherwise $v$ joins the state (T4)."
"""Every form of the corrected filter rests on xi being white."""
_DIAGONAL = " The corrected form and the code's $R_v^{1/2}SR_v^{T/2}$ are equal for diagonal $R_v$ only."

_PROBLEM = (
    Equation("1", "State", r"x(k)=A\,x(k-1)+B\,u(k-1)+G\,w(k-1)", "ok", "No matrix is printed; $G=I$ here.", _TRUTH),
    Equation(
        "2", "Measurement", r"z(k)=H\,x(k)+v(k)+\lambda(k)", "ok", "$H$ is not printed; eight scored states give $H=I$ (A18).", _TRUTH
    ),
    Equation(
        "3",
        "Noise covariances",
        r"E[w(k)w^T(j)]=Q_w\delta_{kj},\quad E[v(k)v^T(j)]=Q_v\delta_{kj},\quad E[w(k)v^T(j)]=0",
        "ok",
        "Neither covariance is printed; calibrated levels stand in (D1-D3).",
        f"{_TESTS}/test_scenario.py::test_noises_have_their_covariances_and_no_correlation",
    ),
    Equation("4", "Time-correlated error", r"\lambda(k)=A_n\lambda(k-1)+B_nU(k-1)", "ok", "", _TRUTH),
    Equation(
        "5",
        "Driving noise",
        r"E[U(k)]=0,\quad E[U(k)U^T(j)]=Q_U\delta_{kj}",
        "ok",
        r"$Q_U$ is not printed; it follows from the stationary deviation: $\sigma_U=\sigma_\lambda\sqrt{1-a^2}/\Delta t$ with "
        r"$a=1-\Delta t/\tau$ (A17).",
        _ERROR_MODEL,
    ),
)

_DIFFERENCING = (
    Equation(
        "6",
        "Differenced measurement",
        r"\mu(k)=z(k+1)-A_nz(k)=(HA-A_nH)x(k)+HBu(k)+HGw(k)+B_nU(k)+v(k+1)-A_nv(k)",
        "ambiguous",
        "An identity. But $\\mu(k)$ contains $z(k+1)$: an estimate of $x(k)$ from it looks one step ahead (A1); and $HBu(k)$ is easy "
        "to drop (A6).",
        _SIX,
    ),
    Equation(
        "7",
        "Differenced system",
        r"x(j)=Ax(j-1)+Bu(j-1)+Gw(j-1),\quad \mu(j-1)=H_dx(j-1)+HBu(j-1)+\xi(j-1)",
        "ok",
        "",
        _SIX,
    ),
    Equation(
        "8",
        "Its matrix and noise",
        r"H_d=HA-A_nH,\quad \mu(k-1)=z(k)-A_nz(k-1),\quad \xi(k-1)=HGw(k-1)+B_nU(k-1)+v(k)-A_nv(k-1)",
        "ok",
        r"The diagonal of $H_d$ is small, so the level of $u$, $\theta$ and $\phi$ is nearly unobservable; for these three and roughly for "
        r"$p$ it is $(F_{ii}+1/\tau)\Delta t$. Off the diagonal, row $w$ is not small (B2).",
        _SIX,
    ),
    Equation(
        "9",
        "The noise is called white",
        r"E[\xi(k-1)]=0,\quad\text{and in words: }\xi\text{ is white}",
        "wrong",
        r"The formula is right; the words around it, a purely random process (white noise), hold only for $Q_v=0$. Two neighbours share "
        "a $v$: a moving average of first order (E1).",
        f"{_TESTS}/test_as_printed.py::test_e1_xi_is_a_moving_average_of_first_order_and_white_only_without_v",
        corrected=r"E[\xi(k)]=0,\quad E[\xi(k)\xi^T(k-1)]=-A_nQ_v,\quad E[\xi(k)\xi^T(k-l)]=0\;(l\ge 2)",
    ),
    Equation(
        "10",
        "Its covariance",
        r"R=E[\xi\xi^T]=HGQ_wG^TH^T+B_nQ_UB_n^T+Q_v+A_nQ_vA_n^T",
        "ok",
        "Right for one time. A sensor fault changes the last two terms only (A5).",
        _XI,
    ),
    Equation(
        "11",
        "Correlation with the process noise",
        r"C=E[Gw(k-1)\xi^T(k-1)]=GQ_wG^TH^T",
        "ok",
        r"Right, and it says that $\xi(k)$ is correlated with the noise of the coming step; (14), (16) and (18) use it for the step "
        "before (E2).",
        _XI,
    ),
)

_MDKF = (
    Equation(
        "12",
        "Estimate",
        r"\hat x(k/k)=\hat x(k/k-1)+K(k)\{\mu(k)-HBu(k)-H_d\hat x(k/k-1)\}",
        "ambiguous",
        r"$\mu(k)$ contains $z(k+1)$, so $\hat x(k/k)$ is a one-step-delayed estimate (A1). It is compared with delayed estimates of "
        r"the other filters. In corrected forms $\hat x(k/k)$ and $P(k)$ are given $z(0),\dots,z(k)$; what is called $\hat x(k/k)$ in "
        r"print is $\hat x(k/k+1)$ there." + _NO_V,
        _COMPOSED,
        corrected=r"\hat x(k/k+1)=\hat x(k/k)+K(k)\Delta(k),\quad \Delta(k)=\mu(k)-HBu(k)-H_d\hat x(k/k)",
    ),
    Equation(
        "13",
        "Extrapolated estimate",
        r"\hat x(k/k-1)=A\hat x(k-1/k-1)+Bu(k-1)",
        "wrong",
        r"$w(k-1)$ is correlated with $\xi(k-1)$, which has just been processed: its conditional mean $C\Sigma^{-1}\Delta$ is missing "
        "(E2)." + _NO_V,
        _PETOVELLO,
        corrected=r"\hat x(k+1/k+1)=A\hat x(k/k)+Bu(k)+[AP(k)H_d^T+C]\Sigma^{-1}\Delta(k)",
    ),
    Equation(
        "14",
        "Gain",
        r"K(k)=[P(k/k-1)H_d^T+C]\,[H_dP(k/k-1)H_d^T+R+H_dC+C^TH_d^T]^{-1}",
        "wrong",
        r"$\tilde x(k/k-1)$ holds $w$ up to $k-1$ and is independent of $\xi(k)$: no $C$ here (E2). The formula belongs to noise "
        "correlated with the step "
        r"before; it is right for the non-delayed form $H^*=H-A_nHA^{-1}$." + _NO_V,
        _OTHER_CASE,
        corrected=r"K(k)=P(k)H_d^T\Sigma^{-1},\quad \Sigma=H_dP(k)H_d^T+R",
    ),
    Equation(
        "15",
        "Extrapolated covariance",
        r"P(k/k-1)=AP(k-1/k-1)A^T+GQ_wG^T",
        "wrong",
        r"The correlation of process and measurement noise belongs here (E2). $P(k)$ is the covariance before $\mu(k)$, which the last "
        "term takes in; the $P(k/k+1)$ of (16) would count it twice." + _NO_V,
        f"{_TESTS}/test_acceptance.py::test_t01_bh_from_the_posterior_of_the_first_measurement_is_the_augmented_filter",
        corrected=r"P(k+1)=AP(k)A^T+GQ_wG^T-[AP(k)H_d^T+C]\Sigma^{-1}[AP(k)H_d^T+C]^T",
    ),
    Equation(
        "16",
        "Covariance",
        r"P(k/k)=P(k/k-1)-K(k)[H_dP(k/k-1)H_d^T+R+H_dC+C^TH_d^T]K^T(k)",
        "wrong",
        "As (14); besides, it equals the covariance only at the optimal gain and loses symmetry by round-off (A7). The Joseph form is "
        "used." + _NO_V,
        _OTHER_CASE,
        corrected=r"P(k/k+1)=[I-K(k)H_d]P(k)[I-K(k)H_d]^T+K(k)RK^T(k)",
    ),
    Equation("17", "Innovation", r"\Delta(j)=\mu(j)-HBu(j)-H_d\hat x(j/j-1)", "ok", "", _COMPOSED),
    Equation(
        "18",
        "Statement 1: innovation covariance",
        r"E[\Delta\Delta^T]=H_dP(j/j-1)H_d^T+R+H_dC+C^TH_d^T",
        "wrong",
        "False as printed, already for the first innovation and without white noise (E2, E3)." + _NO_V + " With $v$ the variances of "
        r"BH's innovations differ from this $\Sigma$ as well, by 9 % in $p$ (`deg`).",
        f"{_TESTS}/test_as_printed.py::test_e2_innovation_covariance_has_no_c_in_it",
        corrected=r"E[\Delta(j)\Delta^T(j)]=\Sigma=H_dP(j)H_d^T+R",
    ),
)

_AMDKF = (
    Equation(
        "19",
        "Sample covariance of the innovation",
        r"\hat S_\Delta(k)=\frac{1}{M}\sum_{j=k-M+1}^{k}\Delta(j)\Delta^T(j)",
        "ambiguous",
        "$M$ is not printed and $k<M$ is undefined: nothing is scaled until $M$ innovations exist (A11).",
        f"{_TESTS}/test_estimators.py::test_no_factor_before_the_window_is_full",
    ),
    Equation(
        "20",
        "Matching",
        r"\hat S_\Delta(k)=H_dPH_d^T+S(k)R+H_dC+C^TH_d^T",
        "wrong",
        r"Carries the error of (18). It scales the process noise inside $R$ too (A5), and $S$ from the left makes $SR$ asymmetric "
        "unless $R$ is diagonal (A8)." + _DIAGONAL + _NO_V,
        f"{_TESTS}/test_as_printed.py::test_a8_scaling_from_the_left_is_not_symmetric_but_the_root_form_is",
        corrected=r"\hat S_\Delta(k)=H_dP(k)H_d^T+R_{fix}+S^{1/2}R_vS^{1/2},\quad R_v=Q_v+A_nQ_vA_n^T,\quad R_{fix}=R-R_v",
    ),
    Equation(
        "21",
        "Scale matrix",
        r"S(k)=\{\hat S_\Delta(k)-H_dPH_d^T-H_dC-C^TH_d^T\}R^{-1}",
        "wrong",
        "As (20); $R^{-1}$ on the right mixes the channels into the diagonal unless $R$ is diagonal (A8)." + _NO_V,
        _MIXES,
        corrected=r"S_{ii}(k)=\frac{[\hat S_\Delta(k)-H_dP(k)H_d^T-R_{fix}]_{ii}}{[R_v]_{ii}}",
    ),
    Equation(
        "22",
        "Diagonal scale matrix",
        r"S^*=\mathrm{diag}(s_1,s_2,\dots,s_n)",
        "ambiguous",
        "One factor for each measurement, not for each state; both are eight here.",
        f"{_TESTS}/test_estimators.py::test_adaptive_filters_are_the_textbook_form",
        corrected=r"S^*=\mathrm{diag}(s_1,s_2,\dots,s_m)",
    ),
    Equation(
        "23",
        "Lower bound",
        r"s_i=\max\{1,S_{ii}\},\quad i=1,\dots,n",
        "ambiguous",
        r"Keeps only the upper half of the scatter of $S_{ii}$ about one: without any fault "
        r"$E[s_i]\approx 1+0.564\,(\Sigma_{ii}/R_{ii})/\sqrt{M}$, "
        "a permanent false alarm. Always on, or only after detection, is not said (A12): the gated variant answers the second reading.",
        f"{_TESTS}/test_estimators.py::test_the_lower_bound_raises_the_factors_of_a_healthy_filter",
        corrected=r"s_i=\max\{1,S_{ii}\}\;\mathrm{where}\;\hat S_{ii}/\Sigma_{ii}>\chi^2_{M,0.999}/M,\quad \mathrm{else}\;1",
    ),
    Equation(
        "24",
        "Adaptive gain",
        r"K(k)=[PH_d^T+C][H_dPH_d^T+S^*(k)R+H_dC+C^TH_d^T]^{-1}",
        "wrong",
        r"As (14) and (20). $C$ stays unscaled, rightly (A9). The covariance after adaptation is not given: $S^*R$ is used in (16) "
        "too (A10)." + _DIAGONAL + _NO_V,
        _ROOTS,
        corrected=r"K(k)=P(k)H_d^T[H_dP(k)H_d^T+R_{fix}+S^{1/2}R_vS^{1/2}]^{-1}",
    ),
)

_EXPERIMENT = (
    Equation(
        "25",
        "Accelerometer errors",
        r"a(j)=a(j-1)(1-\beta_a\Delta t)+\Delta t\,U_a(j-1)",
        "ambiguous",
        r"How accelerometer errors enter the eight measured outputs is not said: every channel has its own first-order error with "
        r"$\tau=1/\beta$ (A17). "
        r"The coefficient $\Delta t$ of $U$ is reconstructed from a damaged line.",
        _ERROR_MODEL,
        corrected=r"\lambda_i(j)=(1-\Delta t/\tau)\lambda_i(j-1)+\Delta t\,U_i(j-1)",
    ),
    Equation(
        "26",
        "Gravity errors",
        r"g(j)=g(j-1)(1-\beta_g\Delta t)+\Delta t\,U_g(j-1)",
        "ambiguous",
        "As (25).",
        _ERROR_MODEL,
        corrected=r"\lambda_i(j)=(1-\Delta t/\tau)\lambda_i(j-1)+\Delta t\,U_i(j-1)",
    ),
    Equation(
        "27",
        "Fault of the pitch-rate gyro",
        r"z_q(k)=z_q(k)+v_q(k)\times 8,\quad 80\le k\le 150",
        "ambiguous",
        "Taken literally it adds $8v$ to a measurement that holds $v$, which is nine times the noise; the text multiplies the "
        "deviation by eight (A14). "
        "The text is followed; nine and six are a sweep.",
        _LITERAL_FAULT,
        corrected=r"z_q(k)=H_qx(k)+8\,v_q(k)+\lambda_q(k)",
    ),
    Equation(
        "28",
        "Fault of the pitch-angle gyro",
        r"z_\theta(k)=z_\theta(k)+v_\theta(k)\times 5,\quad 80\le k\le 150",
        "ambiguous",
        "As (27): literally six times, by the text five times.",
        _LITERAL_FAULT,
        corrected=r"z_\theta(k)=H_\theta x(k)+5\,v_\theta(k)+\lambda_\theta(k)",
    ),
    Equation(
        "29",
        "Score",
        r"\mathrm{RMSE}=\sqrt{\frac{1}{70}\sum_{j=80}^{150}[\hat x(j/j)-x(j)]^2}",
        "wrong",
        r"Seventy-one terms over seventy: too large by $\sqrt{71/70}=1.0071$. Used as printed, so that levels compare; ratios do not "
        "change (A16).",
        f"{_TESTS}/test_as_printed.py::test_a16_seventy_one_squares_over_seventy",
        corrected=r"\mathrm{RMSE}=\sqrt{\frac{1}{71}\sum_{j=80}^{150}[\hat x(j/j)-x(j)]^2}",
    ),
)

EQUATIONS: tuple[Equation, ...] = (*_PROBLEM, *_DIFFERENCING, *_MDKF, *_AMDKF, *_EXPERIMENT)
"""Equations (1)-(29), in the paper's order."""
