"""Makes moon_ephem.csv: 400 seeded dates of 1950-2050 and places over the globe, with the moon as PyEphem sees it.

pip install ephem==4.2.1; python make_moon_ephem.py > moon_ephem.csv

Topocentric at sea level, without refraction; azimuth clockwise from true north, degrees; lit: share of the disc.
"""
import calendar
import datetime
import math
import random

import ephem

rng = random.Random(20260102)
first = calendar.timegm((1950, 1, 1, 0, 0, 0))
last = calendar.timegm((2050, 1, 1, 0, 0, 0))
print("unix_s,lat_deg,lon_deg,azimuth_deg,elevation_deg,distance_km,lit")
for _ in range(400):
    unix_s = rng.randrange(first, last)
    lat = round(math.degrees(math.asin(rng.uniform(-1, 1))), 4)
    lon = round(rng.uniform(-180, 180), 4)
    place = ephem.Observer()
    place.lat, place.lon, place.elevation, place.pressure = str(lat), str(lon), 0, 0
    place.date = ephem.Date(datetime.datetime(1970, 1, 1) + datetime.timedelta(seconds=unix_s))
    moon = ephem.Moon(place)
    km = moon.earth_distance * 149597870.7
    print(f"{unix_s},{lat},{lon},{math.degrees(moon.az):.4f},{math.degrees(moon.alt):.4f},{km:.0f},{moon.moon_phase:.5f}")
