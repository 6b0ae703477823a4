#!/usr/bin/python3
"""Where the installed Python module finds the program: python_program_test.py PACKAGE FOLDER

PACKAGE is the package as it was built, FOLDER where CMake installs it below the prefix.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PACKAGE, FOLDER = sys.argv[1:3]


class ProgramOfTheInstallation(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.prefix = Path(temporary.name).resolve() / "prefix"
        self.program = self.prefix / "bin/lacuna"
        self.program.parent.mkdir(parents=True)
        self.program.write_text("#!/bin/sh\n")
        self.program.chmod(0o755)

    def install(self, folder):
        package = self.prefix / folder / "lacuna"
        shutil.copytree(PACKAGE, package)
        return package

    def found(self, package):
        """What a Python that imports this package takes for the program."""
        environment = {"PYTHONPATH": str(package.parent), "PATH": "/usr/bin:/bin"}
        return subprocess.run([sys.executable, "-c", "import lacuna; print(lacuna.program())"],
                              check=True, capture_output=True, text=True,
                              env=environment).stdout.strip()

    def test_is_that_of_the_prefix(self):
        if Path(FOLDER).is_absolute():
            self.skipTest("the module is not installed below the prefix")
        self.assertEqual(self.found(self.install(FOLDER)), str(self.program))

    def test_is_that_of_the_prefix_at_any_depth(self):
        for folder in ("python", "lib/x86_64-linux-gnu/python3.11/site-packages/of/ours"):
            package = self.install(folder)
            (package / "_installation.py").write_text(
                f"PREFIX = {os.path.relpath(self.prefix, package)!r}\n")
            self.assertEqual(self.found(package), str(self.program))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
