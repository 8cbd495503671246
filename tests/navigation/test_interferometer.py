"""Phases of an atom interferometer, against positions of free atoms at the three pulses."""

import numpy as np
import pytest
from scipy.constants import hbar, physical_constants
from scipy.spatial.transform import Rotation

from robins.navigation.interferometer import acceleration_phase, de_broglie_wavelength, interferometer_phase, sagnac_phase

RUBIDIUM = 86.909180527 * physical_constants["atomic mass constant"][0]
K_EFF = 4.0 * np.pi / 780.241e-9 * np.array([0.6, 0.0, 0.8])
T_PI = 0.02


def second_difference(position):
    """Phases of the light where the atoms are at the three pulses, as the interferometer combines them; `position` of a time."""
    return K_EFF @ (position(0.0) - 2.0 * position(T_PI) + position(2.0 * T_PI))


def test_the_phase_is_that_of_three_laser_phases_read_along_a_parabola():
    """Equation (1): whatever position and velocity the atoms begin with."""
    start, velocity, acceleration = np.array([0.01, 0.02, -0.01]), np.array([0.3, -0.1, 0.2]), np.array([0.5, 7.0, -9.8])
    expected = second_difference(lambda t: start + velocity * t + 0.5 * acceleration * t**2)
    assert acceleration_phase(K_EFF, acceleration, T_PI) == pytest.approx(expected, rel=1e-9)
    along = acceleration_phase(K_EFF, 2.0 * K_EFF / np.linalg.norm(K_EFF), T_PI)
    assert along == pytest.approx(2.0 * np.linalg.norm(K_EFF) * T_PI**2, rel=1e-14)


def test_only_the_acceleration_along_the_light_counts():
    across = np.cross(K_EFF, [0.0, 1.0, 0.0]) / np.linalg.norm(K_EFF)
    assert abs(acceleration_phase(K_EFF, across, T_PI)) < 1e-12 * np.linalg.norm(K_EFF) * T_PI**2


def test_the_sagnac_phase_of_a_matter_wave_is_two_m_a_omega_over_hbar():
    """Equation (2) with the de Broglie wavelength, to 1e-12."""
    area, rate, speed = np.array([1e-6, 2e-5, 3e-5]), np.array([0.3, -0.2, 0.59]), 2.8
    phase = sagnac_phase(area, rate, de_broglie_wavelength(RUBIDIUM, speed), speed)
    assert phase == pytest.approx(2.0 * RUBIDIUM * area @ rate / hbar, rel=1e-12)


def test_the_sagnac_phase_of_atoms_does_not_depend_on_their_speed():
    area, rate = np.array([0.0, 0.0, 1e-5]), np.array([0.0, 0.0, 0.1])
    slow, fast = (sagnac_phase(area, rate, de_broglie_wavelength(RUBIDIUM, speed), speed) for speed in (0.1, 290.0))
    assert slow == pytest.approx(fast, rel=1e-14)


def test_the_two_phase_equations_agree_when_t_is_the_whole_interrogation_time():
    """Equation (6) with T = 2 T_pi and no rotation is equation (1)."""
    acceleration, velocity, still = np.array([1.0, 2.0, -9.8]), np.array([0.3, 0.1, 2.8]), np.zeros(3)
    expected = acceleration_phase(K_EFF, acceleration, T_PI)
    assert interferometer_phase(K_EFF, acceleration, still, velocity, 2.0 * T_PI) == pytest.approx(expected, rel=1e-15)


def test_the_time_between_pulses_in_the_second_equation_is_wrong_by_four():
    """As the text around equation (6) reads: T is the interrogation time between the light pulses."""
    acceleration, rate, velocity = np.array([1.0, 2.0, -9.8]), np.array([0.3, -0.2, 0.59]), np.array([0.3, 0.1, 2.8])
    as_printed, right = (interferometer_phase(K_EFF, acceleration, rate, velocity, T) for T in (T_PI, 2.0 * T_PI))
    assert right == pytest.approx(4.0 * as_printed, rel=1e-15)
    still = interferometer_phase(K_EFF, acceleration, np.zeros(3), velocity, T_PI)
    assert acceleration_phase(K_EFF, acceleration, T_PI) == pytest.approx(4.0 * still, rel=1e-15)


def test_a_turning_instrument_sees_free_atoms_turn_the_other_way():
    """Independent: a straight line in inertial space, read in axes that turn by Omega; the phase has second-order terms in Omega T."""
    omega, velocity = np.array([2e-4, -3e-4, 4e-4]), np.array([1.0, -2.0, 0.5])

    def position(t):
        """In the instrument; the atoms start at its origin, so `velocity` is their velocity in it as well."""
        return Rotation.from_rotvec(-omega * t).apply(velocity * t)

    phase = interferometer_phase(K_EFF, np.zeros(3), -omega, velocity, 2.0 * T_PI)
    assert abs(phase) > 1.0
    assert phase == pytest.approx(second_difference(position), rel=1e-4)


def test_the_rotation_phase_is_the_sagnac_phase_of_the_area_that_the_arms_enclose():
    """The arms separate by the recoil hbar k / m for T_pi and drift with v: A = v x (hbar k / m) T_pi^2."""
    rate, velocity = np.array([1e-4, 2e-4, -7e-5]), np.array([1.0, -2.0, 0.5])
    speed = np.linalg.norm(velocity)
    area = np.cross(velocity, hbar * K_EFF / RUBIDIUM) * T_PI**2
    sagnac = sagnac_phase(area, rate, de_broglie_wavelength(RUBIDIUM, speed), speed)
    assert abs(sagnac) > 1.0
    assert interferometer_phase(K_EFF, np.zeros(3), rate, velocity, 2.0 * T_PI) == pytest.approx(sagnac, rel=1e-12)


def test_a_record_of_accelerations_gives_a_record_of_phases():
    rng = np.random.default_rng(1)
    acceleration, rate, velocity = rng.normal(size=(5, 3)), rng.normal(size=(5, 3)), rng.normal(size=3)
    area = rng.normal(size=3)
    np.testing.assert_allclose(acceleration_phase(K_EFF, acceleration, T_PI), [K_EFF @ a * T_PI**2 for a in acceleration], rtol=1e-14)
    for k, phase in enumerate(interferometer_phase(K_EFF, acceleration, rate, velocity, 0.1)):
        assert phase == pytest.approx(interferometer_phase(K_EFF, acceleration[k], rate[k], velocity, 0.1), rel=1e-12)
    for k, phase in enumerate(sagnac_phase(area, rate, 1e-9, 1.0)):
        assert phase == pytest.approx(sagnac_phase(area, rate[k], 1e-9, 1.0), rel=1e-13)
