# SPDX-License-Identifier: MIT
"""Sources of controllers in YARS's style compile unchanged and drive experiments of the public grammar."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BINARY = Path(os.environ["COOPDYN_BINARY"])
COMMAND = re.search(r"^g\+\+ .*yars.*$", (ROOT / "docs" / "controllers.md").read_text(), re.M).group()

HEADER = r"""
#include <yars/rc/RobotController.hpp>

class Wave : public RobotController {
 public:
  void init();
  void update();
  void reset();
  void close();

 private:
  double gain_, calls_, shift_;
  bool debug_;
  vector<double> seen_;
  string word_;
};
"""

SOURCE = r"""
#include "Wave.h"

using namespace std;

void Wave::init() {
  parameter.set("gain", gain_, 1.0);
  parameter.set("Phase Shift", shift_, 0.0);
  parameter.set("debug", debug_, false);
  parameter.set("word", word_, "none");
  calls_ = 100;
  seen_.resize(sensors.size());
  addLoggable("calls", &calls_);
  addLoggable("motor 0", &motors[0]);
  addLoggable("seen", &seen_);
  if (debug_) printSensorMotorConfiguration();
  cout << "init: " << frequency() << " Hz, shift " << shift_ << ", " << word_ << ", missing "
       << parameter.exists("missing") << ", domain " << motorConfiguration[0].internal[0].max << " "
       << motorConfiguration[0].external[0].max << endl;
}

void Wave::update() {
  calls_ += 1;
  motors[0] = gain_;
  seen_ = sensors;
  clearOsd();
  addLine("on the screen");
  if (parameter.exists("quit after") && calls_ >= parameter.intValue("quit after")) setQuit();
}

void Wave::reset() {
  calls_ = 0;
  cout << "reset" << endl;
}

void Wave::close() { cout << "close" << endl; }

extern "C" RobotController* create() { return new Wave(); }
extern "C" void destroy(RobotController* controller) {}
"""

# Another file of the same library that has the header.
OTHER = '#include <yars/rc/RobotController.h>\nint Unused(RobotController*) { return 1; }\n'

XML = """<rosiml version="0.8.41">
<simulator frequency="100"/>
<environment/>
<robots><robot name="arm">
<body>
<box name="base"><dimension width="0.1" depth="0.1" height="1"/><pose z="0.5"/><physics><mass kg="0"/></physics></box>
<box name="bar"><dimension width="0.1" depth="0.1" height="0.4"/><pose x="0.3" z="0.8"/><physics><mass kg="1"/></physics></box>
</body>
<actuators>
<hinge name="j" type="velocity" mode="active"><source name="base"/><destination name="bar"/><force max="50"/>
<velocity max="4"/><pose z="0.3"/><mapping min="-1" max="1"/></hinge>
</actuators>
<sensors>
<velocity name="v"><object name="j"/><mapping min="-1" max="1"/><domain min="-4" max="4"/></velocity>
<position name="p"><object name="bar"/><mapping min="-1" max="1"/><domain min="-2" max="2"/><coordinates x="true" y="true" z="true"/></position>
</sensors>
<controller module="Wave" frequency="20">
<parameter name="gain" value="0.25"/><parameter name="Phase Shift" value="0.5"/><parameter name="debug" value="true"/>
<parameter name="word" value="left out"/>PARAMETERS
</controller>
</robot></robots>
</rosiml>
"""

# A ball in the air that the same controller pushes with a quarter of 4 N.
MOVING = """<rosiml version="1.0">
<simulator frequency="100" controllerFrequency="20"/>
<movables><movable name="arm" type="moving">
<force max="4"><mapping min="-1" max="1"/></force>
<controller library="Wave"><parameter name="gain" value="0.25"/></controller>
<body><object name="ball" mass="2"><pose z="9"/><sphere radius="0.1"/>
<velocity name="v" auxiliary="false"/></object></body>
</movable></movables>
</rosiml>
"""


class YarsControllersTestCase(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "clients").symlink_to(ROOT / "clients")

    def write(self, parameters=""):
        (self.folder / "wave.xml").write_text(XML.replace("PARAMETERS", parameters))

    def build(self, target):
        (self.folder / "Wave.h").write_text(HEADER)
        (self.folder / "Wave.cpp").write_text(SOURCE)
        (self.folder / "Other.cpp").write_text(OTHER)
        command = COMMAND.replace("Hexapod.cpp", "Wave.cpp Other.cpp").replace("Hexapod.so", target)
        self.assertIn(target, command)
        done = subprocess.run(command.replace("g++ ", "g++ -Wall -Werror "), shell=True, cwd=self.folder, text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def run_experiment(self, *more):
        done = subprocess.run([BINARY, "serve", "wave.xml", "--mode", "free", "--duration", "1", "--no-net", "--summary",
                               "out.json", *more], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        told = json.loads((self.folder / "out.json").read_text())
        return done.stdout + done.stderr, told, {one["name"]: one["value"] for one in told["logged"]}

    def test_it_drives_the_robot_of_its_experiment(self):
        self.build("Wave.so")
        self.write()
        output, told, logged = self.run_experiment()
        self.assertIn("init: 20 Hz, shift 0.5, none, missing 0, domain 4 1\n", output)
        self.assertRegex(output, r"sensors:\n0 = v 0\n1 = p 0\n2 = p 1\n3 = p 2\nmotors:\n0 = j 0\n")
        self.assertRegex(output, r"(?s)init: .*\nreset\n.*close\n")
        self.assertEqual(told["steps"], 100)
        self.assertEqual((logged["arm.calls"], logged["arm.motor_0"]), (20, 0.25))
        self.assertAlmostEqual(logged["arm.seen_0"], 0.25, places=2)
        self.assertEqual(len(logged), 6)

    def test_in_process_and_again_it_is_the_same(self):
        self.build("Wave.so")
        self.write()
        first = self.run_experiment()[2]
        self.assertEqual(self.run_experiment("--controllers", "in-process")[2], first)

    def test_it_may_end_the_run(self):
        self.build("libYarsControllerWave.so")
        self.write('<parameter name="quit after" value="3"/>')
        output, told, logged = self.run_experiment()
        self.assertEqual((logged["arm.calls"], told["steps"]), (3, 11))
        self.assertEqual(told["ended"], "supervisor")
        self.assertIn("controller libYarsControllerWave of arm ends the run", output)

    def test_it_pushes_a_moving_body(self):
        self.build("Wave.so")
        (self.folder / "wave.xml").write_text(MOVING)
        output, told, logged = self.run_experiment()
        self.assertIn("domain 4 1", output)
        seen_s = (logged["arm.calls"] - 1) / 20  # its last update sees what was so far
        self.assertAlmostEqual(logged["arm.seen_0"], 0.25 * 4 / 2 * seen_s, delta=0.005)

    def test_without_it_clients_drive_the_robot(self):
        self.write()
        output, _, logged = self.run_experiment()
        self.assertIn("there is no Wave.so beside the experiment", output)
        self.assertEqual(logged, {})

    def test_what_is_converted_has_it_too(self):
        self.build("Wave.so")
        self.write()
        here = self.run_experiment()[2]
        subprocess.run([BINARY, "convert", "wave.xml", "--out", "mine"], cwd=self.folder, check=True, capture_output=True)
        self.folder /= "mine"
        (self.folder / "wave.scenario").rename(self.folder / "wave.xml.scenario")
        subprocess.run([BINARY, "serve", "wave.xml.scenario", "--mode", "free", "--duration", "1", "--no-net", "--summary",
                        "out.json"], cwd=self.folder, check=True, capture_output=True)
        told = json.loads((self.folder / "out.json").read_text())
        self.assertEqual({one["name"]: one["value"] for one in told["logged"]}, here)


if __name__ == "__main__":
    unittest.main()
