"""fuzz corpus: archives are reproducible and refuse what is no input; every fuzzer has an archive and seeds, one for every effect's table."""
import importlib.util
import re
import subprocess
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
FUZZ = ROOT / "tests" / "fuzz"
SPEC = importlib.util.spec_from_file_location("corpus", FUZZ / "corpus.py")
CORPUS = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(CORPUS)
FUZZERS = sorted(file.name.removesuffix("_fuzzer.cpp") for file in FUZZ.glob("*_fuzzer.cpp"))


class Archives(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def inputs(self, name, order):
        folder = self.folder / name
        folder.mkdir()
        for file, content in order:
            (folder / file).write_bytes(content)
        return folder

    def test_the_same_inputs_give_the_same_bytes_and_come_back(self):
        files = [("b", b"\0\1"), ("a", b""), ("c c", b"x" * 1000)]
        CORPUS.pack(self.inputs("one", files), self.folder / "one.tar")
        CORPUS.pack(self.inputs("two", files[::-1]), self.folder / "two.tar")
        self.assertEqual((self.folder / "one.tar").read_bytes(), (self.folder / "two.tar").read_bytes())
        CORPUS.unpack(self.folder / "one.tar", self.folder / "back")
        self.assertEqual({file.name: file.read_bytes() for file in (self.folder / "back").iterdir()}, dict(files))

    def test_a_member_outside_the_folder_or_a_link_is_refused(self):
        for name, kind in (("../out", tarfile.REGTYPE), ("/out", tarfile.REGTYPE), ("a/b", tarfile.REGTYPE), ("link", tarfile.SYMTYPE)):
            with self.subTest(name), tarfile.open(self.folder / "bad.tar", "w") as archive:
                entry = tarfile.TarInfo(name)
                entry.type = kind
                archive.addfile(entry)
            with self.assertRaises(ValueError):
                CORPUS.unpack(self.folder / "bad.tar", self.folder / "bad")

    def test_every_fuzzer_has_an_archive_that_packing_again_does_not_change(self):
        self.assertEqual(FUZZERS, sorted(file.stem for file in (FUZZ / "corpus").iterdir()))
        for name in FUZZERS:
            with self.subTest(name):
                archive = FUZZ / "corpus" / f"{name}.tar"
                CORPUS.unpack(archive, self.folder / name)
                CORPUS.pack(self.folder / name, self.folder / "again.tar")
                self.assertEqual((self.folder / "again.tar").read_bytes(), archive.read_bytes())


class Seeds(unittest.TestCase):
    def test_every_fuzzer_has_seeds_and_every_effect_a_scene_with_its_table(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, str(FUZZ / "seeds.py"), folder], check=True)
            self.assertEqual(FUZZERS, sorted(file.name for file in Path(folder).iterdir() if file.is_dir()))
            for name in FUZZERS:
                self.assertGreater(len(list((Path(folder) / name).iterdir())), 10, name)
            scenes = "".join(file.read_text() for file in (Path(folder) / "scene").iterdir())
            effects = re.findall(r"^BH_EFFECT\((\w+)\)", (ROOT / "app" / "effect" / "registry.inc").read_text(), re.MULTILINE)
            self.assertIn("erosion", effects)
            for effect in effects:
                self.assertIn(f"\n[{effect}]\n", scenes)
            words = (Path(folder) / "scene.dict").read_text()
            self.assertIn('"[erosion]"', words)
            self.assertIn('"\\"gradient-plane\\""', words)


if __name__ == "__main__":
    unittest.main()
