"""Markups files of 3D Slicer in every form that the reader knows."""
import itertools
import json

POINTS = [{"id": "1", "label": "entry", "position": [1.5, -2, 3e1], "positionStatus": "defined"},
          {"id": "2", "label": "F-\"2\"\\", "position": [0, 0.25, -4], "orientation": [-1, -0.0, 0, 0, -1, 0, 0, 0, 1], "visibility": True},
          {"id": "3", "label": "t\u00e9", "position": None, "positionStatus": "undefined"}]
HEAD = "# Markups fiducial file version = 5.0\n"
COLUMNS = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
ROWS = "1,1.5,-2,3e1,0,0,0,1,1,1,0,entry,,\n2,0,0.25,-4,0,0,0,1,1,1,0,\"a, \"\"b\"\"\",,\n"


def files():
    out = {}
    for n, (kind, system, unit) in enumerate(itertools.product(("Line", "Fiducial"), ("LPS", "RAS", None), ("mm", "um", ["mm", "UCUM", "millimeter"], None))):
        markup = {"type": kind, "coordinateSystem": system, "coordinateUnits": unit, "controlPoints": POINTS}
        out[f"{n}.mrk.json"] = json.dumps({"@schema": "https://x#", "markups": [{k: v for k, v in markup.items() if v is not None}]}, indent=n % 3)
    out["two.mrk.json"] = json.dumps({"markups": [{"type": "ROI", "display": None}, {"type": "Line", "locked": False, "controlPoints": POINTS}]})
    for system in ("LPS", "RAS", "0", "1"):
        out[f"{system}.fcsv"] = HEAD + f"# CoordinateSystem = {system}\n" + COLUMNS + ROWS
    out["old.fcsv"] = "# columns = label,x,y,z,sel,vis\nentry,1,2,3,1,1\r\ntarget,4,5,6,1,1\r\n"
    out["plain.fcsv"] = ROWS
    return out
