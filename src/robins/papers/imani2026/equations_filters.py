"""Equations (23)-(46): the three filters and the scores, as printed and as they are used here.

Names such as E1, A1 and Prop1 are those of `register`. Minus signs, transposes and roots that the available text of the paper has
lost are put back where they cannot be otherwise; where they can, the status is ``ambiguous``. In corrected forms
``y`` is the innovation, ``S`` its covariance with the plain R, ``\\bar S`` with the weighted one.
"""

from robins.papers.protocol import Equation

_UPDATE = "tests/kalman/test_update.py"
_CHI_SQUARE = "tests/kalman/test_chi_square.py"
_AS_PRINTED = "tests/papers/imani2026/test_as_printed.py"
_FORMULATIONS = "tests/papers/imani2026/test_formulations.py"
_SCORING = "tests/papers/imani2026/test_scoring.py"

_TEXTBOOK = f"{_UPDATE}::test_the_update_is_the_textbook_one"
_STATISTIC = f"{_CHI_SQUARE}::test_sequential_increments_sum_to_the_chi_square_of_the_innovation"
_SEQUENTIAL = f"{_CHI_SQUARE}::test_sequential_increments_are_those_of_a_filter_that_takes_one_channel_after_the_other"
_INFLATED = f"{_UPDATE}::test_a_weight_divides_the_noise_of_a_diagonal_r"
_LAW = f"{_CHI_SQUARE}::test_sequential_increments_follow_chi_square_of_one_degree_and_are_independent"
_INCREMENT = r"(z_k-h(\hat x_k^-))^T(H_kP_k^-H_k^T+R_k)^{-1}(z_k-h(\hat x_k^-))"

_EKF = (
    Equation("23", "Gain", r"K_k=P_k^-H_k^T(H_kP_k^-H_k^T+R_k)^{-1}", "ok", "", _TEXTBOOK),
    Equation(
        "24",
        "Estimate",
        r"\hat x_k=\hat x_k^-+K_k(z_k-h(\hat x_k^-))",
        "ok",
        "For the attitude the correction is a rotation and is multiplied on, not added to the quaternion.",
        _TEXTBOOK,
    ),
    Equation(
        "25",
        "Covariance",
        r"P_k=(I-K_kH_k)P_k^-",
        "ok",
        "Right at the optimal gain only; the Joseph form is used everywhere.",
        _TEXTBOOK,
        corrected=r"P_k=(I-K_kH_k)P_k^-(I-K_kH_k)^T+K_kR_kK_k^T",
    ),
    Equation(
        "26",
        "Measurement Jacobian",
        r"H_k=\begin{pmatrix}0&0&H_{a,q}&I&0\\0&0&H_{\omega,q}&0&I\end{pmatrix}",
        "ambiguous",
        "The blocks for the attitude are not zero only if the measurement function holds gravity and frame rate in body axes, which "
        "(17) and its text deny. In error-state form they are three columns wide.",
        f"{_FORMULATIONS}::test_jacobians_agree_with_central_differences",
        corrected=r"H_{a,\theta}=-[\hat C^T\mathbf g^n\times],\quad H_{\omega,\theta}=[\hat C^T\boldsymbol\omega_{in}^n\times]",
    ),
)

_CI_STATISTIC = (
    Equation("27", "Innovation", r"y_k=z_k-h(\hat x_k^-)", "ok", "", _STATISTIC),
    Equation("28", "Innovation covariance", r"S_k=H_kP_k^-H_k^T+R_k", "ok", "", _STATISTIC),
    Equation("29", "Chi-square of the innovation", r"\chi_k^2=y_k^TS_k^{-1}y_k", "ok", "", _STATISTIC),
    Equation(
        "30",
        "Increment in time",
        r"\Delta\chi_k^2=\chi_k^2-\chi_{k-1}^2",
        "wrong",
        r"A difference of two chi-squares is symmetric about zero and no $\chi^2(1)$ as (34) needs, it contradicts (31), and one number "
        "cannot give a factor to each channel (E5). Run as the variant `ci-temp`.",
        f"{_CHI_SQUARE}::test_temporal_increments_do_not_follow_chi_square_of_one_degree",
        corrected=r"\Delta\chi_{k,i}^2=\nu_{k,i}^2,\quad \nu_k=L_k^{-1}y_k,\quad L_kL_k^T=S_k",
    ),
    Equation(
        "31",
        "Increment in the objective",
        r"\Delta\chi_k^2=" + _INCREMENT,
        "ambiguous",
        "The same as (29), and not the difference (30). It is the increment of the least-squares objective by epoch $k$, which is the "
        "definition followed here.",
        _STATISTIC,
    ),
    Equation(
        "32",
        "Law of the innovation",
        r"z_k-h(\hat x_k^-)\sim N(0,\ H_kP_k^-H_k^T+R_k)",
        "ok",
        "",
        _LAW,
    ),
    Equation(
        "33",
        "Law of the statistic",
        _INCREMENT + r"\sim\chi^2(n)",
        "ok",
        "Here $n=6$: three accelerations and three rates.",
        _LAW,
    ),
    Equation(
        "34",
        "Hypotheses for one channel",
        r"H_0:\ \Delta\chi_{k,i}^2\sim\chi^2(1,0),\quad H_1:\ \Delta\chi_{k,i}^2\sim\chi^2(1,\lambda)",
        "ambiguous",
        "The increment of one channel is never defined (E6). Squares of the innovations whitened by the Cholesky factor are independent, "
        "have this law and sum to (29); they are what sequential processing of the channels finds.",
        _SEQUENTIAL,
        corrected=r"\Delta\chi_{k,i}^2=\frac{(y_i-h_i\hat x_{i-1})^2}{h_iP_{i-1}h_i^T+r_i}=\nu_{k,i}^2,\quad "
        r"\sum_i\Delta\chi_{k,i}^2=\chi_k^2",
    ),
)

_CI_UPDATE = (
    Equation(
        "35",
        "Robust factor",
        r"\alpha_i=1\ (\rho_i<c_0);\quad \rho_i\ (c_0<\rho_i<c_1);\quad \rho_i\ (\rho_i>c_1),\quad "
        r"\rho_i=\Delta\chi_{k,i}^2/\chi_\beta^2(1)",
        "ambiguous",
        r"The third case repeats the second, or has lost its form; $c_0$, $c_1$ and $\beta$ are not given, and equality belongs to no "
        r"case. The factor jumps at $c_0$ unless $c_0=1$ (A2). Linear, root and rejecting forms are run.",
        f"{_CHI_SQUARE}::test_the_three_shapes_of_the_factor",
        corrected=r"\alpha_i=1\ (\rho_i\le c_0);\quad \rho_i\ (\rho_i>c_0),\quad c_0=1,\ \beta=0.95",
    ),
    Equation(
        "35a",
        "Inflated noise (display without a number)",
        r"\bar R_k=\alpha R_k",
        "wrong",
        r"Inflation of $R$ is the right direction but the wrong size: the statistic comes down to the threshold only if $P=0$ (E7, Prop5). "
        "The product is symmetric for diagonal $R$ only.",
        f"{_CHI_SQUARE}::test_after_the_correction_the_statistic_is_at_its_threshold_and_as_printed_above_it",
        corrected=r"\bar R_k=\alpha^{1/2}R_k\alpha^{1/2},\quad \alpha_i=1+(\rho_i-1)S_{ii}/R_{ii}",
    ),
    Equation(
        "36",
        "Robust gain",
        r"K_k=P_k^-H_k^T[H_kP_k^-H_k^T+R_k]^{-1}",
        "ambiguous",
        r"The bar on $R$ is forgotten or lost. Without it the whole test changes nothing: the filter is the EKF (A3), which is run as "
        "`ci-nobar`.",
        f"{_AS_PRINTED}::test_without_the_bar_on_r_the_robust_filter_is_the_ekf",
        corrected=r"K_k=P_k^-H_k^T[H_kP_k^-H_k^T+\bar R_k]^{-1}",
    ),
    Equation(
        "37",
        "Robust covariance",
        r"P_k=[I-K_kH_k]P_k^-",
        "ok",
        "The Joseph form with the inflated noise is used.",
        _INFLATED,
        corrected=r"P_k=(I-K_kH_k)P_k^-(I-K_kH_k)^T+K_k\bar R_kK_k^T",
    ),
    Equation("38", "Robust estimate", r"\hat x_k=\hat x_k^-+K_k[z_k-h(\hat x_k^-)]", "ok", "", _INFLATED),
)

_CORRENTROPY = (
    Equation(
        "39",
        "Multi-kernel correntropy",
        r"V(x,y)=\sum_{i=1}^{L}\eta_i\exp\left(-\frac{\|x-y\|^2}{2\sigma_i^2}\right)",
        "ambiguous",
        "One mixture of kernels for the whole vector, whereas (40) is per component. The multi-kernel correntropy of the paper's own "
        "references gives each channel its own width instead (E13).",
        "tests/papers/imani2026/test_influence.py::test_the_weight_is_the_derivative_of_the_mixture_correntropy",
        corrected=r"J=\sum_i\sigma_i^2\{1-\exp(-e_i^2/2\sigma_i^2)\}",
    ),
    Equation(
        "40",
        "Weights",
        r"w_i=\sum_{j=1}^{L}\frac{\eta_j}{\sigma_j^2}\exp\left(-\frac{e_{k,i}^2}{2\sigma_j^2}\right),\quad "
        r"W_k=\mathrm{diag}(w_1,\dots,w_n)",
        "wrong",
        "Neither whitened nor normalised, so the weight of a zero innovation has the unit of one over the square of the channel's: far "
        "above one in SI, another in degrees, and zero for wide kernels (E8, Prop3).",
        f"{_AS_PRINTED}::test_printed_weights_of_a_zero_innovation_are_far_above_one",
        corrected=r"\bar w_i=w_i(e_i)/w_i(0)\in(0,1],\quad e_i=y_i/\sqrt{S_{ii}}",
    ),
    Equation(
        "41",
        "Gain",
        r"K_k=P_k^-H_k^TS_k^{-1}",
        "ok",
        "The gain of the EKF, without any weight in it.",
        f"{_AS_PRINTED}::test_printed_update_is_the_equations_letter_by_letter",
    ),
    Equation(
        "42",
        "Covariance",
        r"P_k=(I-W_kK_kH_k)P_k^-",
        "wrong",
        r"$W_k$ is 6 by 6 and $K_k$ has a row for each state: they do not conform (E9). With $K_kW_k$ the result is no covariance of the "
        "estimate, and negative where weights exceed one (Prop4).",
        f"{_AS_PRINTED}::test_printed_covariance_is_not_that_of_the_estimate",
        corrected=r"P_k=(I-K_kW_kH_k)P_k^-(I-K_kW_kH_k)^T+K_kW_kR_kW_kK_k^T",
    ),
    Equation(
        "43",
        "Estimate",
        r"\hat x_k=\hat x_k^-+W_kK_ky_k",
        "wrong",
        r"As (42) the product does not conform; $K_kW_ky_k$ is used. It overshoots where the weight times the gain exceeds two (Prop3).",
        f"{_AS_PRINTED}::test_printed_update_is_the_equations_letter_by_letter",
        corrected=r"\hat x_k=\hat x_k^-+K_kW_ky_k",
    ),
)

_SCORES = (
    Equation(
        "44",
        "Root mean square error",
        r"\mathrm{RMSE}=\frac1N\sum_{k=1}^{N}(x_k^{est}-x_k^{ref})^2",
        "ambiguous",
        "By its name it has a root, which may be lost in the available text only (A4); without it an improvement in per cent is another "
        "number.",
        f"{_SCORING}::test_rmse_has_a_root",
        corrected=r"\mathrm{RMSE}=\sqrt{\frac1N\sum_{k=1}^{N}(x_k^{est}-x_k^{ref})^2}",
    ),
    Equation(
        "45",
        "Mean error",
        r"\mathrm{Mean}=\frac1N\sum_{k=1}^{N}(x_k^{est}-x_k^{ref})",
        "ok",
        "Signed; an improvement needs its absolute value.",
        f"{_SCORING}::test_mean_error_keeps_its_sign",
    ),
    Equation(
        "46",
        "Standard deviation of the error",
        r"\sigma=\frac1N\sum_{k=1}^{N}(e_k-\bar e)^2",
        "ambiguous",
        r"As (44). With both roots $\mathrm{RMSE}^2=\mathrm{Mean}^2+\sigma^2$.",
        f"{_SCORING}::test_squared_rmse_is_squared_mean_plus_squared_deviation",
        corrected=r"\sigma=\sqrt{\frac1N\sum_{k=1}^{N}(e_k-\bar e)^2}",
    ),
)

EQUATIONS: tuple[Equation, ...] = (*_EKF, *_CI_STATISTIC, *_CI_UPDATE, *_CORRENTROPY, *_SCORES)
"""Equations (23)-(46), in the paper's order; (35a) is the display between (35) and (36) that has no number."""
