#!/usr/bin/python3
"""The Python module on a small experiment: PYTHONPATH, LACUNA_PROGRAM and LACUNA_SOURCE are set."""

import faulthandler
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np

import lacuna

SOURCE = Path(os.environ["LACUNA_SOURCE"])


class PythonModule(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.experiment = cls.folder / "small.yaml"
        template = (SOURCE / "tests/package/small.yaml.in").read_text()
        cls.experiment.write_text(template.replace("EXPERIMENTS", str(SOURCE / "experiments")))
        cls.events = []
        cls.run_ = lacuna.fit(cls.experiment, progress=cls.events.append)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def record(self, name):
        return json.loads((self.folder / "run" / name).read_text())

    def test_parameters_are_those_of_the_record(self):
        model = self.run_.model
        stored = self.record("calibration/calibration.json")["parameters"]
        self.assertTrue(model.usable)
        self.assertEqual([p.name for p in model.parameters], [p["name"] for p in stored])
        self.assertEqual(model.parameters[0].name, "young_modulus")
        self.assertEqual(model.parameters[0].unit, "Pa")
        np.testing.assert_array_equal(model.values, [p["value"] for p in stored])
        np.testing.assert_array_equal(model.intervals[0],
                                      [stored[0]["low_95"], stored[0]["high_95"]])
        # The small experiment may miss the data by too much for an extrapolation.
        limits = [p.get("at_limit") for p in stored]
        self.assertEqual([p.at_limit for p in model.parameters], limits)
        np.testing.assert_array_equal(model.at_limit, np.array(limits, dtype=float))

    def test_progress_is_told(self):
        begun = [event["stage"] for event in self.events if event["event"] == "begin"]
        self.assertEqual(begun[0], "mesh")
        self.assertIn("fit", begun)

    def test_errors_are_those_of_the_record(self):
        stored = self.record("calibration/calibration.json")["recordings"][0]
        (recording,) = self.run_.model.recordings
        self.assertEqual(recording.name, "recording 1")
        for part in ("in_fit", "held_out"):
            errors = getattr(recording, part)
            self.assertEqual(errors.rms, stored[part]["rms_m"])
            self.assertEqual(errors.rms_over_sigma, stored[part]["rms_over_sigma"])
            self.assertEqual(errors.rms_at_measured_places, stored[part]["rms_at_measured_places_m"])
        self.assertGreater(recording.held_out.rms, recording.in_fit.rms)

    def test_motion_has_measured_and_predicted_places(self):
        motion = self.run_.model.motion()
        table = np.genfromtxt(self.folder / "run/calibration/misfit.csv", delimiter=",", names=True)
        self.assertEqual(motion.measured.shape, (41, 8, 3))
        np.testing.assert_array_equal(motion.times, table["time_s"][::8])
        np.testing.assert_array_equal(motion.fitted, table["fitted"][::8] == 1)
        self.assertEqual(motion.fitted.sum(), self.run_.model.recordings[0].in_fit.frames)
        for axis, name in enumerate("xyz"):
            np.testing.assert_array_equal(motion.measured[:, :, axis].ravel(),
                                          table[f"measured_{name}_m"])
            np.testing.assert_allclose((motion.predicted - motion.measured)[:, :, axis].ravel(),
                                       table[f"difference_{name}_m"], rtol=0, atol=1e-15)
        np.testing.assert_array_equal(motion.sigma.ravel(), table["sigma_m"])
        self.assertEqual(motion.sigma.shape, (41, 8))
        with self.assertRaises(IndexError):
            self.run_.model.motion(1)

    def test_a_diagnosis_is_interrupted_resumed_and_read(self):
        def interrupt(event):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            lacuna.diagnose(self.folder / "run", refits=1, progress=interrupt)
        self.assertIsNone(lacuna.open_run(self.folder / "run").model.diagnosis)

        diagnosis = lacuna.diagnose(self.run_, refits=1).model.diagnosis
        stored = self.record("diagnosis/diagnosis.json")
        self.assertEqual(diagnosis.verdict, stored["verdict"])
        self.assertEqual(diagnosis.effects, stored["effects"])
        # What the recording hides.
        self.assertEqual((diagnosis.verdict, diagnosis.effects),
                         ("missing", ["viscoelastic_branch"]))
        self.assertEqual(diagnosis.hypotheses[0].names, ["viscoelastic_branch"])
        self.assertEqual(diagnosis.hypotheses[0].kind, "effect")
        self.assertAlmostEqual(diagnosis.probabilities.sum(), 1)
        self.assertTrue((np.diff(diagnosis.probabilities) <= 0).all())
        # The example reads the same run back and shows it.
        shown = subprocess.run(
            [sys.executable, SOURCE / "experiments/python/diagnose.py", self.experiment, "1"],
            check=True, capture_output=True, text=True, cwd=self.folder).stdout
        self.assertIn("young_modulus", shown)
        self.assertIn("missing: viscoelastic_branch", shown)

    def test_compare_names_the_points(self):
        self.assertEqual(self.run_.model.point_names(), [f"m{k}" for k in range(8)])
        compared = lacuna.compare(self.run_, files_only=True)
        self.assertEqual(compared.model.point_names(), [f"m{k}" for k in range(8)])

    def test_unusable_input_is_an_exception_with_its_place(self):
        with self.assertRaisesRegex(lacuna.InputError, "nowhere"):
            lacuna.open_run(self.folder / "nowhere")
        wrong = self.folder / "wrong.yaml"
        wrong.write_text("use: small.yaml\nmaterial: {law: neo_hooken, young_modulus: 1 kPa}\n")
        with self.assertRaisesRegex(lacuna.InputError, r"wrong\.yaml:2:.*neo_hookean"):
            lacuna.fit(wrong)
        self.assertTrue(issubclass(lacuna.InputError, ValueError))

    def test_a_damaged_run_is_refused(self):
        shutil.copytree(self.folder / "run", self.folder / "damaged")
        record = self.folder / "damaged/calibration/calibration.json"
        record.write_text(record.read_text().replace("young_modulus", "young_modulos"))
        with self.assertRaisesRegex(lacuna.InputError, "damaged.*calibration.json"):
            lacuna.open_run(self.folder / "damaged")

    def test_other_threads_go_on_while_a_run_is_read(self):
        folder = self.folder / "waiting"
        folder.mkdir()
        os.mkfifo(folder / "manifest.json")  # its reader waits until somebody writes
        ended = []

        def read():
            try:
                lacuna.open_run(folder)
            except lacuna.InputError as problem:
                ended.append(str(problem))

        reader = threading.Thread(target=read)
        reader.start()
        with open(folder / "manifest.json", "w") as fifo:
            fifo.write("no manifest")
        reader.join()
        self.assertRegex(ended[0], "manifest.json")


if __name__ == "__main__":
    # A lock that is held while waiting would stop everything.
    faulthandler.dump_traceback_later(600, exit=True)
    unittest.main(verbosity=2)
