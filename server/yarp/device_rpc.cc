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
#include "server/yarp/sensor_samples.h"
#include "server/yarp/struct_writer.h"

namespace coopdyn {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
constexpr const char* kNoFeatures = "this camera has no features such as brightness: hasFeature tells so";

/// The name of a call, which Thrift cuts at each `_`: up to the word that ends with RPC, else the first word.
/// `at`: where its arguments begin.
std::string CallName(const Bottle& request, std::size_t& at) {
  std::string name;
  for (std::size_t i = 0; i < request.size() && i < 4; ++i) {
    const std::string_view word = request[i].word();
    if (word.empty()) break;
    name += (i == 0 ? "" : "_") + std::string(word);
    at = i + 1;
    if (word.ends_with("RPC")) return name;
  }
  at = 1;
  return std::string(WordAt(request, 0));
}

/// The codes of yarp::dev::ReturnValue that we give.
enum class ReturnCode { kDone = 0, kNotThere = 2 };

/// Answers from what the module tells: asks it one thing, then answers.
class ReadingTranslator : public YarpTranslator {
 public:
  void set_dialect(YarpDialect dialect) final { dialect_ = dialect; }

  Decoded Decode(const Bottle& request) final {
    request_ = request;
    at_ = 1;
    name_ = CallName(request_, at_);
    if (name_ == "getRemoteProtocolVersion") dialect_ = YarpDialect::k4;
    asked_ = true;
    Decoded decoded{DecodeStatus::kMessage, 0, {}};
    decoded.message.command = Reading();
    return decoded;
  }

  std::optional<Message> Next(const Message& reply) final {
    return std::exchange(asked_, false) && reply.error == 0 ? Command(reply) : std::nullopt;
  }

  YarpAnswer Reply(const Message& reply) final {
    if (name_ == "getRemoteProtocolVersion" && reply.error == 0) return YarpProtocolVersion();
    if (name_ == "help") return {BottleOf(YarpVocab{"many"}, std::string(Help())), {}};
    if (reply.error != 0) return Fail(reply.text);
    if (std::optional<YarpAnswer> answer = Answer(reply)) return *std::move(answer);
    return Fail("there is no such request here: " + std::string(Help()));
  }

 protected:
  /// What the module is asked for.
  virtual command::Id Reading() const { return command::kPing; }
  /// What the module is then told, if anything.
  virtual std::optional<Message> Command(const Message& /*reading*/) { return std::nullopt; }
  /// The requests that it takes.
  virtual std::string_view Help() const = 0;
  /// From the reply to the reading, or to the command. Nothing: there is no such request.
  virtual std::optional<YarpAnswer> Answer(const Message& reply) = 0;

  const Bottle& request() const { return request_; }
  const std::string& name() const { return name_; }
  std::size_t arguments() const { return at_; }

  static YarpAnswer Fail(const std::string& why) { return {BottleOf(YarpVocab{"fail"}, why), {}}; }
  /// Bytes as they are, and by text the same as a Bottle.
  static YarpAnswer OfBytes(std::string bytes, const Bottle& if_none = {}) {
    YarpDialect dialect = YarpDialect::k3;
    Bottle shown = DecodeBottle(bytes, dialect).value_or(if_none);
    return {std::move(shown), std::move(bytes)};
  }
  /// A code, then what `fill` writes in `fields` fields.
  template <typename Fill>
  YarpAnswer Returned(ReturnCode code, std::size_t fields, const Fill& fill) const {
    std::string bytes;
    YarpStructWriter write(dialect_, bytes);
    if (fields > 0) write.Struct(1 + fields);
    AppendCode(code, write);
    fill(write);
    return OfBytes(std::move(bytes), BottleOf(static_cast<std::int32_t>(code)));
  }
  YarpAnswer Returned(ReturnCode code) const {
    return Returned(code, 0, [](YarpStructWriter&) {});
  }

 private:
  void AppendCode(ReturnCode code, YarpStructWriter& write) const {
    if (dialect_ == YarpDialect::k3) return write.Int(static_cast<std::int32_t>(code));
    write.Struct(1);
    write.Vocab(code == ReturnCode::kDone ? "ok" : "err2");
  }

  Bottle request_;
  std::string name_;
  std::size_t at_ = 1;
  bool asked_ = false;  // the module
  YarpDialect dialect_ = YarpDialect::k3;
};

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

/// The frame grabber of YARP 3: [visr] [get] [w]. YARP 4: getRgbWidthRPC.
class CameraTranslator final : public ReadingTranslator {
  command::Id Reading() const override { return command::kGetCamera; }
  std::string_view Help() const override {
    return "visr get w, h, res, fov, intp, conf or mirr; fgi get w or h; or getRgbWidthRPC, getRgbHeightRPC, "
           "getRgbResolutionRPC, getRgbFOVRPC, getRgbSupportedConfigurationsRPC, "
           "getRgbIntrinsicParamRPC, getRgbMirroringRPC";
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    constexpr double kMaxSide = 1e6;
    if (reply.data.size() < 9 || !(reply.data[0] <= kMaxSide) || !(reply.data[1] <= kMaxSide)) return {};
    const auto width = static_cast<std::int32_t>(reply.data[0]),
               height = static_cast<std::int32_t>(reply.data[1]);
    const double fx = reply.data[2], fy = reply.data[3];
    const double across_deg = 2 * std::atan(width / (2 * fx)) / kOneDegree;
    const double down_deg = 2 * std::atan(height / (2 * fy)) / kOneDegree;
    const Bottle lens = Intrinsics(reply);
    const std::string_view device = WordAt(request(), 0), what = WordAt(request(), 2);
    if (std::optional<YarpAnswer> answer = OfFeatures(device, what)) return answer;
    if ((device == "visr" || device == "fgi") && WordAt(request(), 1) == "get") {
      const auto words = [&](auto... values) {
        return YarpAnswer{BottleOf(YarpVocab{std::string(device)}, YarpVocab{std::string(what)},
                                   YarpVocab{"is"}, std::move(values)...),
                          {}};
      };
      if (what == "w") return words(width);
      if (what == "h") return words(height);
      if (device == "fgi") return {};
      if (what == "res") return words(width, height);
      if (what == "fov") return words(across_deg, down_deg);
      if (what == "intp") return words(lens);
      if (what == "mirr") return words(std::int32_t{0});
      if (what == "conf") return words(std::int32_t{1}, width, height, reply.data[8], YarpVocab{"rgb"});
      return {};
    }
    if (name() == "getRgbWidthRPC" || name() == "getWidthRPC") return OneInt(width);
    if (name() == "getRgbHeightRPC" || name() == "getHeightRPC") return OneInt(height);
    if (name() == "getRgbResolutionRPC") {
      return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
        write.Int(width);
        write.Int(height);
      });
    }
    if (name() == "getRgbFOVRPC") {
      return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
        write.Double(across_deg);
        write.Double(down_deg);
      });
    }
    if (name() == "getRgbIntrinsicParamRPC")
      return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) { write.Items(lens); });
    if (name() == "getRgbSupportedConfigurationsRPC") {
      return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) {
        write.Struct(1);  // a list of one
        write.Struct(4);
        write.Int(width);
        write.Int(height);
        write.Double(reply.data[8]);
        write.Int(VocabCode("rgb"));
      });
    }
    if (name() == "getRgbMirroringRPC")
      return Returned(ReturnCode::kDone, 1, [](YarpStructWriter& write) { write.Bool(false); });
    if (name().starts_with("set") && name().ends_with("RPC")) return Returned(ReturnCode::kNotThere);
    return {};
  }

  /// IFrameGrabberControls: a camera here has no brightness, shutter and so on.
  std::optional<YarpAnswer> OfFeatures(std::string_view device, std::string_view what) const {
    if (device == "fgc") {
      if (WordAt(request(), 1) != "has") return Fail(kNoFeatures);
      return YarpAnswer{BottleOf(YarpVocab{"fgc"}, YarpVocab{"has"}, YarpVocab{std::string(what)},
                                 std::int32_t{0}, std::int32_t{0}),
                        {}};
    }
    for (const std::string_view call :
         {"hasFeatureRPC", "hasOnOffRPC", "hasAutoRPC", "hasManualRPC", "hasOnePushRPC"}) {
      if (name() == call)
        return Returned(ReturnCode::kDone, 1, [](YarpStructWriter& write) { write.Bool(false); });
    }
    const auto refused = [this](std::size_t numbers) {
      return Returned(ReturnCode::kNotThere, numbers, [numbers](YarpStructWriter& write) {
        for (std::size_t i = 0; i < numbers; ++i) write.Double(0);
      });
    };
    if (name() == "getFeature1RPC") return refused(1);
    if (name() == "getFeature2RPC") return refused(2);
    if (name() == "getActiveRPC")
      return Returned(ReturnCode::kNotThere, 1, [](YarpStructWriter& write) { write.Bool(false); });
    return {};
  }

  YarpAnswer OneInt(std::int32_t value) const {
    return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) { write.Int(value); });
  }
  /// (focalLengthX 277.1) …: no distortion.
  static Bottle Intrinsics(const Message& camera) {
    Bottle lens;
    const auto add = [&lens](const char* key, double value) {
      lens.emplace_back(BottleOf(std::string(key), value));
    };
    add("physFocalLength", 0);
    add("focalLengthX", camera.data[2]);
    add("focalLengthY", camera.data[3]);
    add("principalPointX", camera.data[4]);
    add("principalPointY", camera.data[5]);
    for (const char* const key : {"k1", "k2", "k3", "t1", "t2"}) add(key, 0);
    lens.emplace_back(BottleOf(std::string("distortionModel"), std::string("none")));
    lens.emplace_back(BottleOf(std::string("stamp"), camera.data[camera.data.size() - 2]));
    return lens;
  }
};

/// Three numbers from the item `at` on.
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

/// Commands of baseControl: KIND (1 percent polar, 2 polar, 3 cartesian), three values, a gain. Two wheels go
/// ahead or back, so of other directions the part ahead counts.
class BaseTranslator final : public ReadingTranslator {
  command::Id Reading() const override { return command::kGetLimits; }
  std::string_view Help() const override {
    return "3 FORWARD SIDEWAYS TURN GAIN, in m/s and degrees/s; or 2 DIRECTION SPEED TURN GAIN, in degrees, "
           "m/s "
           "and degrees/s; 1 is the same in percent";
  }
  std::optional<Message> Command(const Message& limits) override {
    const std::optional<double> kind = request().empty() ? std::nullopt : NumberOf(request()[0]);
    const auto values = ThreeNumbers(request(), 1);
    if (!kind || !values || limits.data.size() < 3 || (*kind != 1 && *kind != 2 && *kind != 3)) return {};
    const auto [first, second, turn] = *values;
    if (*kind == 3) return SetVelocity(first, turn * kOneDegree);
    const double ahead = second * std::cos(first * kOneDegree);
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
    told_ = *values;
    return SetVelocity(told_[0], told_[2] * kOneDegree);
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    if (reply.command == command::kSetVelocity) {
      last_ = told_;
      return Returned(ReturnCode::kDone);
    }
    if (name() != "getLastVelocityCommandRPC") return {};
    return Returned(ReturnCode::kDone, 3, [&](YarpStructWriter& write) {
      for (const double value : {last_[0], 0.0, last_[2]}) write.Double(value);
    });
  }

  std::array<double, 3> told_{}, last_{};
};

}  // namespace

std::unique_ptr<YarpTranslator> MakeDeviceTranslator(YarpTalk talk, std::string_view port,
                                                     const CommandTable& table) {
  switch (talk) {
    case YarpTalk::kMetadata:
      return std::make_unique<MetadataTranslator>(port, table.module());
    case YarpTalk::kAnalog:
      return std::make_unique<AnalogTranslator>();
    case YarpTalk::kLidar:
      return std::make_unique<LidarTranslator>();
    case YarpTalk::kOdometry:
      return std::make_unique<OdometryTranslator>();
    case YarpTalk::kCamera:
      return std::make_unique<CameraTranslator>();
    case YarpTalk::kBase:
      return std::make_unique<BaseTranslator>();
    case YarpTalk::kBaseRpc:
      return std::make_unique<BaseRpcTranslator>();
    default:
      return nullptr;
  }
}

}  // namespace coopdyn
