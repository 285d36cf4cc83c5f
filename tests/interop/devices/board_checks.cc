// SPDX-License-Identifier: MIT
#include <yarp/os/Stamp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "board.h"
#include "sections.h"

namespace coopdyn {
namespace {

constexpr double kClose_deg = 0.2;
const std::vector<double> kHome(6, 0.0);

void CheckDescription(Checks& checks, Board& board) {
  checks.That("axes", board.axes() == 6, std::to_string(board.axes()));
  std::string name;
  checks.That("axis name", board.info->getAxisName(5, name) && name == "joint_6", name);
  auto type = yarp::dev::JointTypeEnum::VOCAB_JOINTTYPE_UNKNOWN;
  checks.That("joint type", board.info->getJointType(0, type) &&
                                type == yarp::dev::JointTypeEnum::VOCAB_JOINTTYPE_REVOLUTE);
  double lower = NAN, upper = NAN;
  board.Limits(2, lower, upper);
  checks.AllNear("position limits", std::array{lower, upper}, std::array{-110.0, 70.0}, 0.01);
  lower = upper = NAN;
  board.limits->getVelLimits(0, &lower, &upper);
  checks.AllNear("velocity limits", std::array{lower, upper}, std::array{0.0, 250.0}, 0.01);
  checks.That("position limits cannot be set", !board.SetLimits(0, -1, 1), "taken");
  checks.That("velocity limits cannot be set", !board.limits->setVelLimits(0, 0, 1), "taken");
}

void CheckEncoders(Checks& checks, Board& board) {
  WaitFor([&] { return std::ranges::all_of(*board.Speeds(), [](double v) { return std::abs(v) < 0.1; }); });
  checks.AllNear("encoders", board.Positions().value_or(std::vector<double>()), kHome, kClose_deg);
  checks.AllNear("encoder speeds", board.Speeds().value_or(std::vector<double>()), kHome, 1);
  std::vector<double> values(6, NAN);
  checks.That("encoder accelerations", bool(board.encoders->getEncoderAccelerations(values.data())));
  values.assign(6, NAN);
  board.motors->getMotorEncoders(values.data());
  checks.AllNear("motor encoders", values, kHome, kClose_deg);
  const double before_s = SimulatedTime(), stamp_s = board.Stamp(0), after_s = SimulatedTime();
  // A sample may have waited a little for its reader.
  checks.That("stamps are simulated time", stamp_s > before_s - 0.5 && stamp_s <= after_s,
              Text(stamp_s) + ", not between " + Text(before_s) + " and " + Text(after_s));
  checks.Near("stamps are whole steps", std::remainder(stamp_s, 0.01), 0, 1e-6);
  checks.That("stamps go on", WaitFor([&] { return board.Stamp(0) > stamp_s; }), Text(stamp_s));
  const yarp::os::Stamp last = board.timed->getLastInputStamp();
  checks.That("last stamp", last.isValid() && last.getTime() >= stamp_s, Text(last.getTime()));
  checks.That("encoders cannot be set", !board.encoders->setEncoder(0, 3), "taken");
}

void CheckPositions(Checks& checks, Board& board) {
  const std::vector<double> speeds{60, 60, 60, 60, 60, 60}, accelerations(6, 300),
      goal{30, -20, 10, 25, -30, 40};
  checks.That("ways' speeds, set", board.SetWaySpeeds(speeds));
  checks.AllNear("ways' speeds", board.WaySpeeds().value_or(std::vector<double>()), speeds, 1e-6);
  checks.That("ways' accelerations, set", board.SetWayAccelerations(accelerations));
  checks.AllNear("ways' accelerations", board.WayAccelerations().value_or(std::vector<double>()),
                 accelerations, 1e-6);

  checks.That("position mode", board.SetModes("pos") && board.Shows(5, "pos"),
              board.Mode(5).value_or("refused"));
  checks.That("at rest motion is done", board.Done() == true, "false");
  checks.That("positionMove, all", bool(board.position->positionMove(goal.data())));
  checks.That("motion is not done at once", board.Done() == false, "true");
  checks.That("motion is done at the end", board.Arrive(), "not within 10 s");
  const auto arrived = [&](const std::string& name, const std::vector<double>& at) {
    WaitFor([&] { return std::ranges::all_of(*board.Speeds(), [](double v) { return std::abs(v) < 0.5; }); });
    checks.AllNear(name, board.Positions().value_or(std::vector<double>()), at, kClose_deg);
  };
  arrived("positionMove, all: arrived", goal);
  std::vector<double> values(6, NAN);
  board.position->getTargetPositions(values.data());
  checks.AllNear("targets", values, goal, 1e-6);

  double fastest = 0;
  checks.That("positionMove, one", bool(board.position->positionMove(0, -40)));
  WaitFor([&] {
    fastest = std::max(fastest, std::abs(board.Speed(0)));
    return board.Done(0).value_or(false);
  });
  checks.Near("a way's speed", fastest, 60, 2);
  arrived("positionMove, one: arrived", {-40, -20, 10, 25, -30, 40});

  const std::array joints{0, 3};
  checks.That(
      "positionMove, group",
      bool(board.position->positionMove(2, joints.data(), std::array{5.0, 15.0}.data())) && board.Arrive());
  arrived("positionMove, group: arrived", {5, -20, 10, 15, -30, 40});
  checks.That("relativeMove, one", bool(board.position->relativeMove(4, 12)) && board.Arrive());
  arrived("relativeMove, one: arrived", {5, -20, 10, 15, -18, 40});
  checks.That(
      "relativeMove, group",
      bool(board.position->relativeMove(2, joints.data(), std::array{-5.0, 5.0}.data())) && board.Arrive());
  arrived("relativeMove, group: arrived", {0, -20, 10, 20, -18, 40});
  const std::vector<double> back{0, 20, -10, -20, 18, -40};
  checks.That("relativeMove, all", bool(board.position->relativeMove(back.data())) && board.Arrive());
  arrived("relativeMove, all: arrived", kHome);

  board.position->positionMove(0, 160);
  WaitFor([&] { return board.Speed(0) > 20; });
  checks.That("stop on the way",
              bool(board.position->stop(0)) && WaitFor([&] { return std::abs(board.Speed(0)) < 0.5; }) &&
                  std::abs(board.Position(0)) < 100,
              Text(board.Position(0)));
  checks.That("stopped, motion is done", board.Arrive(), "not within 10 s");
  checks.That("stopped, it goes on", bool(board.position->positionMove(0, 0)) && board.Arrive());
  board.position->positionMove(0, 300);
  board.Arrive();
  checks.Near("a target beyond the limit", board.Position(0), 165, kClose_deg);
  board.position->positionMove(kHome.data());
  board.Arrive();
}

void CheckDirect(Checks& checks, Board& board) {
  checks.That("direct mode", board.SetModes("posd") && board.Shows(5, "posd"),
              board.Mode(5).value_or("refused"));
  bool sent = true;
  for (int i = 1; i <= 50; ++i) {
    sent = sent && board.direct->setPosition(0, 0.2 * i);
    Sleep(0.01);
  }
  const auto reaches = [&](int joint, double goal) {
    return WaitFor([&] { return std::abs(board.Position(joint) - goal) < kClose_deg; });
  };
  checks.That("setPosition", sent && reaches(0, 10), Text(board.Position(0)));
  double reference = NAN;
  board.direct->getRefPosition(0, &reference);
  checks.Near("getRefPosition", reference, 10, 1e-6);
  std::vector<double> goal(6, 0.0);
  for (int i = 1; i <= 50; ++i) {
    goal.assign(6, 0.1 * i);
    sent = sent && board.direct->setPositions(goal.data());
    Sleep(0.01);
  }
  checks.That("setPositions, all", sent && reaches(0, 5) && reaches(5, 5), Text(*board.Positions()));
  const std::array joints{1, 5};
  sent = bool(board.direct->setPositions(2, joints.data(), std::array{4.0, 6.0}.data()));
  checks.That("setPositions, group", sent && reaches(1, 4) && reaches(5, 6) && reaches(2, 5),
              Text(*board.Positions()));
}

void CheckVelocities(Checks& checks, Board& board) {
  checks.That("velocity mode", board.SetModes("vel") && board.Shows(5, "vel"),
              board.Mode(5).value_or("refused"));
  const auto turns = [&](const std::string& name, bool sent, int joint, double speed) {
    WaitFor([&] { return std::abs(board.Speed(joint) - speed) < 0.5; });
    checks.Near(name, sent ? board.MeanSpeed(joint) : NAN, speed, 0.5);
  };
  turns("velocityMove, one", bool(board.velocity->velocityMove(0, 20)), 0, 20);
  checks.Near("the velocity's reference", board.VelocityReference(0).value_or(NAN), 20, 1e-6);
  checks.That("stop, one",
              bool(board.velocity->stop(0)) && WaitFor([&] { return std::abs(board.Speed(0)) < 0.1; }),
              Text(board.Speed(0)));
  const std::vector<double> all(6, -8);
  turns("velocityMove, all", bool(board.velocity->velocityMove(all.data())), 5, -8);
  turns("velocityMove, all: the first", true, 0, -8);
  const std::array joints{0, 4};
  const std::array pair{15.0, 12.0};
  turns("velocityMove, group", bool(board.velocity->velocityMove(2, joints.data(), pair.data())), 4, 12);
  turns("velocityMove, group: the others", true, 5, -8);
  checks.That("stop, all",
              bool(board.velocity->stop()) && WaitFor([&] { return std::abs(board.Speed(4)) < 0.1; }),
              Text(board.Speed(4)));
}

void CheckSwitches(Checks& checks, Board& board) {
  board.velocity->velocityMove(0, 30);
  WaitFor([&] { return board.Speed(0) > 25; });
  const double before = board.Position(0);
  checks.That("velocity to position in motion",
              board.SetMode(0, "pos") && board.Shows(0, "pos") &&
                  WaitFor([&] { return std::abs(board.Speed(0)) < 0.5; }),
              Text(board.Speed(0)));
  checks.Near("it stays where it was", board.Position(0), before, 15);
  checks.That("the others keep their mode", board.Mode(1) == "vel", board.Mode(1).value_or("refused"));
  checks.That("a way in the new mode", bool(board.position->positionMove(0, 60)));
  WaitFor([&] { return board.Speed(0) > 20; });
  checks.That("position to velocity in motion",
              board.SetMode(0, "vel") && board.Shows(0, "vel") &&
                  bool(board.velocity->velocityMove(0, -20)) &&
                  WaitFor([&] { return std::abs(board.Speed(0) + 20) < 0.5; }),
              Text(board.Speed(0)));
  checks.That("velocity to direct in motion",
              board.SetMode(0, "posd") && board.Shows(0, "posd") &&
                  WaitFor([&] { return std::abs(board.Speed(0)) < 0.5; }),
              Text(board.Speed(0)));
  checks.That("a move in another mode changes it",
              bool(board.position->positionMove(0, 0)) && board.Shows(0, "pos"),
              board.Mode(0).value_or("refused"));
  board.SetModes("pos");
  board.position->positionMove(kHome.data());
  checks.That("home", board.Arrive(), "not within 10 s");
}

}  // namespace

void CheckBoard(Checks& checks) {
  Board board;
  if (!checks.That("open", board.Open("/arm1/arm", "/devices/board"))) return;
  // By any previous driver.
  board.SetModes("pos");
  board.position->positionMove(kHome.data());
  board.Arrive();
  CheckDescription(checks, board);
  CheckEncoders(checks, board);
  CheckPositions(checks, board);
  CheckDirect(checks, board);
  CheckVelocities(checks, board);
  CheckSwitches(checks, board);
  checks.That("close", board.Close());
}

}  // namespace coopdyn
