"""Typical mistakes typed by hand: each message is one that names the mistake and the next step, with the right exit code.

Run by ctest with the program's path in BURRHOLE_PROGRAM. Nothing here draws.
"""
import json
import pathlib
import shutil
import sys
import unittest

from program_support import lines, QUICK, run, SOURCE, WithFolder

# (words, exit code, what one line of stderr must hold, in any order)
MISTAKES = [
    # commands and options
    ([], 4, ["no display", "burrhole drill parietal", "burrhole --help"]),
    (["drll", "parietal"], 2, ['unknown command "drll"', 'did you mean "drill"?']),
    (["parietal"], 2, ['unknown command "parietal"', 'did you mean "drill parietal"?']),
    (["scene.toml"], 2, ['did you mean "drill scene.toml"?']),
    (["completion", "zhs"], 2, ['did you mean "zsh"?']),
    (["docs", "scne"], 2, ['did you mean "scene"?']),
    (["drill"], 2, ["SCENE is missing", "burrhole scenes"]),
    (["drill", "quick.toml", "--otu", "x"], 2, ['unknown option "--otu"', 'did you mean "--out"?']),
    (["drill", "quick.toml", "--set-tol", "x=1"], 2, ['did you mean "--set-tool"?']),
    (["drill", "quick.toml", "parietal"], 2, ['unexpected "parietal"', "burrhole drill --help"]),
    (["drill", "quick.toml", "--window", "--offscreen"], 2, ["--window", "not valid with --offscreen"]),
    (["render", "quick.toml", "--gl", "vulkan"], 2, ["--gl", "auto,window,osmesa,egl"]),
    (["compare", "one"], 2, ["compare needs two runs", "burrhole compare one OTHER_FOLDER", "one/report.html"]),
    (["compare"], 2, ["run is missing", "folders of results, at least two", "burrhole compare --help"]),
    (["--drill"], 2, ['"--drill" is a command', 'did you mean "burrhole drill"?']),
    (["--drill", "parietal"], 2, ['"--drill" is a command', 'did you mean "burrhole drill"?']),
    (["completion", "tcsh"], 2, ['unknown word "tcsh" after burrhole completion', "bash, zsh, fish"]),
    (["completion"], 2, ["burrhole completion is incomplete", "bash or zsh or fish"]),
    (["drill", "quick.toml", "--set", "hand.push_N", "40"], 2, ["--set hand.push_N is not followed by its value", "write --set hand.push_N=40"]),
    (["drill", "quick.toml", "--set", "hand.push_N", "=", "40"], 2, ["write --set hand.push_N=40"]),
    (["drill", "quick.toml", "--set", "hand.push_N=", "40", "--quiet"], 2, ["write --set hand.push_N=40"]),
    (["drill", "--set-tool", "region.pin.diameter_mm", "3", "quick.toml"], 2, ["--set-tool", "write --set-tool region.pin.diameter_mm=3"]),
    (["drill", "my", "scan.toml"], 2, ['unexpected "scan.toml"', 'write the path in quotes, "my scan.toml"']),
    # habits of git, ParaView, 3D Slicer and other programs
    (["help"], 2, ['did you mean "burrhole --help"?']),
    (["help", "drill"], 2, ['did you mean "burrhole drill --help"?']),
    (["version"], 2, ['did you mean "burrhole --version"?']),
    (["-V"], 2, ['unknown option "-V"', "--version"]),
    (["list"], 2, ['unknown command "list"', 'did you mean "scenes"?']),
    (["init"], 2, ['unknown command "init"', 'did you mean "scenes --copy"?']),
    (["run", "parietal"], 2, ['unknown command "run"', 'did you mean "drill"?']),
    (["open", "head.nii"], 2, ['unknown command "open"', 'did you mean "render"?']),
    (["diff", "one", "two"], 2, ['unknown command "diff"', 'did you mean "compare"?']),
    (["convert", "head.nii", "head.vdb"], 2, ['unknown command "convert"', 'did you mean "export"?']),
    (["Drill", "quick.toml"], 2, ['did you mean "drill"?']),
    (["docs", "scene.md"], 2, ['unknown word "scene.md" after burrhole docs', 'did you mean "scene"?']),
    (["drill", "quick.toml", "-o", "there"], 2, ['unknown option "-o"', "--out"]),
    (["drill", "quick.toml", "--output", "there"], 2, ['did you mean "--out"?']),
    (["drill", "quick.toml", "-out", "there"], 2, ['did you mean "--out"?']),
    (["drill", "--scene", "quick.toml"], 2, ['unknown option "--scene"', "the path of the scene alone"]),
    (["drill", "quick.toml", "--tool", "round_burr_4mm"], 2, ['unknown option "--tool"', "write --set tool.name=NAME"]),
    (["drill", "quick.toml", "--headless"], 2, ['unknown option "--headless"', "write --offscreen"]),
    (["drill", "quick.toml", "--out", "a", "--out", "b"], 2, ["--out is given 2 times", "give it once"]),
    (["drill", "quick.toml", "--out"], 2, ["--out is not followed by its value", "--out FOLDER"]),
    (["check", "quick.toml", "other.toml"], 2, ['unexpected "other.toml"', "burrhole check takes one scene", '"quick.toml"']),
    (["import", "--input", "head.nii"], 2, ['unknown option "--input"', "the path alone"]),
    (["import", "head.nii", "out.vdb"], 2, ['unexpected "out.vdb"', "did you mean --volume out.vdb?"]),
    (["export", "quick.toml", "x.nrrd"], 2, ["--out is missing", ".nrrd"]),
    (["render", "quick.toml", "hole.png"], 2, ['unexpected "hole.png"', "did you mean --image hole.png?"]),
    (["render", "quick.toml", "-o", "hole.png"], 2, ['unknown option "-o"', "write --image FILE"]),
    (["render", "quick.toml", "--size", "400", "300"], 2, ['unexpected "300"', "write --size 400x300"]),
    (["render", "quick.toml", "--camera", "20", "30", "70"], 2, ["write --camera 20,30,70"]),
    (["check", "quick.toml", "--set", "tool/spin_rpm=800"], 2, ["--set tool/spin_rpm=800", "write --set tool.spin_rpm=800"]),
    (["check", "quick.toml", "--set", "tool.spin_rpm: 800"], 2, ["write --set tool.spin_rpm=800"]),
    (["drill", "plan.mrk.json"], 2, ["plan.mrk.json", "a plan of 3D Slicer", "--unset approach --set approach.markups=plan.mrk.json"]),
    (["drill", "case.mrml"], 2, ["case.mrml", "a file of another program", "NRRD"]),
    # scenes and files
    (["drill", "parietl"], 2, ["scene not found in the current folder", 'did you mean "parietal"?']),
    (["check", "nowhere/my.toml"], 2, ["nowhere/my.toml", "scene not found in nowhere"]),
    (["check", "."], 2, ["is a folder, not a scene", "burrhole import"]),
    (["drill", "head.nii"], 2, ["head.nii", "not a scene", "burrhole render head.nii", "--set volume.source=head.nii"]),
    (["drill", "head.vdb"], 2, ["head.vdb", "not a scene", "burrhole render head.vdb --image", "--unset volume --set volume.source=head.vdb"]),
    (["check", "rawdir"], 2, ["rawdir", "is a folder, not a scene", "burrhole import rawdir"]),
    (["import", "rawdir"], 2, ["rawdir: none of 3 files", "write rawdir/scan.toml", 'files = "slice_*.raw"', "dims = [I, J, 3]", "burrhole docs raw"]),
    (["import", "scan.raw"], 2, ["scan.raw", "write scan.toml", 'data = "scan.raw"', "dims = [I, J, K]", "burrhole docs raw"]),
    (["drill", "notes.txt"], 2, ["notes.txt:1:"]),
    (["scenes", "--copy", "parietl"], 2, ['did you mean "parietal"?']),
    (["export", "parietl", "-o", "x.nrrd"], 2, ["parietl", "no such file", 'did you mean "parietal"?']),
    (["export", "missing.nii", "-o", "x.nrrd"], 2, ["missing.nii", "no such file", "burrhole scenes"]),
    (["import", "missing.nii"], 2, ["missing.nii", "there is no such file"]),
    (["import", "empty"], 2, ["empty", "no file"]),
    (["stability", "--case", "rst"], 2, ['no hard case "rst"', 'did you mean "rest"?']),
    (["stability", "--case", "rest", "--model", "surfce"], 2, ['no model "surfce"', 'did you mean "surface"?', "there are"]),
    (["replay", "missing.sqlite"], 2, ["missing.sqlite"]),
    (["replay", "notes.txt"], 2, ["notes.txt", "not a session"]),
    (["session", "empty"], 2, ["empty", "[record]"]),
    (["compare", "empty", "empty"], 2, ["empty", "holds no results", "summary.json"]),
    (["drill", "quick.toml", "--restore", "missing.vdb"], 2, ["missing.vdb"]),
    (["drill", "quick.toml", "--out", "taken"], 2, ["taken", "results of another scene, head.toml", "--force"]),
    (["drill", "quick.toml", "--out", "notes.txt"], 2, ["notes.txt", "is a file"]),
    # keys
    (["check", "quick.toml", "--set", "tool.spin=800"], 2, ["--set tool.spin", 'write "spin_rpm"']),
    (["check", "quick.toml", "--set", "spin_rpm=800"], 2, ['unknown key "spin_rpm"', 'did you mean "tool.spin_rpm"?']),
    (["check", "quick.toml", "--set", "tol.spin_rpm=800"], 2, ["unknown table [tol]", "did you mean [tool]?"]),
    (["check", "quick.toml", "--set", "tool.spin_rpm"], 2, ["--set tool.spin_rpm", "must read table.key=value"]),
    (["check", "quick.toml", "--set", "tool.spin_rpm=fast"], 2, ["tool.spin_rpm", "must be a number"]),
    (["check", "quick.toml", "--set", "tool.spin_rpm=-5"], 2, ["tool.spin_rpm = -5", "must be in [0, 200000]"]),
    (["check", "quick.toml", "--set", "duration_s=30s"], 2, ["--set duration_s=30s", "write 30; the unit is in the key's name"]),
    (["check", "quick.toml", "--set", "tool.spin_rpm=1000rpm"], 2, ["write 1000; the unit is in the key's name"]),
    (["check", "quick.toml", "--set", "tool.erosion_scale=28%"], 2, ["write 0.28"]),
    (["check", "quick.toml", "--set", "approach.entry_mm=[0, 0]"], 2, ["approach.entry_mm", "3 numbers"]),
    (["check", "quick.toml", "--set", "approach.axis=[0, 0, 0]"], 2, ["approach.axis", "has length 0"]),
    (["check", "quick.toml", "--set", "approach.entry_mm=[90, 0, 0]"], 2, ["meets no bone within 20 mm of entry_mm"]),
    (["check", "quick.toml", "--set", "contact.model=voxmapp"], 2, ["contact.model", 'did you mean "voxmap"?']),
    (["check", "quick.toml", "--set", "volume.source=phantom:plat"], 2, ["phantom:plat", 'did you mean "phantom:plate"?']),
    (["check", "quick.toml", "--set", "volume.source=ct/skull.nii"], 2, ["volume.source", "is not there: tried", "ct/skull.nii"]),
    (["check", "quick.toml", "--set", "volume.source=$NOT_SET_HERE/ct"], 2, ["NOT_SET_HERE", "--set volume.source=PATH"]),
    (["check", "quick.toml", "--unset", "dispaly"], 2, ["--unset dispaly", 'did you mean "display"?']),
    # keys of another kind
    (["check", "quick.toml", "--set", "hand.stop_mm=3"], 2, ["hand.stop_mm is read only with kind = feed", "remove the key, or change that choice"]),
    (["check", "quick.toml", "--set", "hand.run_up_s=3"], 2, ["hand.run_up_s is read only with kind = mouse"]),
    (["check", "quick.toml", "--set", "volume.radius_mm=3"], 2, ["volume.radius_mm is read only with source = phantom:capsule, phantom:sphere"]),
    (["check", "parietal", "--set", "volume.source=empty"], 2, ["parietal.toml:", "volume.seed is not read with source = SCAN"]),
    (["tools", "odd_pin.toml"], 2, ["odd_pin.toml:", "width_mm is read only with shape = box"]),
    (["check", "parietal", "--set", "clutch.wear=0", "--set", "tool.name=round_burr_4mm"], 2, ['has not exactly one region "inner drill"', "leave [clutch] out (--unset clutch)"]),
    (["check", "parietal", "--set", "clutch.engage=12"], 2, ["engage_N"]),
    (["check", "parietal", "--set", "clutch.teeth_mm=2"], 2, ["teeth_mm", "must be less than travel_mm"]),
    (["check", "parietal", "--set", "clutch.engage_N=4"], 2, ["engage_N", "must be at least spring_N_per_mm x travel_mm = 4.5"]),
    # tools
    (["tools", "perforater_14_11"], 2, ["tool not found in the current folder", 'did you mean "perforator_14_11"?']),
    (["tools", "perforator"], 2, ['did you mean "perforator_14_11"?']),
    (["tools", "bit.stl"], 2, ["bit.stl", "is a mesh, not a tool file", "[mesh]", "burrhole docs tool"]),
    (["check", "parietal", "--set", "tool.name=bit.stl"], 2, ["bit.stl", "is a mesh, not a tool file", "[mesh]"]),
    (["check", "parietal", "--set", "tool.name=./bit.stl"], 2, ["bit.stl", "is a mesh, not a tool file", "[mesh]"]),
    (["check", "parietal", "--set", "tool.name=my_bit.toml"], 2, ["my_bit.toml", "not found in", "also from the current one"]),
    (["replay", "."], 2, ["holds no session.sqlite"]),
    (["check", "quick.toml", "--set", "tool.name=round_bur_4mm"], 2, ["tool.name", "not found in", 'did you mean "round_burr_4mm"?']),
    (["check", "quick.toml", "--set-tool", "region.pen.erosion_factor=0.05"], 2, ["--set-tool", 'region has no "pen"', '"pin"']),
    (["check", "quick.toml", "--set-tool", "region.pin.erosion=0.05"], 2, ["--set-tool region[0].erosion", "erosion_factor"]),
    (["check", "quick.toml", "--set-tool", "region.pin.diameter_mm=-2"], 2, ["--set-tool region[0].diameter_mm", "must be"]),
    (["check", "parietal", "--set-tool", "region.inner drill.erosion_factor=0.5"], 2, ["--set-tool", "write region.inner_drill.erosion_factor"]),
    (["check", "parietal", "--set-tool", "region.inner.erosion_factor=0.5"], 2, ['region has no "inner"', '"inner_drill"']),
    (["check", "my_pin.toml"], 2, ["my_pin.toml", "is a tool file", "burrhole tools my_pin.toml", "--set tool.name=my_pin.toml"]),
    (["drill", "my_mesh.toml"], 2, ["my_mesh.toml", "is a tool file"]),
    (["check", "quick.toml", "--set", "tool=my_pin.toml"], 2, ["--set tool=my_pin.toml", "write --set tool.name=my_pin.toml"]),
    (["check", "quick.toml", "--set", "volume = head.nii"], 2, ["write --set volume.source=head.nii"]),
    # options before the command, and values without their option
    (["--out", "there", "drill", "quick.toml"], 2, ["--out comes before its command", "burrhole drill ... --out"]),
    (["import", "head.nii", "-o", "head2.vdb"], 2, ['unknown option "-o"', "write --volume FILE"]),
    (["import", "head.nii", "--suggest", "50", "-20", "90"], 2, ['unexpected "-20"', "write --suggest 50,-20,90"]),
    (["session", "empty", "--csv", "contact"], 2, ['unexpected "contact"', "write --csv --stream contact"]),
    (["session", "empty", "--json"], 2, ['unknown option "--json"', "write --csv"]),
    (["session", "empty", "--csv", "--out", "x.csv"], 2, ['unknown option "--out"', "> FILE"]),
    (["replay", "empty", "--csv"], 2, ['unknown option "--csv"', "burrhole session RUN --csv"]),
    (["scenes", "parietal"], 2, ['unexpected "parietal"', "--copy parietal", "burrhole explain parietal"]),
    (["scenes", "--copy", "parietal", "there"], 2, ['unexpected "there"', "write --out there"]),
    # what no command does by that name
    (["report", "taken"], 2, ['unknown command "report"', "report.html", "compare"]),
    (["score", "taken"], 2, ['unknown command "score"', "report.html"]),
    (["sweep", "quick.toml"], 2, ['unknown command "sweep"', "--set KEY=VALUE --out FOLDER", "compare"]),
    (["plot", "taken"], 2, ['unknown command "plot"', "compare ONE OTHER --out FOLDER"]),
    (["docs", "window"], 2, ['unknown word "window"', "docs/*.md"]),
    # results in place of a scene or a bone
    (["check", "taken"], 2, ["taken: is the folder of a run", "burrhole replay taken", "--restore taken/bone.vdb"]),
    (["drill", "taken/summary.json"], 2, ["summary.json: is no scene", "TOML"]),
    (["check", "run.sqlite"], 2, ["run.sqlite: is a recorded session", "burrhole replay run.sqlite"]),
    (["export", "run.sqlite", "-o", "rows.csv"], 2, ["run.sqlite", "burrhole session run.sqlite --csv"]),
    (["export", "quick.toml", "-o", "hole.seg.nrrd"], 2, ["hole.seg.nrrd", "segmentation", "--field labels"]),
    (["import", "my_pin.toml"], 2, ["my_pin.toml: is a tool file, not a volume", "burrhole tools my_pin.toml"]),
    (["import", "quick.toml"], 2, ["quick.toml: is a scene, not a volume", "burrhole drill quick.toml"]),
    (["import", "rowdir"], 2, ['files = "CThead.*"', "dims = [I, J, 3]"]),
    (["import", "lonedir"], 2, ['data = "head.raw"', "dims = [I, J, K]"]),
    # more values and keys
    (["tools", "my_pin"], 2, ["no shipped tool has that name", "write my_pin.toml"]),
    (["check", "parietal", "--set", "tool.name=my_pin"], 2, ["no shipped tool has that name", "write --set tool.name=my_pin.toml"]),
    (["check", "quick.toml", "--set", "hand.push_N = 28, tool.spin_rpm = 800"], 2, ["a second assignment", "--set hand.push_N=28 --set tool.spin_rpm = 800"]),
    (["check", "quick.toml", "--set", "hand.push_N=2,8"], 2, ["write a point for decimals", "[2,8] for an array"]),
    (["check", "quick.toml", "--set", "erosion.curve=[{strain=0.01, stress_MPa=100}]", "--set", "erosion.law=progressive"], 2,
     ["erosion.curve", "two points or more"]),
    (["check", "quick.toml", "--set", "erosion.curve=[{strain=0.01, stress_MPa=100}, {strain=0.02, stress_MPa=900}]", "--set", "erosion.law=progressive"], 2,
     ["erosion.curve", "must not rise above its first line"]),
    (["check", "quick.toml", "--set", "erosion.curve=[{strain=0.01, stress_MPa=100}, {strain=0.02}]", "--set", "erosion.law=progressive"], 2,
     ["erosion.curve[1].stress_MPa is missing"]),
    (["check", "quick.toml", "--set", "erosion.work_share=0", "--set", "erosion.law=progressive"], 2, ["erosion.work_share = 0", "(0, 1]"]),
    (["tools", "quick.toml"], 2, ["is a scene, not a tool", "burrhole tools NAME"]),
    (["check", "quick.toml", "--set-tool", "region.pin.erosion_factor=0.2,0.3"], 2, ["--set-tool", "write a point for decimals"]),
    (["check", "quick.toml", "--set", "approach.depth_mm=-3"], 2, ['unknown key "depth_mm" in [approach]', "burrhole docs scene lists its keys"]),
    (["check", "quick.toml", "--set", "approach.entry_mm=[54, 100]"], 2, ["approach.entry_mm = [54, 100]", "3 numbers"]),
    (["check", "quick.toml", "--set-tool", "region.pin.colour=3"], 2, ['unknown key "colour" in [region[0]]', "burrhole docs tool lists its keys"]),
    (["tools", "open_pin.toml"], 2, ["open_pin.toml:1:", "no closing quote"]),
    # pictures and expectations
    (["drill", "quick.toml", "--expect", "through plunge<1mm"], 2, ["joins terms by a blank", 'write "through, plunge<1mm"']),
    (["render", "quick.toml", "--size", "400"], 2, ["--size 400", "WIDTHxHEIGHT"]),
    (["render", "quick.toml", "--image", "hole.jpg"], 2, ["hole.jpg", "must end in .png"]),
    (["drill", "quick.toml", "--expect", "thruogh"], 2, ["thruogh", 'did you mean "through"?']),
    (["drill", "quick.toml", "--expect", "plunge<0.5cm"], 2, ["plunge<0.5cm", "has the unit cm", "plunge is in mm"]),
    (["drill", "quick.toml", "--expect", "plunge<=1mm"], 2, ["compares by <=", 'write "plunge<1mm"']),
    (["drill", "quick.toml", "--expect", "through, plunge >= 1 mm"], 2, ["compares by >=", 'write "plunge>1 mm"']),
    (["drill", "quick.toml", "--expect", "plunge==1mm"], 2, ["compares by ==", 'write "plunge>LOW, plunge<HIGH"']),
    (["drill", "quick.toml", "--expect", "plunge < 1"], 2, ["needs the unit mm", 'write "plunge<1mm"']),
    (["drill", "quick.toml", "--expect", "1mm > plunge"], 2, ["has its number first", 'write "plunge<1mm"']),
    (["drill", "quick.toml", "--expect", "through and plunge<1mm"], 2, ["another sign than a comma", 'write "through, plunge<1mm"']),
    (["drill", "quick.toml", "--expect", "through; plunge<1mm"], 2, ["another sign than a comma", 'write "through, plunge<1mm"']),
    (["drill", "quick.toml", "--expect", "through or plunged"], 2, ["all terms of --expect must hold"]),
    (["drill", "quick.toml", "--expect", "not plunged"], 2, ['write "no plunged"']),
    (["drill", "quick.toml", "--expect", "!core-left"], 2, ['write "no core-left"']),
    (["drill", "quick.toml", "--expect", "forces<3N"], 2, ['no figure: "forces"', "peak-force", "burrhole docs outcome"]),
    (["drill", "quick.toml", "--expect", "peak_forc_N<3N"], 2, ['did you mean "peak_force_N"?']),
    (["cost", "drilling", "--bit", "my bit"], 2, ["my bit", "ball 6 mm, ball 2 mm, flat 4 mm", "no shipped tool", "no tool file"]),
    (["cost", "contact", "--bit", "my bit"], 2, ["my bit", "no shipped tool", "burrhole tools", "no tool file"]),
    (["cost", "contact", "--bit", ""], 2, ["--bit: must name a file or a folder: the text is empty"]),
    (["cost", "drilling", "--bit", "burr.stl"], 2, ["burr.stl", "is a mesh", "closed form", "tool file"]),
    (["cost", "drilling", "--knob", "erosion.rate"], 2, ["erosion.rate", "erosion.rate_hz"]),
]


class Mistakes(WithFolder):
    def setUp(self):
        super().setUp()
        self.quick().rename(self.folder / "quick.toml")
        (self.folder / "empty").mkdir()
        (self.folder / "taken").mkdir()
        (self.folder / "taken" / "summary.json").write_text('{"schema": 1, "scene": "head.toml"}')
        (self.folder / "notes.txt").write_text("these are notes, no scene\n")
        for name in ("head.nii", "head.vdb"):
            (self.folder / name).write_bytes(b"\x5c\x01\0\0" + b"\xff" * 400)
        (self.folder / "rawdir").mkdir()
        for name in ("rawdir/slice_001.raw", "rawdir/slice_002.raw", "rawdir/slice_003.raw", "scan.raw"):
            (self.folder / name).write_bytes(bytes(8192))
        for name in ("rowdir/Announcement.txt", "rowdir/CThead.1", "rowdir/CThead.2", "rowdir/CThead.10", "lonedir/about.txt", "lonedir/head.raw"):
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_bytes(b"\x01\x02" * 4096)
        (self.folder / "run.sqlite").write_bytes(b"SQLite format 3\0" + bytes(100))
        (self.folder / "open_pin.toml").write_text('title = "My pin\n[[region]]\n')
        for name in ("my scan.toml", "plan.mrk.json", "case.mrml"):
            (self.folder / name).write_text("no scene\n")
        shutil.copy(self.folder / "pin_2mm.toml", self.folder / "my_pin.toml")
        (self.folder / "my_mesh.toml").write_text('[mesh]\nfile = "bit.stl"\n')
        (self.folder / "bit.stl").write_text("solid\n")
        pin = (self.folder / "pin_2mm.toml").read_text()
        (self.folder / "odd_pin.toml").write_text(pin.replace("[[region]]\n", "[[region]]\nwidth_mm = 3\n", 1))

    def test_each_message_names_the_mistake_and_the_next_step(self):
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        for words, code, needles in MISTAKES:
            with self.subTest(" ".join(words)):
                result = run(*words, cwd=self.folder)
                self.assertEqual((result.returncode, result.stdout), (code, ""), result.stderr)
                self.assertTrue(any(all(needle in line for needle in needles) for line in lines(result.stderr)), result.stderr)
                self.assertLessEqual(len(lines(result.stderr)), 5, "a mistake is not a page of text")
        after = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        self.assertEqual(before, after, "a mistake writes nothing")

    def test_a_file_of_the_wrong_kind_or_a_value_without_its_key_is_one_line(self):
        for words in (("check", "my_pin.toml"), ("check", "my_mesh.toml"), ("check", "quick.toml", "--set", "tool=my_pin.toml")):
            result = run(*words, cwd=self.folder)
            self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        whole = run("check", "quick.toml", "--set", 'tool={name="my_pin.toml", spin_rpm=900}', cwd=self.folder)
        self.assertEqual(whole.returncode, 0, whole.stderr)

    def test_there_are_thirty_of_them(self):
        self.assertGreaterEqual(len(MISTAKES), 30)
        self.assertEqual(len({tuple(words) for words, _, _ in MISTAKES}), len(MISTAKES))


class Habits(WithFolder):
    def test_scenes_are_listed_and_copied_with_all_that_they_need(self):
        listed = run("scenes")
        self.assertEqual((listed.returncode, listed.stderr), (0, ""))
        self.assertIn("parietal", listed.stdout)
        copied = run("scenes", "--copy", "parietal", "--out", self.folder / "mine")
        self.assertEqual((copied.returncode, copied.stderr), (0, ""))
        self.assertEqual(sorted(path.name for path in (self.folder / "mine").iterdir()), ["parietal.toml", "perforator_14_11.toml"])
        self.assertEqual(run("check", self.folder / "mine" / "parietal.toml").returncode, 0)
        again = run("scenes", "--copy", "parietal", "--out", self.folder / "mine")
        self.assertEqual(again.returncode, 2)
        self.assertIn("--force", again.stderr)
        self.assertEqual(run("scenes", "--copy", "parietal", "--out", self.folder / "mine", "--force").returncode, 0)
        scan = run("scenes", "--copy", "cadaver_head", "--out", self.folder / "cadaver", env={"PATH": "/usr/bin:/bin"})
        self.assertEqual(scan.returncode, 0, scan.stderr)
        self.assertTrue((self.folder / "cadaver" / "volumes" / "cthead.toml").exists())
        self.assertIn("BURRHOLE_DATA", scan.stderr)
        self.assertIn("scripts/fetch-data", scan.stderr)
        self.assertTrue((SOURCE / "scripts" / "fetch-data").exists())
        missing = run("scenes", env={"PATH": "/usr/bin:/bin"}).stdout
        self.assertIn("scripts/fetch-data", next(line for line in lines(missing) if line.startswith("cadaver_head")))

    def test_paths_of_the_command_line_count_from_the_current_folder(self):
        here = self.folder / "here"
        here.mkdir()
        shutil.copy(self.quick(), here / "scene.toml")
        shutil.copy(self.folder / "pin_2mm.toml", here / "pin_2mm.toml")
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "bits").mkdir()
        shutil.move(self.folder / "pin_2mm.toml", elsewhere / "bits" / "my_pin.toml")
        result = run("check", here / "scene.toml", "--set", "tool.name=bits/my_pin.toml", cwd=elsewhere)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(run("check", here / "scene.toml", "--set", "tool.name=bits/my_pin.toml", cwd=here).returncode, 2)

    def test_unset_and_no_pictures_leave_tables_out(self):
        out = self.folder / "out"
        result = run("drill", self.quick(), "--no-pictures", "--unset", "record", "--out", out, "--quiet", "--set", "duration_s=0.05")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(path.name for path in out.iterdir()), ["bone.vdb", "report.html", "summary.json"])

    def test_a_demonstration_without_a_window_is_the_scene_s_own_hand_and_says_so(self):
        hashes = []
        for words in ((), ("--offscreen",), ("--demo",), ("--demo", "--offscreen"), ("--demo", "--no-pictures")):
            result = run("drill", self.quick(), *words, "--unset", "display", "--out", self.folder / "out", "--force", "--set", "duration_s=0.4")
            self.assertEqual(result.returncode, 0, result.stderr)
            said = [line for line in lines(result.stderr) if line.startswith("--demo: no window")]
            self.assertEqual(len(said), 1 if "--demo" in words else 0, result.stderr)
            hashes.append(json.loads((self.folder / "out" / "summary.json").read_text())["hash"]["voxels"])
        self.assertEqual(len(set(hashes)), 1)

    def test_results_of_another_scene_stay_unless_forced(self):
        out = self.folder / "out"
        short = ("--no-pictures", "--out", out, "--quiet", "--set", "duration_s=0.05")
        first, other = self.quick(), self.folder / "other.toml"
        self.assertEqual(run("drill", first, *short).returncode, 0)
        shutil.copy(first, other)
        before = (out / "summary.json").read_bytes()
        refused = run("drill", other, *short)
        self.assertEqual(refused.returncode, 2)
        self.assertEqual((out / "summary.json").read_bytes(), before)
        self.assertEqual(run("drill", first, *short).returncode, 0, "the same scene may replace its results")
        self.assertEqual(run("drill", other, *short, "--force").returncode, 0)

    def test_results_of_a_scene_of_that_name_in_another_folder_stay_unless_forced(self):
        out, short = self.folder / "out", ("--no-pictures", "--quiet", "--set", "duration_s=0.05")
        scene, elsewhere = self.quick(), self.folder / "elsewhere"
        elsewhere.mkdir()
        other = elsewhere / scene.name
        shutil.copy(scene, other)
        shutil.copy(self.folder / "pin_2mm.toml", elsewhere)
        self.assertEqual(run("drill", scene, *short, "--out", out).returncode, 0)
        before = (out / "summary.json").read_bytes()
        refused = run("drill", other, *short, "--out", out)
        self.assertEqual((refused.returncode, len(lines(refused.stderr))), (2, 1), refused.stderr)
        for needle in ("another scene", scene.name, "in another folder", "--out", "--force"):
            self.assertIn(needle, refused.stderr)
        self.assertEqual((out / "summary.json").read_bytes(), before)
        self.assertNotIn(str(self.folder), before.decode())
        # The same scene by another way to write its path, and after both were moved together.
        self.assertEqual(run("drill", scene.name, *short, "--out", "./elsewhere/../out", cwd=self.folder).returncode, 0)
        moved = self.folder / "moved"
        moved.mkdir()
        for path in (scene, self.folder / "pin_2mm.toml", out):
            shutil.move(path, moved)
        self.assertEqual(run("drill", moved / scene.name, *short, "--out", moved / "out").returncode, 0)
        self.assertEqual(run("drill", other, *short, "--out", moved / "out", "--force").returncode, 0)
        self.assertEqual(run("drill", other, *short, "--out", moved / "out").returncode, 0, "now they are the results of that one")

    def test_a_summary_of_another_program_stays_unless_forced(self):
        out, short = self.folder / "out", ("--no-pictures", "--quiet", "--set", "duration_s=0.05")
        out.mkdir()
        for text in ('{"total": 7}', "no JSON", "[1]"):
            (out / "summary.json").write_text(text)
            refused = run("drill", self.quick(), *short, "--out", out)
            self.assertEqual((refused.returncode, len(lines(refused.stderr))), (2, 1), refused.stderr)
            self.assertIn("--force", refused.stderr)
            self.assertEqual((out / "summary.json").read_text(), text)
        self.assertEqual(run("drill", self.quick(), *short, "--out", out, "--force").returncode, 0)

    def test_a_scene_file_that_is_only_shipped_is_taken_with_a_warning(self):
        plain = run("check", "parietal", cwd=self.folder)
        result = run("check", "parietal.toml", cwd=self.folder)
        self.assertEqual((result.returncode, result.stdout), (0, plain.stdout), result.stderr)
        self.assertEqual(len(lines(result.stderr)), 1, result.stderr)
        for needle in ("parietal.toml: warning:", "not in the current folder", "shipped scene", "burrhole scenes --copy parietal"):
            self.assertIn(needle, result.stderr)
        run("scenes", "--copy", "parietal", cwd=self.folder)
        self.assertEqual(run("check", "parietal.toml", cwd=self.folder).stderr, "")

    def test_a_shipped_scene_is_not_hidden_by_what_has_its_name(self):
        plain = run("check", "parietal", cwd=self.folder)
        self.assertEqual((plain.returncode, plain.stderr), (0, ""))
        (self.folder / "parietal").mkdir()
        result = run("check", "parietal", cwd=self.folder)
        self.assertEqual((result.returncode, result.stdout), (0, plain.stdout), result.stderr)
        self.assertEqual(len(lines(result.stderr)), 1, result.stderr)
        for needle in ("parietal: warning:", "shipped scene", "folder", "./parietal"):
            self.assertIn(needle, result.stderr)
        (self.folder / "parietal").rmdir()
        shutil.copy(self.quick(), self.folder / "parietal.toml")
        result = run("check", "parietal", cwd=self.folder)
        self.assertEqual((result.returncode, result.stdout), (0, plain.stdout), result.stderr)
        self.assertIn("./parietal.toml", result.stderr)
        for name in ("parietal.toml", "./parietal.toml"):
            mine = run("check", name, cwd=self.folder)
            self.assertEqual((mine.returncode, mine.stderr), (0, ""))
            self.assertNotEqual(mine.stdout.split(": ok")[1], plain.stdout.split(": ok")[1])


if __name__ == "__main__":
    unittest.main(verbosity=2)
