// SPDX-License-Identifier: MIT
// Reads the sensors of one robot: coopdyn's own elements (by kind in sensors/) and SDF's <sensor>
// (sdf_sensor_elements.cc, sdf_sensor_places.cc). One thread.
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

/// One of coopdyn's own sensor elements, with its context.
struct SensorSource {
  const tinyxml2::XMLElement& element;
  XmlAttributes& attributes;
  const std::string& file;
  const RobotModel& robot;
  const Assembly& assembly;
  Diagnostics& diagnostics;
  SensorTiming& timing;  // output: some presets set it
  mutable bool has_read_children = false;

  /// Index into robot.frames of the link `name`. Reports an error at `from` and returns nullopt if unknown.
  std::optional<std::size_t> FindLink(XmlAttributes& from, const std::string& name) const;
  /// The place given by the attributes `link` (default: the chassis) and `pose` (in the link) of `from`.
  Mount ReadMount(XmlAttributes& from) const;
  /// Calls `read` for each child whose name is in `names`. Reports other children as errors.
  void ForEachChild(std::initializer_list<std::string_view> names,
                    const std::function<void(XmlAttributes& child, std::string_view name)>& read) const;
};

/// Reads the noise of a value from the attributes `prefix`noise_stddev, noise_uniform, bias_mean, bias_stddev
/// and resolution; missing attributes leave `noise` unchanged.
void ReadNoise(XmlAttributes& attributes, const std::string& prefix, ValueNoise& noise);

/// Reads the noise of distance and bearing, for targets and neighbours.
template <typename Kind>
void ReadSightNoise(Kind& sensor, XmlAttributes& attributes) {
  if (auto v = attributes.Number("distance_noise_stddev", 0, kMaxSensorLength_m))
    sensor.distance_noise_stddev_m = *v;
  if (auto v = attributes.Number("bearing_noise_stddev_deg", 0, 180))
    sensor.bearing_noise_stddev_rad = *v * kRadPerDeg;
}

/// The mount at `X_FS` on robot.frames[frame].
Mount MountOn(const RobotModel& robot, std::size_t frame, const Pose& X_FS);
/// The collisions of robot.frames[frame] as parts of a contact sensor; if `name` is given, only that one.
std::vector<ContactModel::Part> CollisionsOf(const RobotModel& robot, const Assembly& assembly,
                                             std::size_t frame, std::string_view name = {});

/// Adds the limiters that the channels in `model` (`<model>`) name. @pre all other joints and muscles are
/// complete
void ReadLimiters(const tinyxml2::XMLElement& model, RobotModel& robot);
/// Looks up the modules and motors that a channel of `robot` names. Call it when `robot` has all of them.
void Connect(ChannelModel& channel, const RobotModel& robot, const std::string& file,
             Diagnostics& diagnostics);

/// The frame in whose axes a wrench is measured.
enum class WrenchFrame { kChild, kParent, kSensor };
std::optional<WrenchFrame> ParseWrenchFrame(std::string_view word);
/// Sets the mount of `wrench` at its joint, its part, and the links beyond it. `X_JS`: pose of the sensor in
/// the joint. Returns the error message; empty if the joint is suitable.
std::string AttachWrench(const RobotModel& robot, const Assembly& assembly, WrenchFrame frame,
                         const Pose& X_JS, WrenchModel& wrench);

/// Reads the sensors of one robot: elements such as `<coopdyn:compass>` describe sensors, and a
/// `<coopdyn:module>` gives each its socket. The arguments must outlive it. One thread.
class SensorReader {
 public:
  SensorReader(const std::string& file, RobotModel& robot, const Assembly& assembly, Diagnostics& diagnostics)
      : file_(file), robot_(robot), assembly_(assembly), diagnostics_(diagnostics) {}

  /// The names of all elements that describe a sensor.
  static std::vector<std::string> Elements();

  /// Reads an element that describes a sensor; false if `element` does not. Read all before the first module.
  bool Read(const tinyxml2::XMLElement& element);
  /// Adds the sensor of a module to the robot, described by the element with the module's name, else by the
  /// element without a name.
  void AddModule(XmlAttributes& attributes, const std::string& type, const std::string& name);
  /// Adds SDF's own sensors to the robot, each with its own module.
  void AddElements(bool foreign);
  /// Reports elements that no module has used.
  void Finish();

 private:
  struct Described {
    std::string name;  // of the module; empty: for all modules without their own element
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
