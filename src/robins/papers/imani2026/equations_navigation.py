"""Equations (1)-(22): sensors, mechanisation, state and prediction, as printed and as they are used here.

Names such as E1, A1 and Prop1 are those of `register`. The text of the paper that was available has lost every minus sign,
transpose and root; printed forms carry those that cannot be otherwise. In corrected forms C is C_b^n, body to
navigation (ENU) frame, the error state is ``C = \\hat C exp([delta theta x])``, and ``\\phi = e^{-dt/tau}``.
"""

from robins.papers.protocol import Equation

_INTERFEROMETER = "tests/navigation/test_interferometer.py"
_STRAPDOWN = "tests/navigation/test_strapdown.py"
_FORMULATIONS = "tests/papers/imani2026/test_formulations.py"

_VELOCITY = f"{_STRAPDOWN}::test_velocity_follows_specific_force_coriolis_and_gravity"
_ATTITUDE = f"{_STRAPDOWN}::test_leaving_out_the_earth_rate_turns_the_attitude_by_it"
_TRANSIENT = f"{_STRAPDOWN}::test_a_transient_decays_with_its_time_constant"
_INJECTED = f"{_STRAPDOWN}::test_transients_add_to_specific_force_and_rate"

_SENSORS = (
    Equation(
        "1",
        "Phase of an accelerated interferometer",
        r"\Delta\Phi=k_{\mathrm{eff}}\,a\,T^2",
        "ok",
        r"$T$ is the time between two pulses; only the acceleration along $\mathbf k_{\mathrm{eff}}$ counts.",
        f"{_INTERFEROMETER}::test_the_phase_is_that_of_three_laser_phases_read_along_a_parabola",
        corrected=r"\Delta\Phi=\mathbf k_{\mathrm{eff}}\cdot\mathbf a\,T^2",
    ),
    Equation(
        "2",
        "Sagnac phase",
        r"\Delta\Phi=\frac{4\pi A\Omega}{\lambda v}",
        "ok",
        r"$\lambda$ is the de Broglie wavelength $h/(mv)$, so it is the same as $2mA\Omega/\hbar$.",
        f"{_INTERFEROMETER}::test_the_sagnac_phase_of_a_matter_wave_is_two_m_a_omega_over_hbar",
    ),
    Equation(
        "3",
        "Position",
        r"\dot{\mathbf r}^n=\mathbf v^n",
        "ok",
        "Metres in the local tangent frame, although the text also speaks of latitude, longitude and altitude (A8).",
        f"{_STRAPDOWN}::test_position_is_the_integral_of_velocity",
    ),
    Equation(
        "4",
        "Velocity",
        r"\dot{\mathbf v}^n=C_b^n\mathbf f_{ib}^b-(2\boldsymbol\omega_{ie}^n+\boldsymbol\omega_{en}^n)\times\mathbf v^n+\mathbf g^n",
        "ok",
        r"The sign before the Coriolis term is lost in the available text; in ENU $\mathbf g^n=[0,0,-g]^T$.",
        _VELOCITY,
    ),
    Equation(
        "5",
        "Attitude",
        r"\dot C_b^n=C_b^n[\boldsymbol\omega_{ib}^b\times]",
        "wrong",
        r"The rotation of the navigation frame is left out: the Earth's rate alone turns the attitude by 1.4 deg in 330 s (E1).",
        _ATTITUDE,
        corrected=r"\dot C_b^n=C_b^n[\boldsymbol\omega_{ib}^b\times]-[\boldsymbol\omega_{in}^n\times]C_b^n,\quad "
        r"\boldsymbol\omega_{in}^n=\boldsymbol\omega_{ie}^n+\boldsymbol\omega_{en}^n",
    ),
    Equation(
        "6",
        "Phase with rotation",
        r"\Delta\Phi=\frac14 k_{\mathrm{eff}}\,a\,T^2+\frac12(\boldsymbol\omega\times\mathbf v)\,k_{\mathrm{eff}}T^2",
        "ambiguous",
        r"Agrees with (1) if $T$ is the whole interrogation time, twice the time $T_\pi$ between pulses; the text says between pulses, "
        "which is wrong by a factor of four (E11). The dot product and the order of the cross product are not settled in print.",
        f"{_INTERFEROMETER}::test_the_two_phase_equations_agree_when_t_is_the_whole_interrogation_time",
        corrected=r"\Delta\Phi=\frac14\mathbf k_{\mathrm{eff}}\cdot\mathbf a\,T^2+\frac12\mathbf k_{\mathrm{eff}}\cdot"
        r"(\boldsymbol\omega\times\mathbf v)\,T^2,\quad T=2T_\pi",
    ),
)

_TRANSIENTS = (
    Equation(
        "7",
        "Transient state",
        r"\dot{\mathbf x}_{tr}=\frac1\tau\mathbf x_{tr}+\mathbf u(t)",
        "ambiguous",
        "With plus it grows, while the text says that it decays; the minus may be lost in the available text only (A1).",
        _TRANSIENT,
        corrected=r"\dot{\mathbf x}_{tr}=-\frac1\tau\mathbf x_{tr}+\mathbf u(t),\quad \varphi=e^{-\Delta t/\tau}",
    ),
    Equation(
        "8",
        "Specific force with its transient",
        r"\mathbf f_{ib,mod}=\mathbf f_{ib}^b+\mathbf x_{tr,f}",
        "ambiguous",
        r"A measured $\mathbf f_{ib}^b$ already holds every true transient, and $\mathbf x_{tr}$ is not in the state (15) (E12). Here the "
        "nominal force is the reaction to gravity and the transient is a state (F1).",
        _INJECTED,
        corrected=r"\mathbf f_{ib}^b=-C^T\mathbf g^n+\mathbf x_f",
    ),
    Equation(
        "9",
        "Angular rate with its transient",
        r"\boldsymbol\omega_{ib,mod}=\boldsymbol\omega_{ib}^b+\mathbf x_{tr,\omega}",
        "ambiguous",
        "As (8); here the nominal rate is that of the navigation frame.",
        _INJECTED,
        corrected=r"\boldsymbol\omega_{ib}^b=C^T\boldsymbol\omega_{in}^n+\mathbf x_\omega",
    ),
    Equation(
        "10",
        "System with Gaussian noise",
        r"\dot{\mathbf x}(t)=f(\mathbf x,t)+\mathbf w(t)",
        "ok",
        "",
        f"{_FORMULATIONS}::test_process_noise_enters_the_states_that_q_gives_it",
    ),
    Equation(
        "11",
        "System with non-Gaussian noise",
        r"\dot{\mathbf x}(t)=f(\mathbf x,t)+\mathbf w_g(t)+\mathbf w_{ng}(t)",
        "ambiguous",
        "Laplace and alpha-stable laws are mentioned, no parameter is given. The two published moments of the gyro residuals decide the "
        "law used here, and it acts on the sensors (S4).",
        f"{_FORMULATIONS}::test_process_noise_enters_the_states_that_q_gives_it",
    ),
    Equation(
        "12",
        "Position with noise",
        r"\dot{\mathbf r}^n=\mathbf v^n+\mathbf w_g^r+\mathbf w_{ng}^r",
        "ok",
        "No noise is given to the position here, as in (22).",
        f"{_STRAPDOWN}::test_position_is_the_integral_of_velocity",
    ),
    Equation(
        "13",
        "Velocity with transient and noise",
        r"\dot{\mathbf v}^n=C_b^n(\mathbf f_{ib}^b+\mathbf x_{tr,f})-(2\boldsymbol\omega_{ie}^n+\boldsymbol\omega_{en}^n)\times\mathbf v^n"
        r"+\mathbf g^n+\mathbf w_g^v+\mathbf w_{ng}^v",
        "ambiguous",
        "As (4) and (8): with the force that the sensor measures, the transient is counted twice.",
        _VELOCITY,
        corrected=r"\dot{\mathbf v}^n=C\,\mathbf x_f-(2\boldsymbol\omega_{ie}^n+\boldsymbol\omega_{en}^n)\times\mathbf v^n+\mathbf w^v",
    ),
    Equation(
        "14",
        "Attitude with transient and noise",
        r"\dot C_b^n=C_b^n[(\boldsymbol\omega_{ib}^b+\mathbf x_{tr,\omega})\times]+\mathbf w_g^C+\mathbf w_{ng}^C",
        "wrong",
        "As (5) the frame's rotation is missing (E1), and noise that is added to a rotation matrix leaves the rotations (A9).",
        _ATTITUDE,
        corrected=r"\dot C=C[\mathbf x_\omega\times],\quad C=\hat C\exp([\delta\boldsymbol\theta\times])",
    ),
)

_STATE = (
    Equation(
        "15",
        "State",
        r"\mathbf x=[\mathbf r\ \mathbf v\ \mathbf q\ \mathbf b_a\ \mathbf b_g]^T",
        "ambiguous",
        "Neither acceleration nor angular rate is in it, yet both are called estimates and scored. In F1 they are states; in F0 and F2 "
        "they are the sample less its bias, turned into ENU (S2).",
        f"{_FORMULATIONS}::test_each_formulation_has_the_states_that_it_says",
        corrected=r"\mathbf x=[\mathbf r\ \mathbf v\ \mathbf q\ \mathbf b_a\ \mathbf b_g\ \mathbf x_f\ \mathbf x_\omega]^T",
    ),
    Equation(
        "16",
        "Measurement",
        r"\mathbf z_k=[\mathbf a_{meas}\ \boldsymbol\omega_{meas}]^T=h(\mathbf x_k)+\mathbf v_k",
        "ambiguous",
        r"The sample that is compared here is the sample that has already driven the prediction as $\mathbf u_k$ (Prop1).",
        f"{_FORMULATIONS}::test_the_innovation_of_a_sample_that_predicts_itself_is_exactly_zero",
    ),
    Equation(
        "17",
        "Measurement function",
        r"h(\mathbf x_k)=[\mathbf f_{ib,k}^b+\mathbf b_{a,k}\ \ \boldsymbol\omega_{ib,k}^b+\mathbf b_{g,k}]^T",
        "wrong",
        r"Force and rate are no functions of the state (15), and specific force is not gravity-compensated as the text says (E2). With the "
        "bias-corrected sample put in, the innovation is zero (Prop1); F0 puts in the vehicle at rest.",
        f"{_FORMULATIONS}::test_the_quasi_static_measurement_is_gravity_and_frame_rate_in_body_axes",
        corrected=r"h(\mathbf x)=[-C^T\mathbf g^n+\mathbf x_f+\mathbf b_a\ \ C^T\boldsymbol\omega_{in}^n+\mathbf x_\omega+\mathbf b_g]^T,"
        r"\quad \mathbf x_f=\mathbf x_\omega=0\ \mathrm{in\ F0}",
    ),
)

_PREDICTION = (
    Equation(
        "18",
        "Discrete system",
        r"\mathbf x_{k+1}=f(\mathbf x_k,\mathbf u_k)+\mathbf w_k",
        "ok",
        r"What $\mathbf u_k$ is follows from the formulation: the sample itself in F0, nothing in F1, a second sensor in F2 (S1).",
        f"{_FORMULATIONS}::test_a_step_of_the_truth_is_a_step_of_the_model",
    ),
    Equation(
        "19",
        "Predicted state",
        r"\hat{\mathbf x}_{k+1}^-=f(\hat{\mathbf x}_k,\mathbf u_k)",
        "ok",
        r"The text calls $\hat{\mathbf x}_k$ a priori; it must be the estimate after the update.",
        f"{_FORMULATIONS}::test_a_step_of_the_truth_is_a_step_of_the_model",
    ),
    Equation(
        "20",
        "Predicted covariance",
        r"P_{k+1}^-=F_kP_kF_k^T+Q_k",
        "ok",
        "Right with the transition matrix of the discrete system, which (21) is not.",
        f"{_FORMULATIONS}::test_the_printed_jacobian_used_as_a_transition_forgets_the_covariance",
    ),
    Equation(
        "21",
        "Jacobian",
        r"F_k=\begin{pmatrix}0&I&0&0&0\\0&-2C^T[\omega\times]&\partial(C^Ta)/\partial q&-C^T&-2C^T[v\times]\\"
        r"0&0&\frac12\partial(Q(q)(\omega-b_g))/\partial q&0&-\frac12Q(q)\\0&0&0&0&0\\0&0&0&0&0\end{pmatrix}",
        "wrong",
        "This is the Jacobian of the continuous-time system: used as a transition in (20) it replaces position by velocity and forgets "
        "velocity, biases and their covariance. Its Coriolis terms hold the body rate instead of the Earth's (E3).",
        f"{_FORMULATIONS}::test_the_printed_jacobian_used_as_a_transition_forgets_the_covariance",
        corrected=r"F=I+A\,\Delta t,\quad A_{rv}=I,\ A_{v\theta}=-\hat C[\hat f\times],\ A_{vb_a}=-\hat C,\ "
        r"A_{\theta\theta}=-[\hat\omega\times],\ A_{\theta b_g}=-I,\ A_{vv}=-[(2\omega_{ie}+\omega_{en})\times]",
    ),
    Equation(
        "22",
        "Process noise",
        r"Q_k=\mathrm{diag}(0,\ \sigma_v^2I_3,\ \sigma_q^2I_4,\ \sigma_{b_a}^2I_3,\ \sigma_{b_g}^2I_3)",
        "ambiguous",
        r"$\sigma_v$ is printed in m/s$^2$ in the place of a velocity, and per step or per second is not said (E4). Three readings are "
        "kept: `printed` (per step), `printed-dt` and `tuned` (S6).",
        f"{_FORMULATIONS}::test_the_three_readings_of_the_process_noise",
        corrected=r"Q_k=\mathrm{diag}(0,\ \sigma_v^2\Delta t^2I_3,\ 4\sigma_q^2\Delta t\,I_3,\ \sigma_{b_a}^2\Delta t\,I_3,\ "
        r"\sigma_{b_g}^2\Delta t\,I_3)",
    ),
)

EQUATIONS: tuple[Equation, ...] = (*_SENSORS, *_TRANSIENTS, *_STATE, *_PREDICTION)
"""Equations (1)-(22), in the paper's order."""
