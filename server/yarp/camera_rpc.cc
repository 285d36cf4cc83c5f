// SPDX-License-Identifier: MIT
#include "server/yarp/camera_rpc.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/portable_math.h"
#include "server/yarp/reading_translator.h"

namespace coopdyn {
namespace {

constexpr const char* kNoFeatures = "this camera has no features such as brightness: hasFeature tells so";
constexpr std::int32_t kInUse = 2;  // RGBD_SENSOR_OK_IN_USE
// Pose of the picture's frame in the depth image's frame, row by row: both use the same lens.
constexpr std::int32_t kSide = 4;
constexpr std::array<double, 16> kSamePlace = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// The reply to get_camera, in YARP's units.
struct CameraView {
  std::int32_t width = 0, height = 0;
  double across_deg = 0, down_deg = 0;
  double near_m = 0, far_m = 0;
  double rate_hz = 0;
  double time_s = 0;
  Bottle lens;  // (focalLengthX 277.1) …: no distortion
};

Bottle LensOf(const Message& camera) {
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

/// Nullopt if it is not a reply to get_camera.
std::optional<CameraView> ReadCamera(const Message& reply) {
  constexpr double kMaxSide = 1e6;
  const auto is_side = [](double pixels) { return pixels >= 0 && pixels <= kMaxSide; };
  if (reply.data.size() != 11 || !is_side(reply.data[0]) || !is_side(reply.data[1])) return {};
  const auto angle_deg = [](double side, double focal_length) {
    return 360 / std::numbers::pi * portable::Atan(side / (2 * focal_length));
  };
  CameraView view;
  view.width = static_cast<std::int32_t>(reply.data[0]);
  view.height = static_cast<std::int32_t>(reply.data[1]);
  view.across_deg = angle_deg(view.width, reply.data[2]);
  view.down_deg = angle_deg(view.height, reply.data[3]);
  view.near_m = reply.data[6];
  view.far_m = reply.data[7];
  view.rate_hz = reply.data[8];
  view.time_s = reply.data[9];
  view.lens = LensOf(reply);
  return view;
}

/// YARP 3 uses words: [fgi] and [visr] for the frame grabber; these, [visd] and [rgdb] for the RGB-D sensor.
/// YARP 4 uses calls: getRgbWidthRPC, getDepthWidthRPC.
class CameraTranslator final : public ReadingTranslator {
  command::Id Reading() const override { return command::kGetCamera; }
  std::string_view Help() const override {
    return "visr get w, h, res, fov, intp, conf or mirr; visd get w, h, fov, intp, mirr, acrc or clip; "
           "rgdb get ext, mess, prot or stat; fgi get w or h; or the calls of YARP 4: get and Rgb or Depth, "
           "then Width, Height, Resolution, FOV, IntrinsicParam or Mirroring, then RPC; "
           "getRgbSupportedConfigurationsRPC, getDepthAccuracyRPC, getDepthClipPlanesRPC, "
           "getExtrinsicParamRPC, getLastErrorMsgRPC, getSensorStatusRPC";
  }
  std::optional<YarpAnswer> Answer(const Message& reply) override {
    const std::optional<CameraView> view = ReadCamera(reply);
    if (!view) return {};
    const std::string_view device = WordAt(request(), 0), what = WordAt(request(), 2);
    if (std::optional<YarpAnswer> answer = OfFeatures(device, what)) return answer;
    if (WordAt(request(), 1) == "get") return OfWords(device, what, *view);
    if (name().starts_with("set") && name().ends_with("RPC")) return Returned(ReturnCode::kNotThere);
    std::optional<YarpAnswer> answer = OfCall(*view);
    return answer ? answer : OfSensor(*view);
  }

  std::optional<YarpAnswer> OfWords(std::string_view device, std::string_view what,
                                    const CameraView& view) const {
    if (device == "rgdb") {
      Bottle matrix;
      for (const double value : kSamePlace) matrix.emplace_back(value);
      if (what == "ext") return Words(kSide, kSide, std::move(matrix));
      if (what == "mess") return Words(std::string());
      if (what == "prot") return Words(std::int32_t{1}, std::int32_t{0});
      if (what == "stat") return Words(kInUse);
      return {};
    }
    const bool colours = device == "visr", distances = device == "visd";
    if (!colours && !distances && device != "fgi") return {};
    if (what == "w") return Words(view.width);
    if (what == "h") return Words(view.height);
    if (device == "fgi") return {};
    if (what == "fov") return Words(view.across_deg, view.down_deg);
    if (what == "intp") return Words(view.lens);
    if (what == "mirr") return Words(std::int32_t{0});
    if (distances && what == "acrc") return Words(0.0);
    if (distances && what == "clip") return Words(view.near_m, view.far_m);
    if (colours && what == "res") return Words(view.width, view.height);
    if (colours && what == "conf")
      return Words(std::int32_t{1}, view.width, view.height, view.rate_hz, YarpVocab{"rgb"});
    return {};
  }

  /// Calls with the same answer for picture and depth image.
  std::optional<YarpAnswer> OfCall(const CameraView& view) const {
    if (IsOfEither("Width") || name() == "getWidthRPC") return OneInt(view.width);
    if (IsOfEither("Height") || name() == "getHeightRPC") return OneInt(view.height);
    if (IsOfEither("Resolution")) {
      return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
        write.Int(view.width);
        write.Int(view.height);
      });
    }
    if (IsOfEither("FOV")) return TwoDoubles(view.across_deg, view.down_deg);
    if (IsOfEither("IntrinsicParam"))
      return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) { write.Items(view.lens); });
    if (IsOfEither("Mirroring"))
      return Returned(ReturnCode::kDone, 1, [](YarpStructWriter& write) { write.Bool(false); });
    return {};
  }

  std::optional<YarpAnswer> OfSensor(const CameraView& view) const {
    if (name() == "getRgbSupportedConfigurationsRPC") {
      return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) {
        write.Struct(1);  // a list of one
        write.Struct(4);
        write.Int(view.width);
        write.Int(view.height);
        write.Double(view.rate_hz);
        write.Int(VocabCode("rgb"));
      });
    }
    if (name() == "getDepthAccuracyRPC")
      return Returned(ReturnCode::kDone, 1, [](YarpStructWriter& write) { write.Double(0); });
    if (name() == "getDepthClipPlanesRPC") return TwoDoubles(view.near_m, view.far_m);
    if (name() == "getExtrinsicParamRPC") {
      return Returned(ReturnCode::kDone, 1, [](YarpStructWriter& write) {
        write.Struct(3);
        write.Int(kSide);
        write.Int(kSide);
        write.Doubles(kSamePlace);
      });
    }
    if (name() == "getLastErrorMsgRPC") {
      return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
        write.String("");
        write.Struct(2);  // a Stamp
        write.Int(0);
        write.Double(view.time_s);
      });
    }
    if (name() == "getSensorStatusRPC") return OneInt(kInUse);
    return {};
  }

  /// IFrameGrabberControls: our cameras have no brightness, shutter and so on.
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

  /// True if the call asks for `what` of the picture or of the depth image.
  bool IsOfEither(std::string_view what) const {
    return name() == "getRgb" + std::string(what) + "RPC" || name() == "getDepth" + std::string(what) + "RPC";
  }
  /// [visr] [w] [is] 640
  template <typename... Values>
  YarpAnswer Words(Values... values) const {
    return {BottleOf(YarpVocab{std::string(WordAt(request(), 0))},
                     YarpVocab{std::string(WordAt(request(), 2))}, YarpVocab{"is"}, std::move(values)...),
            {}};
  }
  YarpAnswer OneInt(std::int32_t value) const {
    return Returned(ReturnCode::kDone, 1, [&](YarpStructWriter& write) { write.Int(value); });
  }
  YarpAnswer TwoDoubles(double first, double second) const {
    return Returned(ReturnCode::kDone, 2, [&](YarpStructWriter& write) {
      write.Double(first);
      write.Double(second);
    });
  }
};

}  // namespace

std::unique_ptr<YarpTranslator> MakeCameraTranslator() {
  return std::make_unique<CameraTranslator>();
}

}  // namespace coopdyn
