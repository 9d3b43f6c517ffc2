"""Posts every example of a running service and opens every file of it with
software that is not ours: trimesh, ezdxf, OpenCASCADE, zipfile, XML.

    check_examples.py URL CLIENTS FOLDER   exit 0: all readable and sound

CLIENTS is the folder of the checkers that other programmes of the yard use; of
STEP and IGES it is asked only for one example a method, since reading takes
time.
"""

import csv
import io
import json
import pathlib
import struct
import subprocess
import sys
import time
import urllib.request
import xml.etree.ElementTree as ET
import zipfile
from concurrent.futures import ThreadPoolExecutor
from urllib.error import HTTPError

import ezdxf
import numpy as np
import trimesh

BASE, CLIENTS, FOLDER = sys.argv[1].rstrip("/"), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
QUANTITY = {
    "hull_plates": {"twist"},
    "cone_spline": {"distance"},
    "fairing": {"deviation", "mean_curvature"},
    "curvature_net": {"normal_deviation", "torsion"},
}
# The examples whose STEP and IGES files OpenCASCADE reads.
CAD = {"wigley", "bent_plate", "bilge_grid", "half_circle", "vault"}
faults = []


def expect(condition, sentence):
    if not condition:
        faults.append(sentence)


def ask(path, body=None):
    head = {"Content-Type": "application/json"} if body else {}
    with urllib.request.urlopen(urllib.request.Request(BASE + path, body, head), timeout=90) as answer:
        return answer.read()


def tell(path, body=None):
    return json.loads(ask(path, body))


def post(example):
    """The job of an example, ended."""
    job = tell("/v1/jobs?wait=55", ask(example["href"]))
    while job["status"] in ("accepted", "running"):
        job = tell(f"/v1/jobs/{job['id']}?wait=55")
    return job


def mesh_of(data, kind):
    read = trimesh.load(io.BytesIO(data), file_type=kind, process=False)
    if isinstance(read, trimesh.Trimesh):
        return read
    parts = [g for g in read.dump() if isinstance(g, trimesh.Trimesh)]
    return trimesh.util.concatenate([trimesh.Trimesh(p.vertices, p.faces, process=False) for p in parts])


def check_mesh(name, mesh, area):
    whole = mesh.copy()
    whole.merge_vertices(merge_norm=True, merge_tex=True)
    expect(np.isfinite(mesh.vertices).all(), f"{name}: a vertex is not finite")
    expect(whole.is_winding_consistent, f"{name}: the winding is not consistent")
    expect(abs(mesh.area / area - 1) < 1e-4, f"{name}: area {mesh.area}, of the OBJ {area}")


def tree_of(data):
    """The JSON of a scene."""
    return json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])


def check_same_place(name, scaled, data, factor):
    """Vertices in another unit, but the same scene in metres."""
    def box(tree):
        bounds = [tree["accessors"][m["primitives"][0]["attributes"]["POSITION"]] for m in tree["meshes"]]
        local = np.array([[b["min"], b["max"]] for b in bounds])
        matrix = np.array(tree["nodes"][0]["matrix"]).reshape(4, 4).T
        return local, local @ matrix[:3, :3].T + matrix[:3, 3]

    (local, metres), (before, as_before) = box(tree_of(scaled)), box(tree_of(data))
    size = np.ptp(as_before.reshape(-1, 3), axis=0).max()
    expect(np.allclose(local, before * factor, rtol=1e-5, atol=1e-6 * size), f"{name}: not scaled")
    expect(np.allclose(metres, as_before, atol=1e-6 * size), f"{name}: elsewhere in metres")


def check_glb(name, data, method, result, unit_area):
    """The chunks by hand for what trimesh does not tell, the rest by trimesh."""
    tree = tree_of(data)
    extras = tree["nodes"][0]["extras"]
    expect(extras["quantity"] in QUANTITY[method], f"{name}: quantity {extras['quantity']}")
    expect(extras["verdict"] == result["verdict"], f"{name}: verdict {extras['verdict']}")
    scene = trimesh.load(io.BytesIO(data), file_type="glb", process=False)
    parts = [n for n in tree["nodes"][1:] if tree["meshes"][n["mesh"]]["primitives"][0]["mode"] == 4]
    names = [n["name"] for n in parts]
    expect(len(set(names)) == len(names), f"{name}: two parts of one name")
    if method in ("hull_plates", "cone_spline"):
        expect(len(names) == len(result["surfaces"]), f"{name}: {len(names)} parts")
    for geometry in scene.geometry.values():
        if isinstance(geometry, trimesh.Trimesh):
            values = geometry.vertex_attributes["_VALUE"]
            expect(np.isfinite(values).all(), f"{name}: a value is not finite")
            colours = geometry.visual.vertex_attributes["color"]
            expect(len(colours) == len(geometry.vertices), f"{name}: {len(colours)} colours")
    if result["verdict"] == "within_limits" and extras["limit"] is not None:
        expect(extras["largest"] <= extras["limit"] * (1 + 1e-6), f"{name}: {extras['largest']} above the limit")
    check_mesh(name, mesh_of(data, "glb"), unit_area)


def check_dxf(name, data, version, units):
    drawing = ezdxf.read(io.StringIO(data.decode("ascii"), newline=None))
    expect(drawing.dxfversion == version, f"{name}: {drawing.dxfversion}")
    auditor = drawing.audit()
    expect(not auditor.errors, f"{name}: {[e.message for e in auditor.errors][:3]}")
    if version == "AC1015":
        codes = {"in": 1, "ft": 2, "mm": 4, "cm": 5, "m": 6}
        expect(drawing.header["$INSUNITS"] == codes[units], f"{name}: $INSUNITS {drawing.header['$INSUNITS']}")
    outlines = [e for e in drawing.modelspace() if e.dxf.layer == "CUT"]
    expect(all(e.is_closed for e in outlines), f"{name}: an open outline")
    kinds = {e.dxftype() for e in outlines}
    expect(kinds <= {"POLYLINE"} if version == "AC1009" else kinds <= {"LWPOLYLINE"}, f"{name}: {kinds}")

    def area(e):
        points = e.points() if e.dxftype() == "POLYLINE" else e.get_points("xy")
        x, y = np.array([(p[0], p[1]) for p in points]).T
        return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2

    return sum(area(e) for e in outlines)


def check_zip(name, data, again, files, posted):
    expect(data == again, f"{name}: other bytes the second time")
    archive = zipfile.ZipFile(io.BytesIO(data))
    expect(archive.testzip() is None, f"{name}: {archive.testzip()} is broken")
    for file in archive.infolist():
        expect(file.date_time == (1980, 1, 1, 0, 0, 0), f"{name}: {file.filename} has a time")
        if file.filename == "job.json":
            expect(archive.read(file) == posted, f"{name}: not the job that was posted")
        else:
            expect(archive.read(file) == files[file.filename], f"{name}: another {file.filename}")
    expect(len(archive.infolist()) == len(files) + 1, f"{name}: {archive.namelist()}")


def check_parts(name, items):
    """The first and the last file of each format."""
    for ending in {i["name"].rsplit(".", 1)[1] for i in items}:
        same = [i for i in items if i["name"].endswith(ending)]
        for item in {i["href"]: i for i in (same[0], same[-1])}.values():
            data = ask(item["href"])
            label = f"{name}, {item['name']}"
            if ending == "glb":
                expect(mesh_of(data, "glb").area > 0, f"{label}: no area")
            elif ending == "dxf":
                check_dxf(f"{label} (r12)", ask(item["href"] + "?version=r12"), "AC1009", None)
                expect(ezdxf.read(io.StringIO(data.decode("ascii"), newline=None)), label)
            elif ending == "svg":
                ET.fromstring(data)
            else:
                expect(len(list(csv.reader(io.StringIO(data.decode())))) > 1, f"{label}: no rows")


def check(example, job):
    name, method, place = example["name"], example["method"], f"/v1/jobs/{job['id']}"
    if job["status"] != "successful":
        faults.append(f"{name}: {job['status']}: {job.get('error')}")
        return
    items = tell(job["links"]["artifacts"])["items"]
    whole = {i["name"]: i for i in items if i["part"] is None}
    files = {n: ask(i["href"]) for n, i in whole.items()}
    result = json.loads(files["result.json"])
    units = result["units"]
    other = "mm" if units != "mm" else "in"
    factor = METRES[units] / METRES[other]
    if "result.obj" in files:
        mesh = mesh_of(files["result.obj"], "obj")
        scaled = mesh_of(ask(whole["result.obj"]["href"] + f"?units={other}"), "obj")
        expect(np.allclose(scaled.bounds, mesh.bounds * factor, rtol=1e-9), f"{name}.obj: units")
        for kind in ("obj", "stl", "ply"):
            check_mesh(f"{name}.{kind}", mesh_of(files[f"result.{kind}"], kind), mesh.area)
        metres = METRES[units] ** 2
        check_glb(f"{name}.glb", files["result.glb"], method, result, mesh.area * metres)
        scaled = ask(whole["result.glb"]["href"] + f"?units={other}")
        check_same_place(f"{name}.glb in {other}", scaled, files["result.glb"], factor)
        raw = trimesh.load(io.BytesIO(files["result.ply"]), file_type="ply", process=False)
        expect(raw.visual.kind == "vertex", f"{name}.ply: no colours")
    if "result.dxf" in files:
        area = check_dxf(f"{name}.dxf", files["result.dxf"], "AC1015", units)
        path = whole["result.dxf"]["href"]
        old = check_dxf(f"{name}.dxf (r12)", ask(path + "?version=r12"), "AC1009", None)
        expect(old == area, f"{name}.dxf: R12 has area {old}, R2000 {area}")
        scaled = check_dxf(f"{name}.dxf in {other}", ask(f"{path}?units={other}"), "AC1015", other)
        expect(abs(scaled - area * factor**2) <= 1e-9 * scaled, f"{name}.dxf: units")
    root = ET.fromstring(files["result.svg"])
    expect(root.tag == "{http://www.w3.org/2000/svg}svg", f"{name}.svg: {root.tag}")
    expect(len(list(csv.reader(io.StringIO(files["result.csv"].decode())))) > 1, f"{name}.csv: no rows")
    again = ask(whole["result.zip"]["href"])
    check_zip(f"{name}.zip", files["result.zip"], again, {n: f for n, f in files.items() if n != "result.zip"}, ask(place + "/input"))
    check_parts(name, [i for i in items if i["part"] is not None])
    if name in CAD and CLIENTS.is_dir():
        check_cad(name, files, result)


def check_cad(name, files, result):
    """STEP and IGES by OpenCASCADE, in a process of its own."""
    for ending in ("step", "igs"):
        path = FOLDER / f"{name}.{ending}"
        path.write_bytes(files[f"result.{ending}"])
        wires = ["--allow-wire"] if not result["surfaces"] else []
        ended = subprocess.run(
            [sys.executable, CLIENTS / "check_brep.py", path, *wires], capture_output=True, text=True, timeout=120)
        expect(ended.returncode == 0, f"{name}.{ending}: {ended.stdout[-300:]} {ended.stderr[-300:]}")


def main():
    started = time.monotonic()
    FOLDER.mkdir(parents=True, exist_ok=True)
    examples = tell("/v1/examples")["items"]
    with ThreadPoolExecutor(2) as pool:
        for example, job in zip(examples, pool.map(post, examples)):
            try:
                check(example, job)
            except (HTTPError, ValueError, KeyError, ezdxf.DXFError, ET.ParseError) as trouble:
                faults.append(f"{example['name']}: {type(trouble).__name__}: {trouble}")
    seconds = time.monotonic() - started
    print("\n".join(faults) or f"{len(examples)} examples: every file read, in {seconds:.0f} s")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
