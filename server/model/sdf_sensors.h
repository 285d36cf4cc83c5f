// SPDX-License-Identifier: MIT
// The sensors of one robot: our own elements (the table in sdf_sensors.cc; by kind in sdf_range_sensors.cc,
// sdf_spot_sensors.cc and sdf_body_sensors.cc) and SDF's <sensor> (sdf_sensor_elements.cc,
// sdf_sensor_kinds.cc). One thread.
#pragma once

#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/model/sdf_parts.h"

namespace coopdyn {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;
inline constexpr double kMaxSensorLength_m = 1e5;
inline constexpr int kMaxLidarRays = 1'000'000;
inline constexpr double kMaxSensorRate_hz = 1e6, kMaxSensorDelay_s = 100;

/// One element of ours, and whom to tell what is wrong with it.
struct SensorSource {
  const tinyxml2::XMLElement& element;
  XmlAttributes& attributes;
  const std::string& file;
  const RobotModel& robot;
  const Assembly& assembly;
  Diagnostics& diagnostics;
  SensorTiming& timing;  // a preset may have one
  mutable bool has_read_children = false;

  /// Index into robot.frames of the link `name`; nothing with an error at `from`.
  std::optional<std::size_t> FindLink(XmlAttributes& from, const std::string& name) const;
  /// Where `from` says by `link` and `pose` (in the link) that something is; the chassis by default.
  Mount ReadMount(XmlAttributes& from) const;
  /// Calls `read` for each child called one of `names`; any other is an error.
  void ForEachChild(std::initializer_list<std::string_view> names,
                    const std::function<void(XmlAttributes& child, std::string_view name)>& read) const;
};

/// The noise of a value by the attributes `prefix`noise_stddev, noise_uniform, bias_mean, bias_stddev and
/// resolution; what is not said stays.
void ReadNoise(XmlAttributes& attributes, const std::string& prefix, ValueNoise& noise);

// What an element says of a sensor: one for each kind.
void ReadInto(DistanceModel& sensor, const SensorSource& source);
void ReadInto(TargetModel& sensor, const SensorSource& source);
void ReadInto(PoseModel& sensor, const SensorSource& source);
void ReadInto(NeighboursModel& sensor, const SensorSource& source);
void ReadInto(CompassModel& sensor, const SensorSource& source);
void ReadInto(SupportModel& sensor, const SensorSource& source);
void ReadInto(ImuModel& sensor, const SensorSource& source);
void ReadInto(WrenchModel& sensor, const SensorSource& source);
void ReadInto(LidarModel& sensor, const SensorSource& source);
void ReadInto(ContactModel& sensor, const SensorSource& source);
void ReadInto(SonarModel& sensor, const SensorSource& source);
void ReadInto(InfraredModel& sensor, const SensorSource& source);
void ReadInto(LightModel& sensor, const SensorSource& source);
void ReadInto(CameraModel& sensor, const SensorSource& source);
void ReadInto(BatteryModel& sensor, const SensorSource& source);
void ReadInto(OdometryModel& sensor, const SensorSource& source);
void ReadInto(ChannelModel& sensor, const SensorSource& source);

/// What has to hold of a sensor however it was written; else what to write. Empty if it is good.
std::string WrongIn(const LidarModel& sensor);
std::string WrongIn(const CameraModel& sensor);

/// `X_FS` on robot.frames[frame].
Mount MountOn(const RobotModel& robot, std::size_t frame, const Pose& X_FS);
/// The parts of a contact sensor that are collisions of robot.frames[frame]; with a `name` the one called so
/// alone.
std::vector<ContactModel::Part> CollisionsOf(const RobotModel& robot, const Assembly& assembly,
                                             std::size_t frame, std::string_view name = {});

/// Adds the limiters that the channels in `model` (`<model>`) name; its other joints and muscles are
/// complete.
void ReadLimiters(const tinyxml2::XMLElement& model, RobotModel& robot);
/// Finds the modules and the motors that a channel of `robot` names, once all are there.
void Connect(ChannelModel& channel, const RobotModel& robot, const std::string& file,
             Diagnostics& diagnostics);

/// The orientation in which a wrench is measured.
enum class WrenchFrame { kChild, kParent, kSensor };
std::optional<WrenchFrame> ParseWrenchFrame(std::string_view word);
/// Puts `wrench` between the ends of its joint: its mount, its part and what hangs on that. `X_JS`: of the
/// sensor in the joint. What is wrong with the joint; empty if nothing.
std::string AttachWrench(const RobotModel& robot, const Assembly& assembly, WrenchFrame frame,
                         const Pose& X_JS, WrenchModel& wrench);

/// Reads the sensors of one robot: elements such as `<coopdyn:compass>` say what they are like, and a
/// `<coopdyn:module>` gives each its socket. The arguments outlive it. One thread.
class SensorReader {
 public:
  SensorReader(const std::string& file, RobotModel& robot, const Assembly& assembly, Diagnostics& diagnostics)
      : file_(file), robot_(robot), assembly_(assembly), diagnostics_(diagnostics) {}

  /// The names of all elements that describe a sensor.
  static std::vector<std::string> Elements();

  /// Reads such an element; false if `element` is none. All come before the first module.
  bool Read(const tinyxml2::XMLElement& element);
  /// Gives the robot the sensor of a module, as the element with the module's name says, else the one
  /// without a name.
  void AddModule(XmlAttributes& attributes, const std::string& type, const std::string& name);
  /// Gives the robot the sensors of SDF, each with a module of its own.
  void AddElements(bool foreign);
  /// Reports the elements that no module has used.
  void Finish();

 private:
  struct Described {
    std::string name;  // of the module; empty: any that has none of its own
    SensorKind kind;
    SensorTiming timing;
    SourceLine where;
    bool used = false;
  };

  const std::string& file_;
  RobotModel& robot_;
  const Assembly& assembly_;
  Diagnostics& diagnostics_;
  std::vector<Described> described_;
};

}  // namespace coopdyn
