"""Reads the demonstration's files with software that is not ours.

    check_files.py FOLDER   exit 0: all readable and sound
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as ET

import ezdxf
import ezdxf.path
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

drawing = ezdxf.readfile(folder / "trawler.dxf")
expect(not drawing.audit().errors, "the drawing for the cutting table has errors")
cut = [e for e in drawing.modelspace() if e.dxf.layer == "CUT"]
expect(len(cut) == len(plates) and all(e.closed for e in cut), "not one closed outline a plate")
layers = {e.dxf.layer for e in drawing.modelspace()}
expect(layers == {"CUT", "ROLL", "FRAME", "TEXT"}, f"the layers are {sorted(layers)}")
for plate, outline in zip(plates, cut):
    corners = np.array([list(p)[:2] for p in ezdxf.path.make_path(outline).flattening(1e-4)])
    x, y = corners.T
    area = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    flat = plate["flat"]["flat_area"]
    expect(abs(area / flat - 1) < 1e-4, f"{plate['name']}: {area} cut, {flat} told")

print("\n".join(faults) or f"read back: {len(mesh.faces)} triangles, {rulings} rulings")
sys.exit(bool(faults))
