"""Makes sun_pvlib.csv: 1,000 seeded dates of 1950-2050 and places over the globe, with the sun as pvlib sees it.

pip install pvlib==0.16.1; python make_sun_pvlib.py > sun_pvlib.csv

Elevation is geometric and topocentric at sea level, without refraction; azimuth clockwise from true north; degrees.
delta_t is given to pvlib by the year, after Espenak and Meeus 2006 as in F. Espenak's Five Millennium Canon.
"""
import calendar
import math
import random

import numpy as np
from pvlib import spa


def delta_t_s(year):
    t = year - 1950
    if year < 1961:
        return 29.07 + 0.407 * t - t**2 / 233 + t**3 / 2547
    t = year - 1975
    if year < 1986:
        return 45.45 + 1.067 * t - t**2 / 260 - t**3 / 718
    t = year - 2000
    if year < 2005:
        return 63.86 + 0.3345 * t - 0.060374 * t**2 + 0.0017275 * t**3 + 0.000651814 * t**4 + 0.00002373599 * t**5
    return 62.92 + 0.32217 * t + 0.005589 * t**2


rng = random.Random(20260101)
first = calendar.timegm((1950, 1, 1, 0, 0, 0))
last = calendar.timegm((2050, 1, 1, 0, 0, 0))
print("unix_s,lat_deg,lon_deg,azimuth_deg,elevation_deg")
for _ in range(1000):
    unix_s = rng.randrange(first, last)
    # Even over the sphere.
    lat = round(math.degrees(math.asin(rng.uniform(-1, 1))), 4)
    lon = round(rng.uniform(-180, 180), 4)
    year = 1970 + unix_s / 31556952
    # Pressure 0: no refraction. Rows: apparent zenith, zenith, apparent elevation, elevation, azimuth, equation of time.
    found = spa.solar_position_numpy(
        np.array([unix_s], dtype=float), lat, lon, 0.0, 0.0, 10.0, delta_t_s(year), 0.0, 1
    )
    print(f"{unix_s},{lat},{lon},{found[4][0]:.5f},{found[3][0]:.5f}")
