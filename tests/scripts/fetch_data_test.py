"""scripts/fetch-data against a server on this machine: it takes what the checksums name, and nothing else."""
import functools
import hashlib
import http.server
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "fetch-data"
MANIFEST = ROOT / "scripts" / "heads" / "manifest.txt"
FILES = {"a.bin": b"first slice", "b.bin": bytes(range(256)) * 300}
AT = "owner/repository/commit/slices"


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def do_GET(self):
        self.server.asked.append(self.path)
        super().do_GET()


class FetchData(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-fetch-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.served = self.folder / "served"
        (self.served / AT).mkdir(parents=True)
        for name, data in FILES.items():
            (self.served / AT / name).write_bytes(data)
        self.out = self.folder / "out"
        self.manifest = self.folder / "manifest.txt"
        self.manifest.write_text(f"# a comment\n@ head {AT} free to use\n"
                                 + "".join(f"{hashlib.sha256(data).hexdigest()}  {name}\n" for name, data in FILES.items()))
        self.serve(self.served)

    def serve(self, folder):
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
        self.server.asked = []
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)

    def run_it(self, *arguments, manifest=None):
        environment = {key: value for key, value in os.environ.items() if not key.lower().endswith("_proxy") and key != "BURRHOLE_DATA"}
        return subprocess.run([sys.executable, str(SCRIPT), str(self.out), "--server", f"http://127.0.0.1:{self.server.server_port}",
                               "--manifest", str(manifest or self.manifest), *arguments],
                              capture_output=True, text=True, timeout=300, env=environment, check=False)

    def test_files_arrive_byte_for_byte_with_licence_and_the_next_step(self):
        self.assertEqual(self.run_it("--check").returncode, 1)
        self.assertEqual(self.server.asked, [])
        result = self.run_it()
        self.assertEqual(result.returncode, 0, result.stderr)
        for name, data in FILES.items():
            self.assertEqual((self.out / "head" / name).read_bytes(), data)
        self.assertIn("licence: free to use", result.stderr)
        self.assertIn(f"export BURRHOLE_DATA={self.out}", result.stderr)
        self.assertTrue(any((self.out / "licences").iterdir()))
        self.assertEqual(self.run_it("--check").returncode, 0)

    def test_what_is_there_is_not_fetched_again_and_what_was_changed_is(self):
        self.assertEqual(self.run_it().returncode, 0)
        self.server.asked.clear()
        self.assertEqual(self.run_it().returncode, 0)
        self.assertEqual(self.server.asked, [])
        (self.out / "head" / "a.bin").write_bytes(b"other")
        self.assertIn("a.bin: differs", self.run_it("--check").stderr)
        self.assertEqual(self.run_it().returncode, 0)
        self.assertEqual(self.server.asked, [f"/{AT}/a.bin"])
        self.assertEqual((self.out / "head" / "a.bin").read_bytes(), FILES["a.bin"])

    def test_a_file_with_another_checksum_is_refused_and_not_kept(self):
        (self.served / AT / "b.bin").write_bytes(FILES["b.bin"][:-1])
        result = self.run_it()
        self.assertEqual(result.returncode, 1)
        self.assertIn("b.bin: has another sha256", result.stderr)
        self.assertFalse((self.out / "head" / "b.bin").exists())
        self.assertEqual(list(self.out.rglob("*.part")), [])

    def test_a_missing_file_and_a_missing_server_are_one_line(self):
        (self.served / AT / "a.bin").unlink()
        result = self.run_it()
        self.assertEqual(result.returncode, 1)
        self.assertIn("a.bin: 404", result.stderr.splitlines()[-1])
        self.server.shutdown()
        self.server.server_close()
        result = self.run_it()
        self.assertEqual(result.returncode, 1)
        self.assertNotIn("Traceback", result.stderr)

    def test_a_damaged_manifest_is_refused(self):
        self.manifest.write_text("0123  a.bin\n")
        result = self.run_it()
        self.assertEqual(result.returncode, 1)
        self.assertIn("manifest.txt:1:", result.stderr)

    def test_the_shipped_manifest_names_the_real_files(self):
        """Serves the real data under the paths of the manifest; each file is 40 kB to 530 kB."""
        data = os.environ.get("BURRHOLE_DATA")
        if not data or not (pathlib.Path(data) / "head_ct_raw_big_endian").is_dir():
            self.skipTest("the scans are not there")
        served = self.folder / "published"
        for line in MANIFEST.read_text().splitlines():
            if line.startswith("@"):
                _, folder, path, _ = line.split(maxsplit=3)
                (served / path).parent.mkdir(parents=True)
                (served / path).symlink_to(pathlib.Path(data).resolve() / folder)
        self.serve(served)
        result = self.run_it(manifest=MANIFEST)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len([path for path in self.out.glob("head_*/*") if path.is_file()]), 163)
        self.assertTrue((self.out / "head_ct_raw_big_endian" / "Announcement.txt").exists())
        self.assertTrue((self.out / "licences" / "dcm_qa_ct-BSD-2.txt").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
