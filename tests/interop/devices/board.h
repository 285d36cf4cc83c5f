// SPDX-License-Identifier: MIT
// A control board, opened by the client of YARP 3 or 4. Methods here hide the differences between the two;
// for the rest use their common interfaces.
#pragma once

#include <yarp/conf/version.h>
#include <yarp/dev/ControlBoardInterfaces.h>
#include <yarp/dev/IAxisInfo.h>
#include <yarp/dev/ICurrentControl.h>
#include <yarp/dev/IEncodersTimed.h>
#include <yarp/dev/IImpedanceControl.h>
#include <yarp/dev/IInteractionMode.h>
#include <yarp/dev/IMotorEncoders.h>
#include <yarp/dev/IPWMControl.h>
#include <yarp/dev/IPreciselyTimed.h>
#include <yarp/dev/PolyDriver.h>

#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

/// Degrees and degrees/s, joints from 0. A refused call returns false or nullopt. Modes are words: pos, vel,
/// … One thread.
class Board {
 public:
  /// `local`: the prefix of the names of its own ports.
  bool Open(const std::string& remote, const std::string& local);
  bool Close() { return driver_.close(); }

  int axes() const { return axes_; }

  std::optional<std::vector<double>> Positions();
  std::optional<std::vector<double>> Speeds();
  /// Of one joint; NaN: refused.
  double Position(int joint);
  double Speed(int joint);
  /// The stamp of the position, seconds.
  double Stamp(int joint);
  /// The speed of a joint, from its positions and their stamps over 0.1 s.
  double MeanSpeed(int joint);

  std::optional<bool> Done();
  std::optional<bool> Done(int joint);
  /// Waits until all joints have stopped.
  bool Arrive();

  std::optional<std::string> Mode(int joint);
  bool SetMode(int joint, const std::string& mode);
  /// Sets the mode of all joints.
  bool SetModes(const std::string& mode);
  /// Waits until the streamed mode is `mode`.
  bool Shows(int joint, const std::string& mode);

  /// Speeds and accelerations of moves to positions.
  bool SetWaySpeeds(const std::vector<double>& speeds);
  std::optional<std::vector<double>> WaySpeeds();
  bool SetWayAccelerations(const std::vector<double>& accelerations);
  std::optional<std::vector<double>> WayAccelerations();

  std::optional<double> VelocityReference(int joint);
  bool Limits(int joint, double& lower, double& upper);
  bool SetLimits(int joint, double lower, double upper);
  /// stif or comp.
  std::optional<std::string> Interaction(int joint);
  bool SetInteraction(int joint, const std::string& mode);
  std::optional<bool> PidEnabled(int joint);

  // Interfaces of the client, not null once it is open.
  yarp::dev::IEncodersTimed* encoders = nullptr;
  yarp::dev::IMotorEncoders* motors = nullptr;
  yarp::dev::IAxisInfo* info = nullptr;
  yarp::dev::IControlLimits* limits = nullptr;
  yarp::dev::IControlMode* modes = nullptr;
  yarp::dev::IPositionControl* position = nullptr;
  yarp::dev::IPositionDirect* direct = nullptr;
  yarp::dev::IVelocityControl* velocity = nullptr;
  yarp::dev::ITorqueControl* torque = nullptr;
  yarp::dev::IImpedanceControl* impedance = nullptr;
  yarp::dev::IInteractionMode* interaction = nullptr;
  yarp::dev::IPidControl* pid = nullptr;
  yarp::dev::IPWMControl* pwm = nullptr;
  yarp::dev::ICurrentControl* current = nullptr;
  yarp::dev::IPreciselyTimed* timed = nullptr;

 private:
  yarp::dev::PolyDriver driver_;
  int axes_ = 0;
};

}  // namespace coopdyn
