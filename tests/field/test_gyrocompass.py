"""The gyrocompass on a unit whose attitude is known: another package's rotation of the spin axis, and noise-free sensors."""

import numpy as np
import pymap3d
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robins.field.gyrocompass import gyrocompass

SPIN = 7.292115e-5
GRAVITY = 9.8


def unit_at_rest(heading, latitude, pitch=0.0, roll=0.0, spin=SPIN):
    """Rate and specific force in right-forward-up of a unit turned clockwise by `heading`, then pitched up and rolled right.

    The spin axis is carried from earth-centred coordinates to east-north-up by pymap3d and into the body by scipy.
    """
    rate_n = np.array(pymap3d.ecef2enuv(0.0, 0.0, spin, latitude, 1.9, deg=False))
    body_to_enu = Rotation.from_euler("ZXY", [-heading, pitch, roll])
    rate_b, force_b = body_to_enu.inv().apply([rate_n, [0.0, 0.0, GRAVITY]])
    return rate_b[None, :], force_b[None, :]


ANGLES = st.floats(-np.pi + 0.01, np.pi - 0.01)


def heading_is_recovered(heading, latitude, **attitude):
    alignment = gyrocompass(*unit_at_rest(heading, latitude, **attitude))
    return abs((alignment.heading - heading + np.pi) % (2 * np.pi) - np.pi) < 1e-9


@given(heading=ANGLES, latitude=st.floats(-1.4, 1.4))
def test_heading_of_a_level_unit_is_the_one_it_was_turned_to(heading, latitude):
    assert heading_is_recovered(heading, latitude)


@given(heading=ANGLES, pitch=st.floats(-0.3, 0.3), roll=st.floats(-0.3, 0.3))
def test_tilt_does_not_change_the_heading(heading, pitch, roll):
    # pitch turns forward within its vertical plane and roll turns about forward: neither moves its heading
    assert heading_is_recovered(heading, 0.6, pitch=pitch, roll=roll)


def test_negating_the_earth_rate_turns_the_heading_round_and_makes_the_check_fail():
    assert heading_is_recovered(0.7, 0.6)
    assert not heading_is_recovered(0.7, 0.6, spin=-SPIN)
    reversed_heading = gyrocompass(*unit_at_rest(0.7, 0.6, spin=-SPIN)).heading
    assert reversed_heading == pytest.approx(0.7 - np.pi)


@pytest.mark.parametrize("latitude", [-0.9, 0.2, 0.6])
def test_components_of_the_rate_are_those_of_the_latitude(latitude):
    alignment = gyrocompass(*unit_at_rest(1.1, latitude, pitch=0.1, roll=-0.2))
    assert alignment.up_rate == pytest.approx(SPIN * np.sin(latitude), rel=1e-9)
    assert alignment.horizontal_rate == pytest.approx(SPIN * np.cos(latitude), rel=1e-9)
    assert alignment.specific_force == pytest.approx(GRAVITY)


def test_four_quarters_by_hand():
    # level at the equator the earth turns about north; forward north, east, south, west is 0, 90, 180, 270 degrees
    force = [[0.0, 0.0, GRAVITY]]
    rates = {0: [0, SPIN, 0], 90: [-SPIN, 0, 0], 180: [0, -SPIN, 0], -90: [SPIN, 0, 0]}
    for degrees, rate in rates.items():
        assert np.degrees(gyrocompass([rate], force).heading) == pytest.approx(degrees)


def test_a_bias_along_east_turns_the_heading_by_bias_over_horizontal_earth_rate():
    heading, latitude, bias = 0.4, 0.6, 1e-9
    rate, force = unit_at_rest(heading, latitude)
    east_b = np.array([np.cos(heading), np.sin(heading), 0.0])
    turned = gyrocompass(rate + bias * east_b, force).heading - heading
    assert abs(turned) == pytest.approx(bias / (SPIN * np.cos(latitude)), rel=1e-4)


def test_noise_is_averaged_before_the_length_is_taken():
    rng = np.random.default_rng(1)
    rate, force = unit_at_rest(0.4, 0.6)
    noise = rng.standard_normal((20_000, 3))
    noise -= noise.mean(axis=0)
    alignment = gyrocompass(rate + 1e-3 * noise, force + 0.3 * noise)
    assert alignment.specific_force == pytest.approx(GRAVITY, rel=1e-12)
    assert alignment.heading == pytest.approx(0.4, abs=1e-9)
