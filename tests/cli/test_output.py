"""Files that are written: whole or not at all, in each format, in the place that was asked for."""

import contextlib
import json
import os
import resource
import shutil
import struct
import subprocess

from brio_cli import BRIO, CliTest, CUBE, main


class Writing(CliTest):
    @contextlib.contextmanager
    def mounted(self, options):
        """A small file system of its own."""
        if os.geteuid() != 0 or not shutil.which("mount"):
            self.skipTest("mounting a file system needs root")
        folder = self.path("mounted")
        os.mkdir(folder)
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True)
        if mount.returncode:
            self.skipTest("no file system can be mounted here: " + mount.stderr.decode().strip())
        try:
            yield folder
        finally:
            subprocess.run(["umount", folder], check=True)

    def test_full_disk_leaves_nothing(self):
        points = self.cloud("a.ply", 20000)
        with self.mounted("size=64k") as folder:
            for name in ["out.ply", "out.vtu", "out.node"]:
                self.expect(6, "delaunay", points, "-o", os.path.join(folder, name))
            self.assert_only(folder)

    def test_full_disk_keeps_the_old_file(self):
        points = self.cloud("a.ply", 20000)
        with self.mounted("size=64k") as folder:
            old = os.path.join(folder, "out.ply")
            with open(old, "w") as f:
                f.write("old")
            self.expect(6, "delaunay", points, "-o", old)
            self.assert_only(folder, "out.ply")
            with open(old) as f:
                self.assertEqual(f.read(), "old")

    def test_read_only_file_system(self):
        with self.mounted("ro") as folder:
            self.expect(6, "delaunay", self.xyz("a.xyz", CUBE), "-o", os.path.join(folder, "out.ply"))
            self.assert_only(folder)

    def test_protected_folder(self):
        folder = self.path("protected")
        os.mkdir(folder)
        os.chmod(folder, 0o555)
        os.chmod(self.folder, 0o755)
        points = self.xyz("a.xyz", CUBE)
        other = (lambda: (os.setgid(65534), os.setuid(65534))) if os.geteuid() == 0 else None
        run = self.run_brio("--version", preexec_fn=other) if other else None
        if run and run.code:
            self.skipTest("another user cannot run the program")
        self.expect(6, "delaunay", points, "-o", os.path.join(folder, "out.ply"), preexec_fn=other)
        self.assert_only(folder)

    def test_limit_on_the_file_size_leaves_nothing(self):
        points = self.cloud("a.ply", 20000)
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
        self.expect(6, "delaunay", points, "-o", self.path("out.ply"), preexec_fn=limit)
        self.assert_only(self.folder, "a.ply")

    def test_missing_folder_is_told_before_the_work(self):
        run = self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("missing/out.ply"))
        self.assertIn("missing", run.err)

    def test_folder_of_the_output_s_name(self):
        os.mkdir(self.path("out.ply"))
        self.expect(6, "delaunay", self.xyz("a.xyz", CUBE), "-o", self.path("out.ply"))
        self.assert_only(self.path("out.ply"))

    def test_standard_output_that_is_full(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        points = self.cloud("a.ply", 20000)
        with open("/dev/full", "wb") as full:
            self.expect(6, "delaunay", points, "-o", "-", "--format", "ply", stdout=full)
            self.expect(6, "info", points, "--json", stdout=full)
            self.expect(6, "info", points, stdout=full)

    def assert_no_messages_in(self, out, points):
        with open(out, "rb") as f:
            lines = f.read().split(b"\n")
        self.assertTrue(len(lines) == points + 2 and all(line.count(b",") == 2 for line in lines[:-1]))

    def test_streams_that_the_caller_closed_are_not_written_into_the_output(self):
        a, out = self.cloud("a.ply", 200000), self.path("b.csv")
        for closed in (0, 1, 2), (0,), (1,), (2,), (0, 2):
            close = lambda: [os.close(stream) for stream in closed]
            done = self.run_brio("convert", a, out, "--progress", preexec_fn=close)
            self.assertEqual(done.code, 6 if 1 in closed else 0, "a report that has no place to go")
            self.assert_no_messages_in(out, 200000)

    def test_closed_streams_in_a_root_without_devices(self):
        """There is no /dev/null to stand for them: messages went into the output."""
        a, out = self.cloud("a.ply", 20000), self.path("b.csv")
        bare = ["unshare", "-m", "sh", "-c", 'mount -t tmpfs none /dev && exec "$@"', "sh"]
        if subprocess.run([*bare, "true"], stderr=subprocess.DEVNULL).returncode:
            self.skipTest("no root without devices can be made here")
        done = subprocess.run([*bare, "sh", "-c", 'exec "$@" 0<&- 1>&- 2>&-', "sh", BRIO, "convert", a, out, "--progress"], timeout=60)
        self.assertEqual(done.returncode, 6, "the report has no place to go")
        self.assert_no_messages_in(out, 20000)

    def test_report_keeps_away_from_data_by_any_name_of_standard_output(self):
        points = self.xyz("a.xyz", CUBE)
        for name in "-", "/dev/stdout", "/dev/fd/1":
            done = subprocess.run([BRIO, "hull", points, "-o", name, "--format", "off"], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, encoding="utf-8")
            self.assertEqual((done.returncode, done.stdout[:3]), (0, "OFF"))
            self.assertNotIn("volume", done.stdout)
            self.assertIn("volume", done.stderr)
            done = subprocess.run([BRIO, "hull", points, "-o", name, "--format", "off", "--json"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
            self.assertEqual(done.returncode, 1)
            self.assertIn("both want standard output", json.loads(done.stdout)["error"])

    def through_descriptor(self, name, *arguments, mode="ab"):
        """What stands in a file when a command wrote to the open descriptor by a name such as /dev/fd/%d."""
        with open(self.path("old.txt"), "wb") as f:
            f.write(b"OLD\n")
        with open(self.path("old.txt"), mode) as f:
            f.seek(0, os.SEEK_END)
            keep = os.dup(f.fileno())
            self.addCleanup(os.close, keep)
            line = [BRIO, *map(str, arguments), "--quiet"]
            line = [a.replace("OUT", name % keep) for a in line]
            done = subprocess.run(line, pass_fds=[keep], stderr=subprocess.PIPE, cwd=self.folder, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr)
            os.write(keep, b"AFTER\n")
        with open(self.path("old.txt"), "rb") as f:
            return f.read()

    def test_open_descriptors_are_written_at_their_place(self):
        """Each of these names replaced the file that the descriptor had open: what stood there was lost."""
        points = self.xyz("a.xyz", CUBE)
        writers = [("convert", points, "OUT", "--format", "xyz"), ("delaunay", points, "-o", "OUT", "--format", "ply"),
                   ("locate", points, "--at", points, "-o", "OUT", "--format", "csv"),
                   ("voronoi", points, "-o", "/dev/null", "--format", "csv", "--faces", "OUT"),
                   ("alpha", points, "--alpha", "auto", "--filtration", "OUT"),
                   ("hull", points, "-o", "OUT", "--format", "off")]
        for name in "/dev/fd/%d", "/proc/self/fd/%d", "/proc/thread-self/fd/%d":
            for arguments in writers:
                for mode in "ab", "r+b":
                    content = self.through_descriptor(name, *arguments, mode=mode)
                    self.assertRegex(content, rb"(?s)\AOLD\n.{20,}AFTER\n\Z", (name, arguments))
        self.assert_only(self.folder, "a.xyz", "old.txt")

    def test_standard_streams_by_name_keep_what_stands_there(self):
        points = self.xyz("a.xyz", CUBE)
        for stream, name in (1, "/dev/stdout"), (2, "/dev/stderr"):
            with open(self.path("log.txt"), "wb") as log:
                log.write(b"BEFORE\n")
                log.flush()
                how = {"stdout": log} if stream == 1 else {"stderr": log}
                subprocess.run([BRIO, "convert", points, "-o", name, "--format", "xyz", "--quiet"], check=True, **how)
                log.write(b"AFTER\n")
            with open(self.path("log.txt"), "rb") as log:
                self.assertRegex(log.read(), rb"(?s)\ABEFORE\n#.*1 1 1\nAFTER\n\Z")

    def test_descriptor_of_another_process_is_written_at_its_end(self):
        with open(self.path("log.txt"), "wb") as log:
            log.write(b"BEFORE\n")
            log.flush()
            name = "/proc/%d/fd/%d" % (os.getpid(), log.fileno())
            self.expect(0, "convert", self.xyz("a.xyz", CUBE), "-o", name, "--format", "xyz")
        with open(self.path("log.txt"), "rb") as log:
            self.assertRegex(log.read(), rb"(?s)\ABEFORE\n#.*1 1 1\n\Z")

    def test_descriptor_that_cannot_be_written_is_told_before_the_work(self):
        with open(self.xyz("a.xyz", CUBE)) as f:
            done = subprocess.run([BRIO, "hull", "missing.xyz", "-o", "/dev/stdin", "--format", "off"], stdin=f,
                                  stderr=subprocess.PIPE, encoding="utf-8")
        self.assertEqual((done.returncode, done.stderr.count("not open for writing")), (6, 1))

    def test_streams_and_devices_have_no_files_beside_them(self):
        """-o /dev/null --format node made /dev/null.ele."""
        points = self.xyz("a.xyz", CUBE)
        for name in "-", "/dev/stdout", "/dev/null":
            self.usage("cannot hold the two files", "delaunay", points, "-o", name, "--format", "node")
        self.assertFalse(os.path.exists("/dev/null.ele"))

    def test_reader_that_went_away(self):
        points = self.cloud("a.ply", 50000)
        process = subprocess.Popen([BRIO, "delaunay", points, "-o", "-", "--format", "ply"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        process.stdout.close()
        error = process.stderr.read()
        process.stderr.close()
        self.assertEqual(process.wait(), 6, error)

    def test_device_is_written_in_place(self):
        self.expect(0, "delaunay", self.xyz("a.xyz", CUBE), "-o", "/dev/null", "--format", "ply")
        self.assertFalse(os.path.isfile("/dev/null"))

    def test_name_of_the_greatest_length(self):
        points = self.xyz("a.xyz", CUBE)
        name = "n" * 251 + ".ply"
        self.expect(0, "delaunay", points, "-o", self.path(name))
        self.assert_only(self.folder, "a.xyz", name)
        self.expect(6, "delaunay", points, "-o", self.path("n" + name))
        self.assert_only(self.folder, "a.xyz", name)

    def test_link_to_no_file_makes_the_file_that_it_names(self):
        os.mkdir(self.path("sub"))
        os.symlink("sub/file.ply", self.path("link.ply"))
        self.expect(0, "delaunay", self.xyz("a.xyz", CUBE), "-o", self.path("link.ply"))
        self.assertTrue(os.path.islink(self.path("link.ply")))
        self.assert_only(self.path("sub"), "file.ply")

    def test_link_into_a_missing_folder_is_told_before_the_work(self):
        os.symlink("missing/file.ply", self.path("link.ply"))
        run = self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("link.ply"))
        self.assertIn("missing", run.err)
        self.assert_only(self.folder, "link.ply")

    def test_loop_of_links(self):
        for a, b in ["ab", "ba"]:
            os.symlink(b + ".ply", self.path(a + ".ply"))
        self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("a.ply"))
        self.assert_only(self.folder, "a.ply", "b.ply")

    def test_old_file_keeps_its_permissions(self):
        points = self.xyz("a.xyz", CUBE)
        for mode in [0o600, 0o640, 0o755]:
            old = self.file("out.ply", "old")
            os.chmod(old, mode)
            self.expect(0, "delaunay", points, "-o", old)
            self.assertEqual(os.stat(old).st_mode & 0o7777, mode)


class Formats(CliTest):
    def test_text_and_binary_hold_the_same(self):
        for extension in ["ply", "vtu"]:
            for flags in [[], ["--ascii"]]:
                self.expect(0, "generate", "cube", "-n", "100", "-o", self.path("x." + extension), *flags)
                facts = self.facts("delaunay", self.path("x." + extension))
                self.assertEqual(facts["checksum"], self.facts("delaunay", self.cloud("a.xyz", 100))["checksum"])

    def test_single_precision_rounds_the_coordinates(self):
        self.expect(0, "generate", "cube", "-n", "10", "-o", self.path("a.ply"), "--float32", "--ascii")
        with open(self.path("a.ply")) as f:
            header, _, body = f.read().partition("end_header\n")
        self.assertIn("property float x", header)
        for text in body.split():
            value = float(text)
            self.assertAlmostEqual(struct.unpack("f", struct.pack("f", value))[0], value, delta=1e-9)

    def test_compressed_files(self):
        for extension in "vtu", "vtp":
            out, packed = self.path("a." + extension), self.path("b." + extension)
            self.expect(0, "generate", "sphere", "-n", 3000, "-o", out)
            run = self.run_brio("generate", "sphere", "-n", 3000, "-o", packed, "--compress")
            if "without zlib" in run.err:
                self.skipTest("brio was built without zlib")
            self.assertEqual(run.code, 0, run.err)
            self.assertLess(os.path.getsize(packed), os.path.getsize(out))
            self.assertEqual(self.facts("info", out)["box"], self.facts("info", packed)["box"])
        self.usage("cannot be compressed; \.vtu \.vtp \.pcd can", "generate", "sphere", "-n", 9, "-o", "x.ply", "--compress")
        self.usage("text is not compressed", "generate", "sphere", "-n", 9, "-o", "x.vtu", "--compress", "--ascii")
        self.usage("without compression", "voronoi", out, "-o", "x.vtu", "--compress")
        self.usage(".glb files are", "generate", "sphere", "-n", 9, "-o", "x.gltf")

    def test_points_in_a_vtp_file_are_cells(self):
        self.expect(0, "generate", "ball", "-n", 20, "-o", self.path("b.vtp"))
        arrays, piece = self.appended_arrays("b.vtp")
        self.assertEqual((piece["NumberOfVerts"], piece["NumberOfLines"]), ("20", "0"))
        self.assertEqual(arrays["Verts", "connectivity"], tuple(range(20)))
        self.assertEqual(arrays["Verts", "offsets"], tuple(range(1, 21)))


if __name__ == "__main__":
    main()
