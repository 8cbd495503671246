"""Linear small-disturbance models of an aircraft.

State ``[u w q theta | beta p r phi]``: forward and vertical velocity (m/s), pitch rate (rad/s) and angle
(rad) in stability axes; sideslip (rad), roll and yaw rate (rad/s) and roll angle (rad) in body axes
(x forward, y right, z down). Inputs: elevator, aileron, rudder (rad). The longitudinal and the lateral
block do not couple, so the two axis systems do no harm together.

Reference: Cook 2013, Flight Dynamics Principles, chapter 4 (equations of motion in matrix form).
"""

import numpy as np
from scipy.linalg import block_diag, expm

STATES = ("u", "w", "q", "theta", "beta", "p", "r", "phi")
ANGULAR = np.array([False, False, True, True, True, True, True, True])
GRAVITY = 9.81
"""m/s^2, the value that the substitute's longitudinal matrix was printed with."""


def lateral_matrices(derivatives: dict) -> tuple[np.ndarray, np.ndarray]:
    """State and input matrix ``(4, 4)``, ``(4, 2)`` of [beta p r phi] from dimensionless body-axis derivatives.

    Parameters
    ----------
    derivatives : dict
        ``rho`` kg/m^3, ``V0`` m/s, ``theta_e`` rad, ``mass`` kg, ``Ix Iz Ixz`` kg m^2, ``S`` m^2, ``b`` m and the
        derivatives ``Yv Lv Nv Yp Lp Np Yr Lr Nr``, ``aileron`` and ``rudder`` (each [Y, L, N]), British convention.
    """
    d = derivatives
    pressure = 0.5 * d["rho"] * d["V0"] * d["S"]  # rho V0 S / 2: forces per unit velocity
    Ue, We = d["V0"] * np.cos(d["theta_e"]), d["V0"] * np.sin(d["theta_e"])
    inertia = np.array([[d["mass"], 0, 0], [0, d["Ix"], -d["Ixz"]], [0, -d["Ixz"], d["Iz"]]])
    b = d["b"]
    forces = np.array([
        [pressure * d["Yv"], pressure * b * d["Yp"] + d["mass"] * We, pressure * b * d["Yr"] - d["mass"] * Ue],
        [pressure * b * d["Lv"], pressure * b**2 * d["Lp"], pressure * b**2 * d["Lr"]],
        [pressure * b * d["Nv"], pressure * b**2 * d["Np"], pressure * b**2 * d["Nr"]],
    ])  # fmt: skip
    control = np.column_stack([d["aileron"], d["rudder"]]) * pressure * d["V0"] * np.array([[1.0], [b], [b]])
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    A[:3, :3], B[:3] = np.linalg.solve(inertia, forces), np.linalg.solve(inertia, control)
    A[0, 3] = GRAVITY * np.cos(d["theta_e"])
    A[3, 1], A[3, 2] = 1.0, np.tan(d["theta_e"])
    to_sideslip = np.array([1 / d["V0"], 1.0, 1.0, 1.0])  # beta = v / V0
    return A * to_sideslip[:, None] / to_sideslip[None, :], B * to_sideslip[:, None]


def continuous_matrices(plant: dict, pitch_damping: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Continuous ``A`` ``(8, 8)`` and ``B`` ``(8, 3)`` of a plant; `pitch_damping` replaces M_q (1/s) when given."""
    A_longitudinal = np.array(plant["longitudinal"]["A"], float)
    if pitch_damping is not None:
        A_longitudinal[2, 2] = pitch_damping
    A_lateral, B_lateral = lateral_matrices(plant["lateral"])
    B_longitudinal = np.array(plant["longitudinal"]["B"], float).reshape(4, 1)
    return block_diag(A_longitudinal, A_lateral), block_diag(B_longitudinal, B_lateral)


def discretise(A: np.ndarray, B: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Zero-order hold over `dt` seconds: ``exp([[A, B], [0, 0]] dt)`` gives both discrete matrices at once."""
    n, inputs = B.shape
    block = np.zeros((n + inputs, n + inputs))
    block[:n, :n], block[:n, n:] = A, B
    discrete = expm(block * dt)
    return np.ascontiguousarray(discrete[:n, :n]), np.ascontiguousarray(discrete[:n, n:])
