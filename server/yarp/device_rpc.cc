// SPDX-License-Identifier: MIT
#include "server/yarp/device_rpc.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "protocol/command_ids.h"
#include "server/base/portable_math.h"
#include "server/yarp/camera_rpc.h"
#include "server/yarp/reading_translator.h"
#include "server/yarp/sensor_samples.h"

namespace coopdyn {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;

class MetadataTranslator final : public ReadingTranslator {
 public:
  MetadataTranslator(std::string_view port, std::string_view kind) {
    const std::string_view module = ParseYarpPortName(port)->module;
    bytes_ = MeasuresMetadata(kind, module.substr(module.rfind('/') + 1));
  }

 private:
  std::string_view Help() const override { return "getMetadata"; }
  std::optional<YarpAnswer> Answer(const Message& /*reply*/) override {
    if (name() != "getMetadata") return {};
    return OfBytes(bytes_);
  }

  std::string bytes_;
};

class AnalogTranslator final : public ReadingTranslator {
  std::string_view Help() const override {
    return "[iana] [cal] and [iana] [calc] CHANNEL, which change nothing";
  }
  std::optional<YarpAnswer> Answer(const Message& /*reply*/) override {
    const std::string_view word = WordAt(request(), 1);
    if (WordAt(request(), 0) != "iana" || !word.starts_with("cal")) return {};
    return YarpAnswer{BottleOf(std::int32_t{0}), {}};  // AS_OK: a simulated sensor has no bias
  }
};

class BatteryTranslator final : public ReadingTranslator {
  std::string_view Help() const override { return "getBatteryInfoRPC"; }
  std::optional<YarpAnswer> Answer(const Message& /*reply*/) override {
    if (name() != "getBatteryInfoRPC") return {};
    return Returned(ReturnCode::kDone, 1,
                    [](YarpStructWriter& write) { write.String("a battery of coopdyn"); });
  }
};

class OdometryTranslator final : public ReadingTranslator {
  std::string_view Help() const override { return "reset_odometry_RPC, which is refused"; }
  std::optional<YarpAnswer> Answer(const Message& /*reply*/) override {
    if (name() != "reset_odometry_RPC") return {};
    return Returned(ReturnCode::kNotThere);
  }
};

class LidarTranslator final : public ReadingTranslator {
  command::Id Reading() const override { return command::kGetScanGeometry; }
  std::string_view Help() const override {
    return "getDistanceRange_RPC, getScanLimits_RPC, getHorizontalResolution_RPC, getDeviceStatus_RPC, "
           "getDeviceInfo_RPC";
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    constexpr std::int32_t kInUse = 1;
    const std::optional<ScanLimits> limits = ReadScanGeometry(reply);
    if (!limits) return {};
    const auto two = [this](double first, double second) {
      return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
        write.Double(first);
        write.Double(second);
      });
    };
    if (name() == "getDistanceRange_RPC") return two(limits->min_range_m, limits->max_range_m);
    if (name() == "getScanLimits_RPC") return two(limits->first_deg, limits->end_deg);
    if (name() == "getHorizontalResolution_RPC")
      return Returned(ReturnCode::kDone, 1,
                      [&](YarpStructWriter& write) { write.Double(limits->increment_deg); });
    if (name() == "getScanRate_RPC")
      return Returned(ReturnCode::kNotThere, 1, [&](YarpStructWriter& write) { write.Double(0); });
    if (name() == "getDeviceStatus_RPC")
      return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) { write.VocabNumber(kInUse); });
    if (name() == "getDeviceInfo_RPC")
      return Returned(ReturnCode::kDone, 1,
                      [&](YarpStructWriter& write) { write.String("a lidar of coopdyn"); });
    if (name().starts_with("set") && name().ends_with("_RPC")) return Returned(ReturnCode::kNotThere);
    return {};
  }
};

/// Three numbers from index `at` on.
std::optional<std::array<double, 3>> ThreeNumbers(const Bottle& request, std::size_t at) {
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = at + i < request.size() ? NumberOf(request[at + i]) : std::nullopt;
    if (!number) return {};
    numbers[i] = *number;
  }
  return numbers;
}

Message SetVelocity(double forward_m_s, double turn_rad_s) {
  Message command;
  command.command = command::kSetVelocity;
  command.data = {forward_m_s, turn_rad_s};
  return command;
}

/// Commands of baseControl: KIND (1 percent polar, 2 polar, 3 cartesian), three values, a gain. A two-wheeled
/// drive moves only forward and backward, so only the forward component of a direction counts.
class BaseTranslator final : public ReadingTranslator {
  command::Id Reading() const override { return command::kGetLimits; }
  std::string_view Help() const override {
    return "3 FORWARD SIDEWAYS TURN GAIN, in m/s and degrees/s; or 2 DIRECTION SPEED TURN GAIN, in degrees, "
           "m/s and degrees/s; 1 is the same in percent";
  }
  std::optional<Message> Command(const Message& limits) override {
    const std::optional<double> kind = request().empty() ? std::nullopt : NumberOf(request()[0]);
    const auto values = ThreeNumbers(request(), 1);
    if (!kind || !values || limits.data.size() < 3 || (*kind != 1 && *kind != 2 && *kind != 3)) return {};
    const auto [first, second, turn] = *values;
    if (*kind == 3) return SetVelocity(first, turn * kOneDegree);
    const double ahead = second * portable::Cos(first * kOneDegree);
    if (*kind == 2) return SetVelocity(ahead, turn * kOneDegree);
    const double max_speed = limits.data[0] * limits.data[1], track = limits.data[2];
    return SetVelocity(ahead / 100 * max_speed, turn / 100 * 2 * max_speed / track);
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    if (reply.command != command::kSetVelocity) return {};
    return YarpAnswer{BottleOf(YarpVocab{"ok"}), {}};
  }
};

/// mobileBaseVelocityControl.
class BaseRpcTranslator final : public ReadingTranslator {
  std::string_view Help() const override {
    return "applyVelocityCommandRPC FORWARD SIDEWAYS TURN TIMEOUT, in m/s and degrees/s, and "
           "getLastVelocityCommandRPC";
  }
  std::optional<Message> Command(const Message& /*reading*/) override {
    const auto values = ThreeNumbers(request(), arguments());
    if (name() != "applyVelocityCommandRPC" || !values) return {};
    setpoint_ = *values;
    return SetVelocity(setpoint_[0], setpoint_[2] * kOneDegree);
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    if (reply.command == command::kSetVelocity) {
      last_ = setpoint_;
      return Returned(ReturnCode::kDone);
    }
    if (name() != "getLastVelocityCommandRPC") return {};
    return Returned(ReturnCode::kDone, 3, [&](YarpStructWriter& write) {
      for (const double value : {last_[0], 0.0, last_[2]}) write.Double(value);
    });
  }

  std::array<double, 3> setpoint_{}, last_{};
};

}  // namespace

std::unique_ptr<YarpTranslator> MakeDeviceTranslator(YarpTalk talk, std::string_view port,
                                                     const CommandTable& table) {
  switch (talk) {
    case YarpTalk::kMetadata:
      return std::make_unique<MetadataTranslator>(port, table.module());
    case YarpTalk::kAnalog:
      return std::make_unique<AnalogTranslator>();
    case YarpTalk::kBattery:
      return std::make_unique<BatteryTranslator>();
    case YarpTalk::kLidar:
      return std::make_unique<LidarTranslator>();
    case YarpTalk::kOdometry:
      return std::make_unique<OdometryTranslator>();
    case YarpTalk::kCamera:
      return MakeCameraTranslator();
    case YarpTalk::kBase:
      return std::make_unique<BaseTranslator>();
    case YarpTalk::kBaseRpc:
      return std::make_unique<BaseRpcTranslator>();
    default:
      return nullptr;
  }
}

}  // namespace coopdyn
