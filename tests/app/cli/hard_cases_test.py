"""Every effect of the registry at once on a small patch of skull, in hard cases: steps of 1 to 100 ms, extreme speeds of spindle and hand, bone without
hardness, noise, a thin shell, a tool that leaves bone and comes back, each law of removal and each contact model.

Of each case: the run ends without an error, no figure and no recorded value is without number, every voxel is finite and in [0, 1], the balances of
dust, heat and blood close, dust and erosion agree on what was removed, and a replay has the same bits. The last class is the sabotage: each of these
checks must notice a fault. A table of the registry that no case has fails the test. Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import array
import gzip
import json
import math
import re
import sqlite3
import unittest

from program_support import run, SOURCE, WithFolder

BASE = """title = "All effects on a small patch"
duration_s = 1.5
[volume]
source = "phantom:skull_patch"
spacing_mm = 0.25
extent_mm = [12.0, 12.0, 5.5]
above_mm = 1.0
thickness_mm = 1.5
outer_table_mm = 0.5
inner_table_mm = 0.5
[tool]
name = "round_burr_4mm"
spin_rpm = 10000.0
[approach]
entry_mm = [0.0, 0.0, 0.0]
[hand]
ramp_s = 0.1
standoff_mm = 0.5
[output]
report = false
plots = false
"""
# Lines of each table in the base; those of a case come in addition. [device] and [clutch] have cases of their own.
TABLES = {"contact": "", "erosion": "", "spindle": "", "friction": "", "vibration": 'source = "chips"\n[vibration.drilling_force]', "irrigation": "",
          "heat": "", "dust": "[dust.suction]", "zones": "[zones.guidance]", "dura": "radius_mm = 5", "bleeding": "", "sound": "", "motion": "",
          "display": "", "record": ""}
AWAY = """[[motion.key]]
time_s = {0}
[[motion.key]]
time_s = {1}
translation_mm = [0, 0, -6]
[[motion.key]]
time_s = {2}
"""
# Name: changes of the base as --set takes them; "-TABLE" leaves a table out, "+TEXT" adds text.
CASES = {
    "as it is": [],
    "bone steps of 1 ms": ["erosion.rate_hz=1000"],
    "bone steps of 100 ms": ["erosion.rate_hz=10"],
    "servo steps of 10 ms": ["servo_hz=100", "contact.rate_hz=100", "erosion.rate_hz=10"],
    "servo steps of 0.2 ms": ["servo_hz=5000", "contact.rate_hz=1000", "erosion.rate_hz=50"],
    "200 000 rpm": ["tool.spin_rpm=200000"],
    "1 rpm": ["tool.spin_rpm=1"],
    "at rest": ["tool.spin_rpm=0"],
    "bone without hardness": ["volume.table_hardness=0", "volume.trabecula_hardness=0", "volume.pore_hardness=0"],
    "noise": ["volume.noise=0.5"],
    "thin shell": ["volume.thickness_mm=0.8", "volume.spacing_mm=0.2", "volume.outer_table_mm=0", "volume.inner_table_mm=0.8"],
    "thrust of 500 N": ["hand.push_N=500", "servo.force_N=1000"],
    "no thrust": ["hand.push_N=0"],
    "approach at 1 m/s": ["hand.feed_mm_per_s=1000"],
    "driven through at 0.2 m/s": ['hand={kind="feed", feed_mm_per_s=200, stop_mm=4, standoff_mm=0.5}'],
    "tremor of 5 mm at 50 Hz": ["hand.tremor_mm=5", "hand.tremor_hz=50"],
    "a hand that does not notice": ["hand.detects=false", "hand.reach_mm=5"],
    "leaves and comes back": ["+" + AWAY.format(0.3, 0.5, 0.7)],
    "leaves and comes back in 20 ms": ["+" + AWAY.format(0.4, 0.41, 0.42)],
    "law energy": ["erosion.law=energy"],
    "law threshold": ["erosion.law=threshold"],
    "law progressive": ["erosion.law=progressive"],
    "law per-update": ["erosion.law=per-update"],
    "penalty planes": ["contact.model=gradient-plane"],
    "mesh contact": ["contact.model=mesh"],
    "no contact": ["-contact", "-friction", "-spindle"],
    "on a device": ["+[device]\nname = \"touch\"\n"],
    "perforator with its clutch": ["-dura", "tool.name=perforator_14_11", "tool.spin_rpm=1000", "volume.spacing_mm=0.375",
                                   "volume.extent_mm=[20, 20, 6]", "+[clutch]\n"],
}
# The sum of these is what was released. Cells hold floats: each of at most 150 steps rounds a temperature by 6e-8, so 1e-5 of the largest term.
HEAT = ("in_bone_J", "chips_J", "coolant_J", "edge_J", "unplaced_J")
DUST = ("held_mm3", "flying_mm3", "settled_mm3", "rinsed_mm3", "sucked_mm3", "lost_mm3", "undone_mm3")
BLOOD = ("pooled_ml", "film_ml", "rinsed_ml", "sucked_ml", "overflowed_ml")
DOUBLES = 1e-9  # sums of doubles


def registry():
    return set(re.findall(r"^BH_EFFECT\((\w+)\)$", (SOURCE / "app" / "effect" / "registry.inc").read_text(), re.M))


def scene_of(changes):
    """@returns (text, the tables that it names, arguments of the program) of a case."""
    tables = [name for name in TABLES if "-" + name not in changes]
    added = "".join(change[1:] for change in changes if change.startswith("+"))
    text = BASE + "".join(f"[{name}]\n{TABLES[name]}\n" for name in tables) + added
    sets = [word for change in changes if change[0] not in "+-" for word in ("--set", change)]
    return text, set(tables) | set(re.findall(r"^\[(\w+)\]", added, re.M)), sets


def without_number(value, path=""):
    """@returns the paths of figures that are not finite."""
    if isinstance(value, dict):
        return [bad for key, one in value.items() for bad in without_number(one, f"{path}/{key}")]
    if isinstance(value, list):
        return [bad for n, one in enumerate(value) for bad in without_number(one, f"{path}/{n}")]
    return [path] if isinstance(value, float) and not math.isfinite(value) else []


def open_balances(figures):
    """@param figures of each effect. @returns the balances that do not close."""
    def opened(whole, parts, tolerance):
        return abs(whole - sum(parts)) > tolerance * max(map(abs, [whole, *parts]))
    out = []
    if "heat" in figures and opened(figures["heat"]["released_J"], [figures["heat"][name] for name in HEAT], 1e-5):
        out.append("heat")
    if "dust" in figures and opened(figures["dust"]["removed_mm3"], [figures["dust"][name] for name in DUST], DOUBLES):
        out.append("dust")
    if "bleeding" in figures and opened(figures["bleeding"]["bled_ml"], [figures["bleeding"][name] for name in BLOOD], DOUBLES):
        out.append("bleeding")
    if "dust" in figures and opened(figures["erosion"]["removed_mass_mm3"], [figures["dust"]["removed_mm3"]], DOUBLES):
        out.append("dust and erosion")
    return out


def voxels_of(path):
    """@returns the floats of a NRRD as the program exports it."""
    header, packed = path.read_bytes().split(b"\n\n", 1)
    assert b"type: float" in header and b"encoding: gzip" in header and b"endian: little" in header, header
    return array.array("f", gzip.decompress(packed))


def outside(voxels):
    """@returns how many voxels are not in [0, 1]; those without a number are not."""
    return sum(1 for value in voxels if not 0.0 <= value <= 1.0)


def bad_rows(text):
    """@returns the values of a CSV that are not finite."""
    return re.findall(r"(?i)(?:^|,)(-?(?:nan|inf)[^,\r\n]*)", text, re.M)


class HardCases(WithFolder):
    def drilled(self, name):
        text, _, sets = scene_of(CASES[name])
        out = self.folder / "out"
        result = run("drill", self.scene(text), *sets, "--offscreen", "--no-pictures", "--quiet", "--force", "--json", "--out", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        return out, json.loads(result.stdout)

    def figures(self, summary):
        return {one["name"]: one["figures"] for one in summary["effects"]}

    def rows(self, out):
        return "".join(run("session", out, "--csv", "--stream", stream).stdout for stream in ("servo", "contact", "bone"))

    def test_each_case_ends_with_numbers_closed_balances_finite_bone_and_an_equal_replay(self):
        for name in CASES:
            with self.subTest(name):
                out, summary = self.drilled(name)
                self.assertEqual(without_number(summary), [])
                self.assertGreater(summary["duration_s"], 0.0)
                self.assertEqual(open_balances(self.figures(summary)), [], self.figures(summary))
                rows = self.rows(out)
                self.assertGreater(rows.count("\n"), 100)
                self.assertEqual(bad_rows(rows), [])
                exported = run("export", out / "bone.vdb", "-o", self.folder / "bone.nrrd", "--force", "--quiet")
                self.assertEqual(exported.returncode, 0, exported.stderr)
                self.assertEqual(outside(voxels_of(self.folder / "bone.nrrd")), 0)
                again = run("replay", out, "--quiet")
                self.assertEqual(again.returncode, 0, again.stdout + again.stderr)

    def test_the_cases_have_every_table_of_the_registry(self):
        named = set().union(*(scene_of(changes)[1] for changes in CASES.values()))
        self.assertEqual(registry() - named, set())
        self.assertEqual(registry() & named, registry())

    def test_sabotage_each_check_notices_a_fault(self):
        out, summary = self.drilled("as it is")
        figures = self.figures(summary)
        self.assertGreater(figures["dust"]["removed_mm3"], 1.0)  # bone is cut, so that the balances are not 0 = 0
        self.assertGreater(figures["heat"]["released_J"], 0.1)
        self.assertGreater(figures["bleeding"]["bled_ml"], 0.0)
        for effect, figure, found in (("heat", "coolant_J", "heat"), ("dust", "lost_mm3", "dust"), ("bleeding", "film_ml", "bleeding"),
                                      ("erosion", "removed_mass_mm3", "dust and erosion")):
            wrong = {one: dict(values) for one, values in figures.items()}
            wrong[effect][figure] *= 1.001
            self.assertEqual(open_balances(wrong), [found])
        figures["dura"]["largest_strain"] = math.nan
        self.assertEqual(len(without_number(summary)), 1)
        self.assertEqual(bad_rows("time_s,force_N\r\n0,1\r\n0.1,nan\r\n-inf,2\r\n"), ["nan", "-inf"])
        self.assertEqual(outside(array.array("f", [0.0, 0.5, 1.0, math.nan, math.inf, -1e-3])), 3)
        database = sqlite3.connect(out / "session.sqlite")
        with database:
            database.execute("UPDATE hashes SET value = replace(replace(value, '1', '2'), 'a', 'b')")
        database.close()
        self.assertEqual(run("replay", out, "--quiet").returncode, 3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
