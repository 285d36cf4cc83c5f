// SPDX-License-Identifier: MIT
#include "server/yarp/board_rpc.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/yarp/board_call.h"
#include "server/yarp/struct_writer.h"

namespace coopdyn {
namespace {

struct Method {
  std::string_view name;  // without RPC
  BoardItem item;
  BoardScope scope;
  std::string_view shape;
};

constexpr std::size_t kPidFields = 10;
constexpr BoardItem kNoItem = BoardItem::kNothing;
// Methods that read. Shapes in addition to those of BoardRpc: v, V: one PID, the PIDs of all joints; y: a
// description of a PID; e: an empty list; m, p: lists of our modes and PIDs; f: no fault; n: names of
// interfaces.
constexpr Method kMethodsThatAsk[] = {
    {"getAxes", BoardItem::kAxes, BoardScope::kBoard, "i"},
    {"getNumberOfMotors", BoardItem::kAxes, BoardScope::kBoard, "i"},
    {"getNumberOfMotorEncoders", BoardItem::kAxes, BoardScope::kBoard, "i"},
    {"getDeviceInterfaces", BoardItem::kAxes, BoardScope::kBoard, "n"},
    {"getAvailableControlModes", BoardItem::kMode, BoardScope::kOne, "m"},
    {"getAvailablePids", BoardItem::kPid, BoardScope::kOne, "p"},
    {"getRemoteVariablesList", BoardItem::kAxes, BoardScope::kBoard, "e"},
    {"isCalibratorDevicePresent", BoardItem::kStop, BoardScope::kBoard, "b"},
    {"getLastJointFault", BoardItem::kMode, BoardScope::kOne, "f"},
    {"getAxisName", BoardItem::kName, BoardScope::kOne, "s"},
    {"getJointType", BoardItem::kType, BoardScope::kOne, "i"},
    {"getPosLimits", BoardItem::kPositionLimits, BoardScope::kOne, "dd"},
    {"getVelLimits", BoardItem::kVelocityLimits, BoardScope::kOne, "dd"},
    {"getTorqueRangeOne", BoardItem::kTorqueRange, BoardScope::kOne, "dd"},
    {"getTorqueRangeAll", BoardItem::kTorqueRange, BoardScope::kAll, "DD"},
    {"getEncoderOne", BoardItem::kPosition, BoardScope::kOne, "d"},
    {"getEncoderTimedOne", BoardItem::kPosition, BoardScope::kOne, "dt"},
    {"getEncoderAll", BoardItem::kPosition, BoardScope::kAll, "D"},
    {"getEncoderTimedAll", BoardItem::kPosition, BoardScope::kAll, "DT"},
    {"getEncoderSpeedOne", BoardItem::kVelocity, BoardScope::kOne, "d"},
    {"getEncoderSpeedAll", BoardItem::kVelocity, BoardScope::kAll, "D"},
    {"getMotorEncoderOne", BoardItem::kPosition, BoardScope::kOne, "d"},
    {"getMotorEncoderTimedOne", BoardItem::kPosition, BoardScope::kOne, "dt"},
    {"getMotorEncoderAll", BoardItem::kPosition, BoardScope::kAll, "D"},
    {"getMotorEncodersTimedAll", BoardItem::kPosition, BoardScope::kAll, "DT"},
    {"getMotorEncoderSpeedOne", BoardItem::kVelocity, BoardScope::kOne, "d"},
    {"getMotorEncoderSpeedAll", BoardItem::kVelocity, BoardScope::kAll, "D"},
    {"getTargetPositionOne", BoardItem::kTarget, BoardScope::kOne, "d"},
    {"getTargetPositionGroup", BoardItem::kTarget, BoardScope::kGroup, "D"},
    {"getTargetPositionAll", BoardItem::kTarget, BoardScope::kAll, "D"},
    {"getTrajSpeedOne", BoardItem::kSpeed, BoardScope::kOne, "d"},
    {"getTrajSpeedsGroup", BoardItem::kSpeed, BoardScope::kGroup, "D"},
    {"getTrajSpeedsAll", BoardItem::kSpeed, BoardScope::kAll, "D"},
    {"getTrajAccelerationOne", BoardItem::kAcceleration, BoardScope::kOne, "d"},
    {"getTrajAccelerationGroup", BoardItem::kAcceleration, BoardScope::kGroup, "D"},
    {"getTrajAccelerationAll", BoardItem::kAcceleration, BoardScope::kAll, "D"},
    {"checkMotionDoneOne", BoardItem::kDone, BoardScope::kOne, "b"},
    {"checkMotionDoneGroup", BoardItem::kDone, BoardScope::kGroup, "b"},
    {"checkMotionDoneAll", BoardItem::kDone, BoardScope::kAll, "b"},
    {"getRefPositionOne", BoardItem::kDirect, BoardScope::kOne, "d"},
    {"getRefPositionGroup", BoardItem::kDirect, BoardScope::kGroup, "D"},
    {"getRefPositionAll", BoardItem::kDirect, BoardScope::kAll, "D"},
    {"getTargetVelocityOne", BoardItem::kVelocityReference, BoardScope::kOne, "d"},
    {"getTargetVelocityGroup", BoardItem::kVelocityReference, BoardScope::kGroup, "D"},
    {"getTargetVelocityAll", BoardItem::kVelocityReference, BoardScope::kAll, "D"},
    {"getRefVelocityOne", BoardItem::kVelocityReference, BoardScope::kOne, "d"},
    {"getRefVelocityGroup", BoardItem::kVelocityReference, BoardScope::kGroup, "D"},
    {"getRefVelocityAll", BoardItem::kVelocityReference, BoardScope::kAll, "D"},
    {"getRefTorqueOne", BoardItem::kTorque, BoardScope::kOne, "d"},
    {"getRefTorqueGroup", BoardItem::kTorque, BoardScope::kGroup, "D"},
    {"getRefTorqueAll", BoardItem::kTorque, BoardScope::kAll, "D"},
    {"getInteractionModeOne", BoardItem::kCompliant, BoardScope::kOne, "i"},
    {"getInteractionModesGroup", BoardItem::kCompliant, BoardScope::kGroup, "I"},
    {"getInteractionModesAll", BoardItem::kCompliant, BoardScope::kAll, "I"},
    {"getImpedance", BoardItem::kImpedance, BoardScope::kOne, "dd"},
    {"getImpedanceOffset", BoardItem::kImpedanceOffset, BoardScope::kOne, "d"},
    {"getCurrentImpedanceLimit", BoardItem::kImpedanceLimits, BoardScope::kOne, "dddd"},
    {"getAmpStatusOne", BoardItem::kAmplifier, BoardScope::kOne, "i"},
    {"getAmpStatusAll", BoardItem::kAmplifier, BoardScope::kAll, "I"},
    {"getGearboxRatio", BoardItem::kGearRatio, BoardScope::kOne, "d"},
    {"getRemoteVariable", kNoItem, BoardScope::kBoard, "e"},
    {"getRefCurrentAll", kNoItem, BoardScope::kBoard, "D"},
    {"getRefCurrentOne", kNoItem, BoardScope::kBoard, "d"},
    {"getCurrentAll", kNoItem, BoardScope::kBoard, "D"},
    {"getCurrentOne", kNoItem, BoardScope::kBoard, "d"},
    {"getCurrentRangeOne", kNoItem, BoardScope::kBoard, "dd"},
    {"getCurrentRangeAll", kNoItem, BoardScope::kBoard, "DD"},
    {"getRefDutyCycleOne", kNoItem, BoardScope::kBoard, "d"},
    {"getRefDutyCycleAll", kNoItem, BoardScope::kBoard, "D"},
    {"getDutyCycleOne", kNoItem, BoardScope::kBoard, "d"},
    {"getDutyCycleAll", kNoItem, BoardScope::kBoard, "D"},
    {"getEncoderAccelerationOne", kNoItem, BoardScope::kBoard, "d"},
    {"getEncoderAccelerationAll", kNoItem, BoardScope::kBoard, "D"},
    {"getMotorEncoderAccelerationOne", kNoItem, BoardScope::kBoard, "d"},
    {"getMotorEncoderAccelerationAll", kNoItem, BoardScope::kBoard, "D"},
    {"getMotorEncoderCountsPerRevolution", BoardItem::kCounts, BoardScope::kOne, "d"},
    {"isJointBraked", kNoItem, BoardScope::kBoard, "b"},
    {"getAutoBrakeEnabled", kNoItem, BoardScope::kBoard, "b"},
    {"getTemperatureOne", kNoItem, BoardScope::kBoard, "d"},
    {"getTemperatureAll", kNoItem, BoardScope::kBoard, "D"},
    {"getTemperatureLimit", kNoItem, BoardScope::kBoard, "d"},
    {"getMotorTorqueParams", kNoItem, BoardScope::kBoard, "ddddddddd"},
    {"getMaxCurrent", kNoItem, BoardScope::kBoard, "d"},
    {"getNominalCurrent", kNoItem, BoardScope::kBoard, "d"},
    {"getPeakCurrent", kNoItem, BoardScope::kBoard, "d"},
    {"getPWM", kNoItem, BoardScope::kBoard, "d"},
    {"getPWMLimit", kNoItem, BoardScope::kBoard, "d"},
    {"getPowerSupplyVoltage", kNoItem, BoardScope::kBoard, "d"},
};
// Methods whose first argument is the kind of PID.
constexpr Method kPidMethodsThatAsk[] = {
    {"getPid", BoardItem::kPid, BoardScope::kOne, "v"},
    {"getPids", BoardItem::kPid, BoardScope::kAll, "V"},
    {"getPidReference", BoardItem::kPidReference, BoardScope::kOne, "d"},
    {"getPidReferences", BoardItem::kPidReference, BoardScope::kAll, "D"},
    {"getPidError", BoardItem::kPidError, BoardScope::kOne, "d"},
    {"getPidErrors", BoardItem::kPidError, BoardScope::kAll, "D"},
    {"getPidOutput", BoardItem::kPidOutput, BoardScope::kOne, "d"},
    {"getPidOutputs", BoardItem::kPidOutput, BoardScope::kAll, "D"},
    {"isPidEnabled", BoardItem::kPidEnabled, BoardScope::kOne, "b"},
    {"getPidErrorLimit", kNoItem, BoardScope::kBoard, "d"},
    {"getPidErrorLimits", kNoItem, BoardScope::kBoard, "D"},
    {"getPidOffset", kNoItem, BoardScope::kBoard, "d"},
    {"getPidFeedforward", kNoItem, BoardScope::kBoard, "d"},
    {"getPidExtraInfo", kNoItem, BoardScope::kBoard, "y"},
    {"getPidExtraInfos", kNoItem, BoardScope::kBoard, "e"},
};
// Methods that set; the answer is only the success code.
constexpr BoardWord kMethodsThatTell[] = {
    {"positionMoveOne", BoardItem::kTarget, BoardScope::kOne},
    {"positionMoveGroup", BoardItem::kTarget, BoardScope::kGroup},
    {"positionMoveAll", BoardItem::kTarget, BoardScope::kAll},
    {"relativeMoveOne", BoardItem::kRelative, BoardScope::kOne},
    {"relativeMoveGroup", BoardItem::kRelative, BoardScope::kGroup},
    {"relativeMoveAll", BoardItem::kRelative, BoardScope::kAll},
    {"setTrajSpeedOne", BoardItem::kSpeed, BoardScope::kOne},
    {"setTrajSpeedGroup", BoardItem::kSpeed, BoardScope::kGroup},
    {"setTrajSpeedAll", BoardItem::kSpeed, BoardScope::kAll},
    {"setTrajAccelerationOne", BoardItem::kAcceleration, BoardScope::kOne},
    {"setTrajAccelerationsGroup", BoardItem::kAcceleration, BoardScope::kGroup},
    {"setTrajAccelerationsAll", BoardItem::kAcceleration, BoardScope::kAll},
    {"stopOne", BoardItem::kStop, BoardScope::kOne},
    {"stopGroup", BoardItem::kStop, BoardScope::kGroup},
    {"stopAll", BoardItem::kStop, BoardScope::kAll},
    {"setRefPositionOne", BoardItem::kDirect, BoardScope::kOne},
    {"setRefPositionGroup", BoardItem::kDirect, BoardScope::kGroup},
    {"setRefPositionAll", BoardItem::kDirect, BoardScope::kAll},
    {"velocityMoveOne", BoardItem::kVelocityReference, BoardScope::kOne},
    {"velocityMoveGroup", BoardItem::kVelocityReference, BoardScope::kGroup},
    {"velocityMoveAll", BoardItem::kVelocityReference, BoardScope::kAll},
    {"setRefVelocityOne", BoardItem::kVelocityReference, BoardScope::kOne},
    {"setRefVelocityGroup", BoardItem::kVelocityReference, BoardScope::kGroup},
    {"setRefVelocityAll", BoardItem::kVelocityReference, BoardScope::kAll},
    {"setRefTorqueOne", BoardItem::kTorque, BoardScope::kOne},
    {"setRefTorqueGroup", BoardItem::kTorque, BoardScope::kGroup},
    {"setRefTorqueAll", BoardItem::kTorque, BoardScope::kAll},
    {"setControlModeOne", BoardItem::kMode, BoardScope::kOne},
    {"setControlModeGroup", BoardItem::kMode, BoardScope::kGroup},
    {"setControlModeAll", BoardItem::kMode, BoardScope::kAll},
    {"setInteractionModeOne", BoardItem::kCompliant, BoardScope::kOne},
    {"setInteractionModesGroup", BoardItem::kCompliant, BoardScope::kGroup},
    {"setInteractionModesAll", BoardItem::kCompliant, BoardScope::kAll},
    {"setImpedance", BoardItem::kImpedance, BoardScope::kOne},
    {"setImpedanceOffset", BoardItem::kImpedanceOffset, BoardScope::kOne},
    {"setPosLimits", BoardItem::kPositionLimits, BoardScope::kOne},
    {"setVelLimits", BoardItem::kVelocityLimits, BoardScope::kOne},
};
constexpr BoardWord kPidMethodsThatTell[] = {{"setPid", BoardItem::kPid, BoardScope::kOne},
                                             {"setPids", BoardItem::kPid, BoardScope::kAll},
                                             {"resetPid", BoardItem::kPidReset, BoardScope::kOne}};
// In the order of YARP's own answer. All but one can be opened because yarpmotorgui requires most of them;
// unsupported functions are refused call by call.
constexpr const char* kInterfaces[] = {
    "iAmplifierControl", "iAxisInfo",        "iControlCalibration", "iControlLimits",    "iControlMode",
    "iCurrentControl",   "iEncodersTimed",   "iImpedanceControl",   "iInteractionMode",  "iJointBrake",
    "iJointFault",       "iMotor",           "iMotorEncoders",      "iPWMControl",       "iPidControl",
    "iPositionControl",  "iPositionDirect",  "iPreciselyTimed",     "iRemoteCalibrator", "iRemoteVariables",
    "iTorqueControl",    "iVelocityControl", "iVelocityDirect"};
constexpr std::string_view kNotOurs = "iPreciselyTimed";

/// The number that YARP 4 sends for a value; the vocab's code if the value has a word.
std::int32_t WholeOf(BoardItem item, double value) {
  if (item == BoardItem::kType) return VocabCode(value == 1 ? "atpr" : "atrv");
  if (item == BoardItem::kCompliant) return VocabCode(value == 1 ? "comp" : "stif");
  return static_cast<std::int32_t>(value);
}

const Method* FindMethod(const Method* begin, const Method* end, std::string_view name) {
  const Method* const found =
      std::find_if(begin, end, [name](const Method& method) { return method.name == name; });
  return found == end ? nullptr : found;
}

std::string_view CodeOf(BoardAnswer::Kind kind) {
  switch (kind) {
    case BoardAnswer::Kind::kDone:
      return "ok";
    case BoardAnswer::Kind::kNotThere:
      return "err2";
    case BoardAnswer::Kind::kOutOfBounds:
      return "err7";
    case BoardAnswer::Kind::kFailed:
      break;
  }
  return "err5";
}

void AppendFixedShape(char letter, YarpStructWriter& write) {
  switch (letter) {
    case 'e':
      return write.Struct(0);
    case 'f':
      write.Int(0);
      return write.String("");
    case 'm':
      return write.Ints(std::array{VocabCode("idl"), VocabCode("pos"), VocabCode("posd"), VocabCode("vel"),
                                   VocabCode("torq")});
    case 'p':
      return write.Ints(std::array{VocabCode("pos1")});
    case 'n':
      write.Struct(std::size(kInterfaces));
      for (const char* const name : kInterfaces) {
        write.Struct(2);
        write.String(name);
        write.Bool(name != kNotOurs);
      }
      return;
    default:  // y: three words, and ten units
      constexpr std::size_t kWords = 13;
      write.Struct(kWords);
      for (std::size_t i = 0; i < kWords; ++i) write.String("");
  }
}

}  // namespace

BoardRpc ReadBoardRpc(const Bottle& request) {
  BoardRpc rpc;
  std::string_view name = request.empty() ? std::string_view() : request[0].word();
  if (name == "getRemoteProtocolVersion") {
    rpc.fixed = YarpProtocolVersion();
    return rpc;
  }
  if (name == "help") {
    rpc.fixed = YarpAnswer{
        BottleOf(YarpVocab{"many"}, std::string("The calls of controlBoard_nwc_yarp, YARP 4: for example"),
                 std::string("getAxesRPC, getEncoderAllRPC, setControlModeOneRPC J pos, "
                             "positionMoveOneRPC J DEGREES, stopAllRPC"),
                 std::string("To write by hand, the words of YARP 3 are shorter: they are at /rpc:i")),
        {}};
    return rpc;
  }
  constexpr std::string_view kEnd = "RPC";
  if (!name.ends_with(kEnd)) {
    rpc.fixed = YarpAnswer{
        BottleOf(
            YarpVocab{"fail"},
            std::string(
                "calls end with RPC: help tells some; words such as get encs are for rpc:i without nws")),
        {}};
    return rpc;
  }
  name.remove_suffix(kEnd.size());
  if (const Method* method = FindMethod(std::begin(kMethodsThatAsk), std::end(kMethodsThatAsk), name)) {
    rpc.shape = method->shape;
    rpc.call = method->item == kNoItem
                   ? RefuseBoardCall("")
                   : MakeBoardCall({name, method->item, method->scope}, false, request, 1);
    return rpc;
  }
  const bool of_position = request.size() > 1 && WordOf(request[1]) == "pos1";
  if (const Method* method = FindMethod(std::begin(kPidMethodsThatAsk), std::end(kPidMethodsThatAsk), name)) {
    rpc.shape = method->shape;
    rpc.call = method->item == kNoItem || !of_position
                   ? RefuseBoardCall(kNoBoardPid)
                   : MakeBoardCall({name, method->item, method->scope}, false, request, 2);
    return rpc;
  }
  if (const BoardWord* word = FindBoardWord(kMethodsThatTell, name)) {
    rpc.call = MakeBoardCall(*word, true, request, 1);
  } else if (const BoardWord* pid = FindBoardWord(kPidMethodsThatTell, name)) {
    rpc.call = of_position ? MakeBoardCall(*pid, true, request, 2) : RefuseBoardCall(kNoBoardPid);
  } else if (name == "enableAmp" || name == "disableAmp") {
    rpc.call = MakeBoardCall({name, BoardItem::kAmplifier, BoardScope::kOne}, false, request, 1);
    rpc.call.tells = true;
    rpc.call.values = {name == "enableAmp" ? 1.0 : 0.0};
  } else {
    rpc.call = RefuseBoardCall("this board has no " + std::string(name));
  }
  return rpc;
}

std::string BoardRpcReply(const BoardRpc& rpc, const BoardAnswer& answer, double time_s) {
  std::string bytes;
  YarpStructWriter write(YarpDialect::k4, bytes);
  const bool done = answer.kind == BoardAnswer::Kind::kDone;
  const auto scalars = static_cast<std::size_t>(rpc.shape == "f" ? 2 : rpc.shape.size());
  if (!rpc.shape.empty()) write.Struct(1 + scalars);
  write.Struct(1);
  write.Vocab(CodeOf(answer.kind));
  const BoardItem item = rpc.call.item;
  const std::size_t width = std::max<std::size_t>(BoardWidth(item), 1);
  std::size_t next = 0;  // next of the joint's values
  const auto value = [&] { return next < answer.values.size() ? answer.values[next++] : 0; };
  const auto column = [&] {
    std::vector<double> values;
    for (std::size_t i = next; done && i < answer.values.size(); i += width)
      values.push_back(answer.values[i]);
    ++next;
    return values;
  };
  const auto pid = [&] {
    write.Struct(kPidFields);
    for (std::size_t i = 0; i < kPidFields; ++i) write.Double(value());
  };
  for (const char letter : rpc.shape) {
    switch (letter) {
      case 'd':
        write.Double(value());
        break;
      case 'i':
        write.Int(WholeOf(item, value()));
        break;
      case 'b':
        write.Bool(value() != 0);
        break;
      case 's':
        write.String(answer.names.empty() ? std::string() : answer.names.front());
        break;
      case 't':
        write.Double(time_s);
        break;
      case 'D':
        write.Doubles(column());
        break;
      case 'T':
        write.Doubles(std::vector<double>(answer.values.size(), time_s));
        break;
      case 'I': {
        std::vector<std::int32_t> whole;
        for (const double each : column()) whole.push_back(WholeOf(item, each));
        write.Ints(whole);
        break;
      }
      case 'v':
        pid();
        break;
      case 'V':
        write.Struct(answer.values.size() / kPidFields);
        while (next < answer.values.size()) pid();
        break;
      default:
        AppendFixedShape(letter, write);
    }
  }
  return bytes;
}

}  // namespace coopdyn
