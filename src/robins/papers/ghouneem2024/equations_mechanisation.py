"""Equations (1)-(13): mechanisation, error-state EKF and self-tuning, as printed and as they are used here.

Names such as E1, A1 and Prop1 are those of `register`. In corrected forms the state is metric, its bias $b$ and odometer error $d$ are
subtracted from the sensors, and $q$ is the variance that a step adds.
"""

from robins.papers.protocol import Equation

_RISS = "tests/navigation/test_riss.py"
_MODELS = "tests/papers/ghouneem2024/test_models.py"
_SELF_TUNING = "tests/papers/ghouneem2024/test_self_tuning.py"

_TEXTBOOK = f"{_MODELS}::test_the_update_with_a_fix_is_the_textbook_one"

_MECHANISATION = (
    Equation(
        "1",
        "RISS mechanisation",
        r"\begin{pmatrix}\varphi_t\\\lambda_t\\h_t\\V_t^e\\V_t^n\\V_t^{up}\\p_t\\r_t\\A_t\end{pmatrix}=\begin{pmatrix}"
        r"\varphi_{t-1}+\frac{V_t^n}{R_M+h_t}\Delta t\\\lambda_{t+1}+\frac{V_t^e}{(R_N+h_t)\cos(\varphi_t)}\Delta t\\"
        r"h_{t-1}+V_t^{up}\Delta t\\V_t^{od}\sin(A_t)\cos(p_t)\\V_t^{od}\cos(A_t)\cos(p_t)\\V_t^{od}\sin(p_t)\\"
        r"\tan^{-1}\left(\frac{-f_t^y}{\sqrt{(f_t^x)^2+(f_t^z)^2}}\right)\\\tan^{-1}\left(\frac{-f_t^x}{f_t^z}\right)\\"
        r"A_{t-1}+\left(\omega_t^z-\omega^e\sin(\varphi_t)-\frac{V_t^e\tan(\varphi_t)}{R_N+h_t}\right)\Delta t\end{pmatrix}",
        "wrong",
        r"$\lambda_{t+1}$ is not causal (E1) and the rows are circular (E2). $V^e=V\sin A$ needs a clockwise azimuth, so a z-up gyro is "
        "subtracted (E3): with the printed sign a quarter of a circle to the right ends on the left. Pitch has the sign of an "
        "accelerometer that reports minus the specific force (E4) and holds the car's acceleration (E5). Sensor errors are missing (E6).",
        f"{_RISS}::test_a_lap_closes_when_the_gyro_feels_the_rotation_of_the_earth",
        corrected=r"A_t=A_{t-1}-\left(\omega_t^z-b-\omega^e\sin\varphi_{t-1}-\frac{V_{t-1}^e\tan\varphi_{t-1}}{R_N+h_{t-1}}\right)\Delta t,"
        r"\quad \begin{pmatrix}V_t^e\\V_t^n\\V_t^{up}\end{pmatrix}=(V_t^{od}-d)\begin{pmatrix}\sin A_t\cos p_t\\\cos A_t\cos p_t\\\sin p_t"
        r"\end{pmatrix},\quad \begin{pmatrix}N_t\\E_t\\h_t\end{pmatrix}=\begin{pmatrix}N_{t-1}\\E_{t-1}\\h_{t-1}\end{pmatrix}+"
        r"\begin{pmatrix}V_t^n\\V_t^e\\V_t^{up}\end{pmatrix}\Delta t,\quad p_t=\tan^{-1}\frac{f_t^y}{\sqrt{(f_t^x)^2+(f_t^z)^2}}",
    ),
    Equation(
        "2",
        "Position error",
        r"\begin{pmatrix}\delta\varphi\\\delta\lambda\\\delta h\end{pmatrix}=\begin{pmatrix}0&\frac1{R_M+h}&0\\"
        r"\frac1{(R_N+h)\cos(\varphi)}&0&0\\0&0&1\end{pmatrix}\begin{pmatrix}\delta V^e\\\delta V^n\\\delta V^{up}\end{pmatrix}",
        "wrong",
        "The derivative in time is missing on the left (E7): as printed a velocity error of 1 m/s is a position error of 1 m, for however "
        "long it lasts. In metres (A13) the radii drop out.",
        f"{_MODELS}::test_position_error_is_the_integral_of_velocity_error",
        corrected=r"\begin{pmatrix}\delta\dot N\\\delta\dot E\\\delta\dot h\end{pmatrix}=\begin{pmatrix}\delta V^n\\\delta V^e\\"
        r"\delta V^{up}\end{pmatrix}",
    ),
    Equation(
        "3",
        "Velocity error",
        r"\begin{pmatrix}\delta\dot V^e\\\delta\dot V^n\\\delta\dot V^{up}\end{pmatrix}=\begin{pmatrix}a^{od}\cos(A)\cos(p)&\sin(A)\cos(p)"
        r"&0\\-a^{od}\sin(A)\cos(p)&\cos(A)\cos(p)&0\\0&\sin(p)&0\end{pmatrix}"
        r"\begin{pmatrix}\delta A\\\delta od\\\delta\omega^z\end{pmatrix}",
        "wrong",
        r"Differentiating $V\sin A\cos p$ gives two further terms, of the turn (E8), which a turn at 6 m/s and 40 deg/s makes larger than "
        r"the term that is printed. $\delta od$ is an error of acceleration here and of speed in (1) (A2). The printed form is run, as the "
        "paper's; a variant adds the terms.",
        f"{_RISS}::test_the_printed_velocity_error_leaves_out_the_turn",
        corrected=r"\delta\dot V^e=(a^{od}\cos A-V\dot A\sin A)\cos p\,\delta A+V\cos A\cos p\,\delta\dot A-\sin A\cos p\,\delta d,\quad "
        r"\delta\dot V^n=-(a^{od}\sin A+V\dot A\cos A)\cos p\,\delta A-V\sin A\cos p\,\delta\dot A-\cos A\cos p\,\delta d,\quad "
        r"\delta\dot V^{up}=-\sin p\,\delta d",
    ),
    Equation(
        "4",
        "Azimuth error",
        r"\delta\dot A=\cos(p)\cos(r)\,\delta\omega^z",
        "ambiguous",
        r"The sign depends on what $\delta\omega^z$ is, which is not said (B4): plus for a bias state that is subtracted from a z-up gyro, "
        r"minus for the error of that gyro itself. White noise of the gyro is missing (E9); (1) has no $\cos p\cos r$, 0.2 % at a slope "
        "of 6 %.",
        f"{_RISS}::test_the_azimuth_follows_the_gyro_bias_with_the_sign_of_a_state_that_is_subtracted",
        corrected=r"\delta\dot A=\cos p\cos r\,\delta b+w_A",
    ),
    Equation(
        "5",
        "Odometer error",
        r"\delta\dot{od}=-\gamma\,\delta od+\sqrt{2\gamma\sigma_{od}^2}\,W",
        "ok",
        r"$\gamma$ and $\sigma_{od}$ are not printed (A3). The unit is that of acceleration in the error-state filter and of speed in the "
        "total-state one.",
        f"{_RISS}::test_gauss_markov_states_decay_and_keep_their_variance",
        corrected=r"d_{k+1}=e^{-\gamma\Delta t}d_k,\quad q=2\gamma\sigma_{od}^2\Delta t",
    ),
    Equation(
        "6",
        "Gyro error",
        r"\delta\dot\omega^z=-\beta\,\delta\omega^z+\sqrt{2\beta\sigma_{\omega^z}^2}\,W",
        "ok",
        r"$\beta$ and $\sigma_{\omega^z}$ are not printed (A3). Decay is exact, the variance of a step of first order in it (B3).",
        f"{_RISS}::test_gauss_markov_states_decay_and_keep_their_variance",
        corrected=r"b_{k+1}=e^{-\beta\Delta t}b_k,\quad q=2\beta\sigma_{\omega^z}^2\Delta t",
    ),
)

_EKF = (
    Equation(
        "7",
        "Predicted error state",
        r"\hat X_k^-=A\hat X_{k-1}",
        "ambiguous",
        "The text says that the output is fed back, not how. After feedback the error state is zero, and so is its prediction; what is fed "
        "back to which quantity decides the baseline (A1). Here the state itself is carried and propagated.",
        f"{_MODELS}::test_a_small_error_propagates_as_the_transition_says",
        corrected=r"\hat X_k^-=0\ \mathrm{after\ feedback},\quad \hat x_k^-=f(\hat x_{k-1},u_k)",
    ),
    Equation(
        "8",
        "Predicted covariance",
        r"P_k^-=AP_{k-1}A^T+Q",
        "ambiguous",
        r"$A$ is said to hold (2)-(6), which are rates: used as a transition these forget every error they do not feed. $I+F\Delta t$ is "
        "used, and $Q$ is per step of 0.05 s.",
        f"{_MODELS}::test_the_transition_is_unity_plus_the_error_model_times_the_step",
        corrected=r"P_k^-=\Phi P_{k-1}\Phi^T+Q,\quad \Phi=I+F\Delta t",
    ),
    Equation("9", "Gain", r"K_k=P_k^-H^T(HP_k^-H^T+R)^{-1}", "ok", r"$H=[I_6\ 0]$; $R$ is what the receiver reports (A14).", _TEXTBOOK),
    Equation(
        "10",
        "Updated error state",
        r"\hat X_k=\hat X_k^-+K_k(Z_k-H\hat X_k^-)",
        "ambiguous",
        r"The state is an error, yet $Z$ is said to be the vector received from the GPS. For an error state it is a difference of RISS and "
        "GPS; which minus which is not said.",
        f"{_MODELS}::test_feedback_of_the_error_state_is_the_update_of_the_state",
        corrected=r"\hat x_k=\hat x_k^-+K_k(z_k-H\hat x_k^-),\quad z_k=[N\ E\ h\ V^e\ V^n\ V^{up}]_{GPS}^T",
    ),
    Equation(
        "11",
        "Updated covariance",
        r"P_k=(I-K_kH)P_k^-",
        "ok",
        "Right at the optimal gain only; the Joseph form is used.",
        _TEXTBOOK,
        corrected=r"P_k=(I-K_kH)P_k^-(I-K_kH)^T+K_kRK_k^T",
    ),
)

_TUNING = (
    Equation(
        "12",
        "Self-tuned Q",
        r"Q(i,j)=\begin{cases}avg(S_{ref}-S_{RISS}),&\text{if }i=j\\0,&\text{otherwise}\end{cases}",
        "wrong",
        "A mean with its sign is no variance: it can be negative or cancel, and has the unit of the state (E10). The drift of a whole "
        "drive becomes the noise of one step (E11), and a mean of 100 m in latitude acts as a deviation of 25 km (Prop6). The "
        "reference is the truth that the filter is judged by (E12). Every level of A9 is run.",
        f"{_SELF_TUNING}::test_the_signed_mean_of_an_error_is_no_variance",
        corrected=r"Q_{ii}=s\,\mathrm{avg}\left((S_{ref}-S_{RISS})_i^2\right),\ i\le 7,\quad s\in\{1,10^{-2},\dots,10^{-10}\}",
    ),
    Equation(
        "13",
        "Self-tuned P0",
        r"P_0(i,j)=\begin{cases}avg(S_{ref}-S_{RISS/GPS}),&\text{if }i=j\\0,&\text{otherwise}\end{cases}",
        "wrong",
        "As (12) (E10). Gyro bias and odometer have no reference: they keep the values of the data sheet (A10). The result of a run is "
        "needed before the run can start.",
        f"{_SELF_TUNING}::test_states_without_a_reference_keep_the_variance_of_the_data_sheet",
        corrected=r"P_{0,ii}=\mathrm{avg}\left((S_{ref}-S_{RISS/GPS})_i^2\right),\ i\le 7",
    ),
)

EQUATIONS: tuple[Equation, ...] = (*_MECHANISATION, *_EKF, *_TUNING)
"""Equations (1)-(13), in the paper's order."""
