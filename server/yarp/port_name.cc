// SPDX-License-Identifier: MIT
#include "server/yarp/port_name.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

constexpr std::string_view kOut = ":o", kAnyModule = "*", kBase = "/base";

struct TakingPort {
  std::string_view end, module;  // kind of module: CommandTable::module()
  YarpTalk talk;
};
// Longer suffixes first.
constexpr TakingPort kTakingPorts[] = {
    {"/analog:o/rpc:i", "wrench", YarpTalk::kAnalog},
    {"/nws/rpc:i", "joints", YarpTalk::kBoardRpc},
    {"/command:i", "joints", YarpTalk::kBoardStream},
    {"/command:i", kAnyModule, YarpTalk::kModule},
    {"/rpc:i", "joints", YarpTalk::kBoardWords},
    {"/rpc:i", "lidar", YarpTalk::kLidar},
    {"/rpc:i", "motors", YarpTalk::kBaseRpc},
    {"/rpc:i", "battery", YarpTalk::kBattery},
    {"/rpc:i", "camera", YarpTalk::kCamera},
    {"/rpc:o", "imu", YarpTalk::kMetadata},
    {"/rpc:o", "wrench", YarpTalk::kMetadata},
    {"/rpc:o", "contact", YarpTalk::kMetadata},
    {"/rpc:o", "joints", YarpTalk::kMetadata},
    {"/rpc:o", "pose", YarpTalk::kMetadata},
    {"/rpc", "camera", YarpTalk::kCamera},
    {"/rpc", "odometry", YarpTalk::kOdometry},
    {"/rpc", "pose", YarpTalk::kOdometry},
};

struct SendingPort {
  std::string_view subject, module;
  command::Id reading;
  YarpSample sample;
};
// Ports that send like YARP's devices; an empty subject means the module's own port.
constexpr SendingPort kSendingPorts[] = {
    {"state", "joints", command::kGetBoard, YarpSample::kBoardPositions},
    {"stateExt", "joints", command::kGetBoard, YarpSample::kBoard},
    {"measures", "joints", command::kGetBoard, YarpSample::kMeasures},
    {"measures", "imu", command::kGetImu, YarpSample::kMeasures},
    {"measures", "wrench", command::kGetWrench, YarpSample::kMeasures},
    {"measures", "contact", command::kGetContacts, YarpSample::kMeasures},
    {"measures", "pose", command::kGetPose3d, YarpSample::kMeasures},
    {"inertial", "imu", command::kGetImu, YarpSample::kInertial},
    {"analog", "wrench", command::kGetWrench, YarpSample::kReading},
    {"", "lidar", command::kGetScan, YarpSample::kLaserScan},
    {"odometry", "odometry", command::kGetOdometry, YarpSample::kOdometry},
    {"odometry", "pose", command::kGetPose, YarpSample::kOdometry},
    {"data", "battery", command::kGetBattery, YarpSample::kBattery},
    {"", "camera", command::kGetImage, YarpSample::kImage},
    {"state", "camera", command::kGetImage, YarpSample::kImage},
    {"image", "camera", command::kGetImage, YarpSample::kImage},
    {"depth", "camera", command::kGetImage, YarpSample::kDepth},
    {"rgbImage", "camera", command::kGetImage, YarpSample::kImage},
    {"depthImage", "camera", command::kGetImage, YarpSample::kDepth},
    {"clock", "simulation", command::kGetClock, YarpSample::kReading},
};

/// Parses "10": a whole number from 1 on.
std::optional<std::int32_t> StepsIn(std::string_view text) {
  std::int32_t steps = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), steps);
  if (error != std::errc() || end != text.data() + text.size() || steps < 1 || steps > kMaxSteps) return {};
  return steps;
}

}  // namespace

bool YarpPortName::IsOf(std::string_view path, const CommandTable& table) const {
  if (module == path) return true;
  if (table.module() != "motors" || !takes || !module.ends_with(kBase)) return false;
  return module.substr(0, module.size() - kBase.size()) == path.substr(0, path.rfind('/'));
}

std::optional<YarpPortName> ParseYarpPortName(std::string_view name) {
  if (name == kYarpClock) return YarpPortName{"/simulation", "clock"};
  if (name == kYarpClockRpc) return YarpPortName{"/simulation", "clock", true};
  if (name == kYarpWorldInterface) return YarpPortName{"/world", "world", true};
  for (const TakingPort& port : kTakingPorts) {
    if (name.ends_with(port.end) && name.size() > port.end.size())
      return YarpPortName{name.substr(0, name.size() - port.end.size()), port.end.substr(1), true};
  }
  YarpPortName port;
  const std::size_t slash = name.rfind('/');
  if (!name.ends_with(kOut) || slash == 0 || slash == std::string_view::npos) return {};
  port.subject = name.substr(slash + 1, name.size() - slash - 1 - kOut.size());
  port.module = name.substr(0, slash);
  if (port.subject.empty()) return {};
  const std::size_t before = port.module.rfind('/');
  if (const auto every = StepsIn(port.module.substr(before + 1)); every && before > 0) {
    port.every = *every;
    port.module = port.module.substr(0, before);
  }
  return port;
}

std::optional<YarpStream> StreamOf(std::string_view name, const CommandTable& table) {
  if (name == kYarpClock) return YarpStream{command::kGetClock, 1, YarpSample::kParams};
  const std::optional<YarpPortName> port = ParseYarpPortName(name);
  const std::int32_t every = port ? port->every : 1;
  const std::string_view subject = port ? port->subject : std::string_view();
  for (const SendingPort& each : kSendingPorts) {
    if (each.subject == subject && each.module == table.module())
      return YarpStream{each.reading, every, each.sample};
  }
  if (!port || subject == "state" || port->takes) return YarpStream{table.first_reading(), every};
  const CommandSpec* const spec = table.Find("get_" + std::string(subject));
  return spec == nullptr ? std::nullopt : std::optional(YarpStream{spec->id, every});
}

std::optional<YarpTalk> TalkOf(std::string_view name, const CommandTable& table) {
  if (name == kYarpClockRpc) return YarpTalk::kClock;
  if (name == kYarpWorldInterface) return YarpTalk::kWorld;
  const std::optional<YarpPortName> port = ParseYarpPortName(name);
  if (!port || !port->takes) return YarpTalk::kModule;
  if (table.module() == "motors" && port->subject == "command:i" && port->module.ends_with(kBase))
    return YarpTalk::kBase;
  if (table.module() == "motors" && port->subject == "rpc:i" && !port->module.ends_with(kBase)) return {};
  for (const TakingPort& each : kTakingPorts) {
    if (each.end.substr(1) == port->subject && (each.module == table.module() || each.module == kAnyModule))
      return each.talk;
  }
  return {};
}

}  // namespace coopdyn
