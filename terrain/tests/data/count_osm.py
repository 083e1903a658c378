#!/usr/bin/env python3
"""Counts ways and relations of OSM files by their keys, with pyosmium (libosmium), for terrain/tests/bake_features.rs.

What is counted: ways and relations, not nodes.
  highways   have the key highway
  railways   have the key railway
  waterways  have the key waterway
  buildings  have the key building
  forests    have landuse=forest or natural=wood
  lakes      have natural=water, landuse=reservoir or landuse=basin

Run: python3 -m venv v && v/bin/pip install osmium && v/bin/python count_osm.py FILE.. > osm_counts.csv
Written with osmium 4.3.2.
"""

import os
import sys

import osmium


def kinds(tags):
    for kind, key in (("highways", "highway"), ("railways", "railway"), ("waterways", "waterway"), ("buildings", "building")):
        if key in tags:
            yield kind
    landuse, natural = tags.get("landuse"), tags.get("natural")
    if landuse == "forest" or natural == "wood":
        yield "forests"
    if natural == "coastline":
        yield "coastlines"
    if natural == "water" or landuse in ("reservoir", "basin"):
        yield "lakes"


class Count(osmium.SimpleHandler):
    def __init__(self):
        super().__init__()
        self.found = {}

    def add(self, element, what):
        for kind in kinds(element.tags):
            pair = self.found.setdefault(kind, [0, 0])
            pair[what] += 1

    def way(self, way):
        self.add(way, 0)

    def relation(self, relation):
        self.add(relation, 1)


print("file,kind,ways,relations")
for path in sys.argv[1:]:
    count = Count()
    count.apply_file(path)
    for kind, (ways, relations) in sorted(count.found.items()):
        print(f"{os.path.basename(path)},{kind},{ways},{relations}")
