// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "board.h"
#include "sections.h"

namespace coopdyn {
namespace {

// Gravity exerts no torque on either joint.
constexpr int kBase = 0, kTool = 5;

void CheckTorques(Checks& checks, Board& board) {
  double lower = NAN, upper = NAN;
  board.torque->getTorqueRange(kTool, &lower, &upper);
  checks.AllNear("torque range", std::array{lower, upper}, std::array{-10.0, 10.0}, 0.01);
  std::vector<double> values(6, NAN);
  checks.That("torques", bool(board.torque->getTorques(values.data())) && std::isfinite(values[1]));
  checks.That("torque mode", board.SetMode(kBase, "torq") && board.Shows(kBase, "torq"),
              board.Mode(kBase).value_or("refused"));
  double reference = NAN, torque = NAN;
  // The streamed command has arrived once its reference is there.
  const auto told = [&](double goal) {
    return WaitFor([&] {
      return bool(board.torque->getRefTorque(kBase, &reference)) && std::abs(reference - goal) < 1e-6;
    });
  };
  const bool pushed = bool(board.torque->setRefTorque(kBase, 0.2));
  checks.That("setRefTorque, one", pushed && told(0.2), Text(reference));
  checks.That("the joint gains speed", WaitFor([&] { return board.Speed(kBase) > 5; }),
              Text(board.Speed(kBase)));
  board.torque->getTorque(kBase, &torque);
  checks.Near("its torque", torque, 0.2, 0.01);
  checks.That("torque to position in motion",
              board.SetMode(kBase, "pos") && board.Shows(kBase, "pos") &&
                  WaitFor([&] { return std::abs(board.Speed(kBase)) < 0.5; }),
              Text(board.Speed(kBase)));
  const std::array joints{kBase};
  checks.That("setRefTorques, group",
              board.SetMode(kBase, "torq") &&
                  bool(board.torque->setRefTorques(1, joints.data(), std::array{-0.2}.data())) &&
                  told(-0.2) && WaitFor([&] { return board.Speed(kBase) < -5; }),
              Text(board.Speed(kBase)));
  const std::vector<double> none(6, 0.0);
  checks.That("setRefTorques, all",
              bool(board.torque->setRefTorques(none.data())) && told(0) && board.Shows(kTool, "torq"),
              Text(reference));
  checks.That("idle", board.SetMode(kTool, "idl") && board.Shows(kTool, "idl"),
              board.Mode(kTool).value_or("refused"));
  board.SetModes("pos");
  board.position->positionMove(none.data());
  checks.That("home", board.Arrive(), "not within 10 s: " + Text(*board.Positions()));
}

void CheckImpedance(Checks& checks, Board& board) {
  checks.That("stiff at first", board.Interaction(kTool) == "stif",
              board.Interaction(kTool).value_or("refused"));
  double stiffness = NAN, damping = NAN;
  checks.That("impedance", bool(board.impedance->getImpedance(kTool, &stiffness, &damping)) && stiffness > 0);
  checks.That("impedance, set", bool(board.impedance->setImpedance(kTool, 0.5, 0.05)));
  board.impedance->getImpedance(kTool, &stiffness, &damping);
  checks.AllNear("impedance, read back", std::array{stiffness, damping}, std::array{0.5, 0.05}, 1e-6);
  const auto shows = [&](const std::string& mode) {
    return board.SetInteraction(kTool, mode) && WaitFor([&] { return board.Interaction(kTool) == mode; });
  };
  checks.That("compliant", shows("comp"), board.Interaction(kTool).value_or("refused"));
  checks.That("an offset of torque", bool(board.impedance->setImpedanceOffset(kTool, 1)));
  // 1 N m against 0.5 N m/degree.
  checks.That("it gives way by the stiffness",
              WaitFor([&] { return std::abs(board.Position(kTool) - 2) < 0.1; }),
              Text(board.Position(kTool)));
  board.impedance->getImpedanceOffset(kTool, &damping);
  checks.Near("the offset, read back", damping, 1, 1e-6);
  double limits[4] = {NAN, NAN, NAN, NAN};
  checks.That("impedance limits", bool(board.impedance->getCurrentImpedanceLimit(kTool, limits, limits + 1,
                                                                                 limits + 2, limits + 3)) &&
                                      limits[1] > 0.5);
  board.impedance->setImpedanceOffset(kTool, 0);
  checks.That("stiff again", shows("stif") && WaitFor([&] { return std::abs(board.Position(kTool)) < 0.1; }),
              Text(board.Position(kTool)));
}

void CheckPids(Checks& checks, Board& board) {
  constexpr auto kPosition = yarp::dev::PidControlTypeEnum::VOCAB_PIDTYPE_POSITION;
  yarp::dev::Pid first, changed, seen;
  checks.That("gains", bool(board.pid->getPid(kPosition, kTool, &first)) && first.kp > 0, Text(first.kp));
  changed = first;
  changed.kp += 1;
  changed.ki = 0.25;
  checks.That("gains, set", bool(board.pid->setPid(kPosition, kTool, changed)));
  board.pid->getPid(kPosition, kTool, &seen);
  checks.AllNear("gains, read back", std::array{seen.kp, seen.ki, seen.kd},
                 std::array{changed.kp, changed.ki, changed.kd}, 1e-6);
  board.position->positionMove(kTool, 20);
  board.Arrive();
  double value = NAN;
  board.pid->getPidReference(kPosition, kTool, &value);
  checks.Near("the PID's reference", value, 20, 1e-6);
  board.pid->getPidError(kPosition, kTool, &value);
  checks.Near("its error", value, 0, 0.2);
  checks.That("its output", bool(board.pid->getPidOutput(kPosition, kTool, &value)));
  checks.That("it is on", board.PidEnabled(kTool) == true, "off");
  std::vector<yarp::dev::Pid> all(6);
  checks.That("gains of all", bool(board.pid->getPids(kPosition, all.data())) && all[kTool].kp == changed.kp);
  checks.That("gains of all, set back", bool(board.pid->setPid(kPosition, kTool, first)) &&
                                            bool(board.pid->getPid(kPosition, kTool, &seen)) &&
                                            seen.kp == first.kp);
  checks.That("gains of torques are refused",
              !board.pid->getPid(yarp::dev::PidControlTypeEnum::VOCAB_PIDTYPE_TORQUE, kTool, &seen), "told");
}

void CheckRefusals(Checks& checks, Board& board) {
  double value = NAN, upper = NAN;
  for (const char* const mode : {"ipwm", "icur", "mix"}) {
    checks.That("mode " + std::string(mode) + " is refused",
                !board.SetMode(0, mode) && board.Mode(0) == "pos", board.Mode(0).value_or("refused"));
  }
  checks.That("getDutyCycle is refused", !board.pwm->getDutyCycle(0, &value), Text(value));
  checks.That("getRefDutyCycle is refused", !board.pwm->getRefDutyCycle(0, &value), Text(value));
  checks.That("getCurrent is refused", !board.current->getCurrent(0, &value), Text(value));
  checks.That("getRefCurrent is refused", !board.current->getRefCurrent(0, &value), Text(value));
  checks.That("getCurrentRange is refused", !board.current->getCurrentRange(0, &value, &upper), Text(value));
  checks.That("joint 9 is refused", !board.position->positionMove(9, 1), "taken");
  // Streamed commands have no reply: a refused one must change nothing.
  board.pwm->setRefDutyCycle(0, 50);
  board.current->setRefCurrent(0, 5);
  const double stamp_s = board.Stamp(0);
  WaitFor([&] { return board.Stamp(0) > stamp_s + 0.2; });
  checks.That("streamed PWM and current change nothing",
              board.Mode(0) == "pos" && std::abs(board.Position(0)) < 0.2,
              board.Mode(0).value_or("refused") + " " + Text(board.Position(0)));
  Board other;
  const std::vector<double> there(6, 10.0);
  if (checks.That("a second program opens the board", other.Open("/arm1/arm", "/others/board")))
    checks.That("it may not drive it", !other.position->positionMove(there.data()), "taken");
  other.Close();
}

}  // namespace

void CheckForces(Checks& checks) {
  Board board;
  if (!checks.That("open", board.Open("/arm1/arm", "/devices/board"))) return;
  board.SetWaySpeeds(std::vector<double>(6, 60));
  CheckTorques(checks, board);
  CheckImpedance(checks, board);
  CheckPids(checks, board);
  CheckRefusals(checks, board);
  checks.That("close", board.Close());
}

}  // namespace coopdyn
