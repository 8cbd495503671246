"""The earth against published constants, pymap3d and the exact normal field in ellipsoidal coordinates."""

import numpy as np
import pymap3d
import pytest
from scipy.integrate import quad

from robins.foundation import earth


def exact_normal_gravity(latitude, height):
    """Magnitude of normal gravity from the exact potential of the rotating ellipsoid.

    Closed form in ellipsoidal coordinates (u, beta): Heiskanen and Moritz (1967), eqs. 2-62 and 2-66; independent of
    Somigliana's formula and of the expansion in height. GM, omega, a and f are its only constants.
    """
    a, b, gm, omega = earth.SEMI_MAJOR_AXIS, earth.SEMI_MINOR_AXIS, earth.GRAVITATIONAL_CONSTANT, earth.EARTH_RATE
    focal = np.sqrt(a * a - b * b)
    x, _, z = pymap3d.geodetic2ecef(latitude, 0.0, height, deg=False)
    radius_squared = x * x + z * z
    excess = radius_squared - focal**2
    u = np.sqrt(0.5 * excess * (1.0 + np.sqrt(1.0 + 4.0 * focal**2 * z * z / excess**2)))
    beta = np.arctan2(z * np.sqrt(u * u + focal**2), u * x)
    w = np.sqrt((u * u + focal**2 * np.sin(beta) ** 2) / (u * u + focal**2))

    def q(v):
        return 0.5 * ((1 + 3 * v * v / focal**2) * np.arctan(focal / v) - 3 * v / focal)

    q_prime = 3 * (1 + u * u / focal**2) * (1 - u / focal * np.arctan(focal / u)) - 1
    along_u = (
        gm / (u * u + focal**2)
        + omega**2 * a * a * focal / (u * u + focal**2) * q_prime / q(b) * (0.5 * np.sin(beta) ** 2 - 1 / 6)
        - omega**2 * u * np.cos(beta) ** 2
    )
    along_beta = (
        (omega**2 * a * a / np.sqrt(u * u + focal**2) * q(u) / q(b) - omega**2 * np.sqrt(u * u + focal**2)) * np.sin(beta) * np.cos(beta)
    )
    return np.hypot(along_u, along_beta) / w


def test_derived_constants_are_the_published_ones():
    # NIMA TR8350.2, tables 3.3 and 3.4
    assert earth.SEMI_MINOR_AXIS == pytest.approx(6356752.3142, abs=1e-4)
    assert earth.ECCENTRICITY_SQUARED == pytest.approx(6.69437999014e-3, abs=1e-14)
    # k follows from two gravities rounded to 5e-11 m/s^2, relative 5e-12 each
    assert earth.SOMIGLIANA == pytest.approx(0.00193185265241, abs=1e-11)
    assert earth.GRAVITY_RATIO == pytest.approx(0.00344978650684, abs=1e-14)


def test_ellipsoid_is_that_of_pymap3d():
    ellipsoid = pymap3d.Ellipsoid.from_name("wgs84")
    assert earth.SEMI_MAJOR_AXIS == ellipsoid.semimajor_axis
    assert earth.SEMI_MINOR_AXIS == pytest.approx(ellipsoid.semiminor_axis, abs=1e-6)


@pytest.mark.parametrize("latitude", np.radians([-90.0, -51.0, 0.0, 34.246048, 60.0, 89.9]))
def test_radii_of_curvature_are_those_of_pymap3d(latitude):
    assert earth.meridian_radius(latitude) == pytest.approx(pymap3d.rcurve.meridian(latitude, deg=False), rel=1e-13)
    assert earth.transverse_radius(latitude) == pytest.approx(pymap3d.rcurve.transverse(latitude, deg=False), rel=1e-13)


def test_radii_of_curvature_move_a_point_as_far_as_its_cartesian_coordinates_say():
    latitude, height, step = np.radians(47.0), 1200.0, 1e-6

    def position(north, east):
        return np.array(pymap3d.geodetic2ecef(latitude + north, east, height, deg=False))

    northward = np.linalg.norm(position(step, 0) - position(-step, 0)) / (2 * step)
    eastward = np.linalg.norm(position(0, step) - position(0, -step)) / (2 * step)
    assert northward == pytest.approx(earth.meridian_radius(latitude) + height, rel=1e-8)
    assert eastward == pytest.approx((earth.transverse_radius(latitude) + height) * np.cos(latitude), rel=1e-8)


def test_gravity_at_equator_and_pole_is_the_published_one():
    assert earth.normal_gravity(0.0, 0.0) == pytest.approx(9.7803253359, abs=1e-10)
    assert earth.normal_gravity(np.pi / 2, 0.0) == pytest.approx(9.8321849378, abs=1e-10)


def test_mean_gravity_over_the_ellipsoid_is_the_published_one():
    def area(latitude):
        return earth.meridian_radius(latitude) * earth.transverse_radius(latitude) * np.cos(latitude)

    weighted = quad(lambda latitude: area(latitude) * earth.normal_gravity(latitude, 0.0), 0, np.pi / 2)[0]
    assert weighted / quad(area, 0, np.pi / 2)[0] == pytest.approx(9.7976432222, abs=1e-9)  # TR8350.2, table 3.4


@pytest.mark.parametrize("latitude", np.radians([-89.0, -40.0, 1.0, 34.246048, 70.0]))
@pytest.mark.parametrize("height", [0.0, 380.0, 10_000.0])
def test_gravity_is_the_gradient_of_the_exact_normal_potential(latitude, height):
    # the expansion stops after the square of the height: what it leaves out is below 1e-6 m/s^2 at 10 km
    assert earth.normal_gravity(latitude, height) == pytest.approx(exact_normal_gravity(latitude, height), abs=1e-6)


def test_earth_rate_in_east_north_up_is_the_spin_axis_turned_there_by_pymap3d():
    latitude, longitude = np.radians(34.246048), np.radians(108.909664)
    east, north, up = pymap3d.ecef2enuv(0.0, 0.0, earth.EARTH_RATE, latitude, longitude, deg=False)
    np.testing.assert_allclose(earth.earth_rate_n(latitude), [east, north, up], atol=1e-19)


def test_earth_turns_once_against_the_stars_in_a_sidereal_day():
    assert 2 * np.pi / earth.EARTH_RATE == pytest.approx(86164.1, abs=0.1)


def test_arrays_give_what_their_elements_give():
    latitudes, heights = np.radians([0.0, 30.0, -60.0]), np.array([0.0, 100.0, 9000.0])
    expected = [earth.normal_gravity(latitude, height) for latitude, height in zip(latitudes, heights, strict=True)]
    np.testing.assert_array_equal(earth.normal_gravity(latitudes, heights), expected)
    np.testing.assert_array_equal(earth.meridian_radius(latitudes), [earth.meridian_radius(value) for value in latitudes])
