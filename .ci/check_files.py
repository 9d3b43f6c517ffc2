"""Reads the demonstration's files with software that is not ours.

    check_files.py FOLDER   exit 0: all readable and sound
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as ET

import numpy as np
import trimesh

folder = pathlib.Path(sys.argv[1])
faults = []


def expect(condition, sentence):
    if not condition:
        faults.append(sentence)


result = json.loads((folder / "trawler.json").read_text())
plates = result["method_specific"]["plates"]

mesh = trimesh.load(folder / "trawler.obj", process=False)
edges, counts = np.unique(np.sort(mesh.edges, axis=1), axis=0, return_counts=True)
expect(len(mesh.faces) >= 100, f"only {len(mesh.faces)} triangles")
expect(np.isfinite(mesh.vertices).all(), "a vertex is not finite")
expect(mesh.is_winding_consistent, "the winding is not consistent")
expect((counts <= 2).all(), f"{(counts > 2).sum()} edges have more than two triangles")
expect(mesh.body_count == 1, f"the mesh falls into {mesh.body_count} pieces")
expect((mesh.area_faces > 1e-14 * mesh.area).all(), "there are degenerate triangles")

svg = ET.parse(folder / "trawler.svg").getroot()
expect(svg.tag == "{http://www.w3.org/2000/svg}svg", f"the root is {svg.tag}")
texts = [e.text for e in svg.iter("{http://www.w3.org/2000/svg}text")]
for plate in plates:
    expect(plate["name"] in texts, f"the drawing does not name {plate['name']}")
expect(not list(svg.iter("{http://www.w3.org/2000/svg}script")), "the drawing has a script")

rows = (folder / "trawler.csv").read_bytes().split(b"\r\n")
rulings = sum(len(plate["rulings"]) for plate in plates)
expect(len(rows) == rulings + 2, f"{len(rows) - 2} rows for {rulings} rulings")

print("\n".join(faults) or f"read back: {len(mesh.faces)} triangles, {rulings} rulings")
sys.exit(bool(faults))
