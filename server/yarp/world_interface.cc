// SPDX-License-Identifier: MIT
#include "server/yarp/world_interface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <boost/system/error_code.hpp>

#include "protocol/ascii.h"
#include "protocol/command_ids.h"
#include "server/base/portable_math.h"
#include "server/yarp/world_call.h"

namespace coopdyn {
namespace {

namespace json = boost::json;

constexpr double kThingsDensity_kg_m3 = 500;  // like light wood
constexpr double kMinThingsMass_kg = 1e-6;    // minimum in a scenario

struct WorldPlace {
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  WorldPlace operator*(const WorldPlace& inner) const { return {p_m + q * inner.p_m, q * inner.q}; }
  WorldPlace Inverse() const { return {-(q.conjugate() * p_m), q.conjugate()}; }
};

/// `pose`: x y z in m, roll pitch yaw in rad.
WorldPlace WorldPlaceOf(const std::vector<double>& pose) {
  return {{pose[0], pose[1], pose[2]},
          portable::AngleAxis(pose[5], Eigen::Vector3d::UnitZ()) *
              portable::AngleAxis(pose[4], Eigen::Vector3d::UnitY()) *
              portable::AngleAxis(pose[3], Eigen::Vector3d::UnitX())};
}

/// The reverse; with the pitch straight up or down, the yaw is 0.
std::array<double, 6> PoseOf(const WorldPlace& place) {
  const Eigen::Quaterniond q = place.q.normalized();
  const double sine = std::clamp(2 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0);
  const Eigen::Vector3d& p = place.p_m;
  constexpr double kStraight = 1 - 1e-12;
  if (std::abs(sine) > kStraight) {
    const double roll = std::remainder(2 * portable::Atan2(q.x(), q.w()), 2 * std::numbers::pi);
    return {p.x(), p.y(), p.z(), roll, std::copysign(std::numbers::pi / 2, sine), 0};
  }
  const double roll =
      portable::Atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y()));
  const double yaw =
      portable::Atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
  return {p.x(), p.y(), p.z(), roll, portable::Asin(sine), yaw};
}

/// A thing in the world.
struct Standing {
  enum class Kind { kThing, kRobot, kOther };
  Kind kind = Kind::kOther;
  std::int32_t id = 0;
  std::string name, type;
  std::vector<double> size_m;
  double mass_kg = 0;
  WorldPlace place;
};

double JsonNumber(const json::value* value) {
  boost::system::error_code error;
  const double number = value == nullptr ? 0 : value->to_number<double>(error);
  return error ? 0 : number;
}
std::vector<double> JsonNumbers(const json::value* value) {
  std::vector<double> numbers;
  if (value == nullptr || !value->is_array()) return numbers;
  for (const json::value& item : value->get_array()) numbers.push_back(JsonNumber(&item));
  return numbers;
}
std::string JsonWord(const json::value* value) {
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string();
}

/// Parses the answer to `list` of /world, JSON.
std::vector<Standing> ReadStanding(const std::string& text) {
  boost::system::error_code error;
  const json::value world = json::parse(text, error);
  std::vector<Standing> all;
  if (error || !world.is_object()) return all;
  using Kind = Standing::Kind;
  for (const auto& [key, kind] : {std::pair("things", Kind::kThing), std::pair("robots", Kind::kRobot),
                                  std::pair("targets", Kind::kOther), std::pair("lights", Kind::kOther)}) {
    const json::value* const list = world.get_object().if_contains(key);
    if (list == nullptr || !list->is_array()) continue;
    for (const json::value& item : list->get_array()) {
      if (!item.is_object()) continue;
      const json::object& one = item.get_object();
      Standing& standing = all.emplace_back();
      standing.kind = kind;
      standing.id = static_cast<std::int32_t>(JsonNumber(one.if_contains("id")));
      standing.name = JsonWord(one.if_contains("name"));
      standing.type = JsonWord(one.if_contains("type"));
      standing.size_m = JsonNumbers(one.if_contains("size"));
      standing.mass_kg = JsonNumber(one.if_contains("mass"));
      const std::vector<double> p = JsonNumbers(one.if_contains("position"));
      const std::vector<double> q = JsonNumbers(one.if_contains("quaternion"));
      if (p.size() == 3) standing.place.p_m = {p[0], p[1], p[2]};
      if (q.size() == 4) standing.place.q = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    }
  }
  return all;
}

const Standing* FindStanding(const std::vector<Standing>& world, std::string_view name) {
  const auto found = std::ranges::find_if(world, [name](const Standing& one) {
    return std::ranges::equal(one.name, name, [](char a, char b) { return ToLower(a) == ToLower(b); });
  });
  return found == world.end() ? nullptr : &*found;
}

/// Mass of a thing of size `size_m` as in a scenario: edges of a box; twice the diameter, and the length, of
/// a cylinder; diameter of a sphere.
double ThingsMass(std::string_view type, const std::vector<double>& size_m) {
  using std::numbers::pi;
  const double volume_m3 = size_m.size() == 3 && type == "box" ? size_m[0] * size_m[1] * size_m[2]
                           : size_m.size() == 3 && type == "cylinder"
                               ? pi / 4 * size_m[0] * size_m[1] * size_m[2]
                           : !size_m.empty() ? pi / 6 * size_m[0] * size_m[0] * size_m[0]
                                             : 0;
  return std::max(kMinThingsMass_kg, volume_m3 * kThingsDensity_kg_m3);
}

/// A line `key 1.0 2.0`.
std::string NumbersLine(std::string key, const std::vector<double>& numbers) {
  for (const double number : numbers) AppendDouble(number, key += ' ');
  return key + "\n";
}
std::string PlaceLines(const WorldPlace& X) {
  return NumbersLine("position", {X.p_m.x(), X.p_m.y(), X.p_m.z()}) +
         NumbersLine("quaternion", {X.q.w(), X.q.x(), X.q.y(), X.q.z()});
}
/// Converts the range 0 to 255 to 0 to 1.
std::vector<double> UnitColor(const std::vector<double>& color) {
  return {color[0] / 255, color[1] / 255, color[2] / 255};
}

/// The scenario section that makes the requested thing at `X_W`.
std::string WorldSection(const WorldRequest& request, const WorldPlace& X_W) {
  if (request.call->act == WorldAct::kLoad) {
    const std::string name = request.name.empty() ? "" : "name " + request.name + "\n";
    const std::string place = request.pose.empty() ? "position 0 0\n" : PlaceLines(X_W);
    return "[ROBOT_*]\ntype " + request.words[0] + "\n" + name + place + "sync no\n";
  }
  const std::string type(request.call->thing);
  std::vector<double> size_m = request.sizes_m;
  if (type != "box") size_m[0] *= 2;
  if (type == "cylinder") size_m.insert(size_m.begin(), size_m[0]);
  std::string section = "[" + (request.name.empty() ? type + "_*" : request.name) + "]\ntype " + type + "\n" +
                        NumbersLine("size", size_m) + PlaceLines(X_W) +
                        NumbersLine("color", UnitColor(request.color));
  if (request.gravity) section += NumbersLine("mass", {ThingsMass(type, size_m)});
  return section;
}

Message WorldMessage(command::Id id, std::string text, std::vector<double> data = {}) {
  Message message;
  message.command = id;
  message.text = std::move(text);
  message.data = std::move(data);
  return message;
}

class WorldTranslator final : public YarpTranslator {
 public:
  explicit WorldTranslator(std::shared_ptr<YarpMadeThings> made) : made_(std::move(made)) {}

  Decoded Decode(const Bottle& request) override {
    request_ = {};
    fixed_.reset();
    failed_.clear();
    answer_.clear();
    const std::size_t at = WordAt(request, 0) == "__direct__" ? 1 : 0;
    const std::string_view name = WordAt(request, at);
    if (name == "help" || name == "why" || name == "getRemoteProtocolVersion") {
      fixed_ = Fixed(name);
      return Here(Error::kNotPossible, "");
    }
    const auto* const call = std::ranges::find(kWorldCalls, name, &WorldCall::name);
    if (call == std::end(kWorldCalls))
      return Here(Error::kWrongParams, "there is no such call: help lists them, getList is one");
    request_.call = call;
    if (!ReadWorldParts(request, at + 1, request_))
      return Here(Error::kWrongParams, "write " + WorldCallUsage(*call) + ": in m and rad, colours 0 to 255");
    if (std::string why = WhyNoRequest(request_); !why.empty())
      return Here(Error::kNotPossible, std::move(why));
    asked_ = call->act >= WorldAct::kGravity || !request_.frame.empty();
    std::optional<Message> first = asked_ ? WorldMessage(command::kListWorld, "") : Order({});
    return {DecodeStatus::kMessage, 0, *std::move(first)};
  }

  bool changes() const override {
    return request_.call != nullptr && request_.call->act != WorldAct::kPose &&
           request_.call->act != WorldAct::kList;
  }

  std::optional<Message> Next(const Message& reply) override {
    const bool asked = std::exchange(asked_, false);
    if (reply.error != 0) return {};
    if (asked) return Order(ReadStanding(reply.text));
    Keep(reply);
    return {};
  }

  YarpAnswer Reply(const Message& reply) override {
    if (fixed_) return *std::exchange(fixed_, std::nullopt);
    if (!failed_.empty() || reply.error != 0) {
      why_ = !failed_.empty() ? failed_ : !reply.text.empty() ? reply.text : ErrorMeaning(reply.error);
      const bool misspelt = reply.command == command::kUnreadable &&
                            reply.error != static_cast<std::int32_t>(Error::kNotPossible);
      return Failure(misspelt || request_.typed || request_.call == nullptr);
    }
    if (request_.call->reply == WorldReply::kDone) return {BottleOf(YarpVocab{"ok"}), {}};
    return {answer_, {}};
  }

 private:
  /// An answer without asking the module.
  static Decoded Here(Error error, std::string text) {
    return {DecodeStatus::kBad, 0, ErrorReply(command::kUnreadable, error, std::move(text))};
  }
  std::optional<Message> Fail(std::string why) {
    failed_ = std::move(why);
    return {};
  }

  YarpAnswer Fixed(std::string_view name) const {
    if (name == "why") return {BottleOf(why_.empty() ? std::string("no call was refused") : why_), {}};
    if (name == "getRemoteProtocolVersion") return YarpProtocolVersion();
    YarpAnswer answer{BottleOf(YarpVocab{"many"}), {}};
    for (const WorldCall& call : kWorldCalls) answer.bottle.emplace_back(WorldCallUsage(call));
    answer.bottle.emplace_back("why: why the last refused call was refused");
    return answer;
  }

  /// The next command for the module. Nullopt if there is none, or, with failed_ set, on failure.
  std::optional<Message> Order(const std::vector<Standing>& world) {
    const WorldAct act = request_.call->act;
    const std::string id = request_.words.empty() ? "" : request_.words[0];
    const Standing* const standing = FindStanding(world, id);
    if (standing == nullptr &&
        (act == WorldAct::kPose || act == WorldAct::kGravity || act == WorldAct::kCollision))
      return Fail("there is no " + id + " in the world");
    const std::optional<WorldPlace> X_WF = Frame(world);
    if (!X_WF) return {};
    const WorldPlace X_W = request_.pose.empty() ? *X_WF : *X_WF * WorldPlaceOf(request_.pose);
    const Eigen::Vector3d& p = X_W.p_m;
    switch (act) {
      case WorldAct::kMake:
      case WorldAct::kLoad:
        return WorldMessage(command::kInsert, WorldSection(request_, X_W));
      case WorldAct::kColor:
        return WorldMessage(command::kSetThing, NumbersLine(id + " color", UnitColor(request_.color)));
      case WorldAct::kMove:
        return WorldMessage(command::kSetPose, id,
                            {p.x(), p.y(), p.z(), X_W.q.w(), X_W.q.x(), X_W.q.y(), X_W.q.z()});
      case WorldAct::kDelete:
        return WorldMessage(command::kRemove, id);
      case WorldAct::kRename:
        return WorldMessage(command::kRename, id + " " + request_.words[1]);
      case WorldAct::kGravity:
        return OrderGravity(*standing);
      case WorldAct::kPose:
        for (const double value : PoseOf(X_WF->Inverse() * standing->place)) answer_.emplace_back(value);
        return {};
      case WorldAct::kDeleteAll:
      case WorldAct::kList:
        return OrderAll(world);
      default:
        return {};
    }
  }

  /// Things without mass do not fall.
  std::optional<Message> OrderGravity(const Standing& thing) {
    const bool is_thing = thing.kind == Standing::Kind::kThing;
    const bool weighs = is_thing ? thing.mass_kg > 0 : thing.kind == Standing::Kind::kRobot;
    if (weighs == request_.on) return {};
    if (!is_thing) return Fail("gravity can be changed of things only, not of " + thing.name);
    const double mass_kg = request_.on ? ThingsMass(thing.type, thing.size_m) : 0;
    return WorldMessage(command::kSetThing, NumbersLine(thing.name + " mass", {mass_kg}));
  }

  std::optional<Message> OrderAll(const std::vector<Standing>& world) {
    Message remove = WorldMessage(command::kRemove, "");
    Bottle names;
    for (const Standing& one : world) {
      if (!made_->Has(one.id, one.name)) continue;
      remove.params.push_back(one.id);
      names.emplace_back(one.name);
    }
    answer_ = BottleOf(std::move(names));
    if (request_.call->act == WorldAct::kList || remove.params.empty()) return {};
    return remove;
  }

  /// X_WF of the frame F that the request names; nullopt, with failed_ set, if there is none.
  std::optional<WorldPlace> Frame(const std::vector<Standing>& world) {
    const std::string& frame = request_.frame;
    if (frame.empty()) return WorldPlace();
    const std::size_t colon = frame.find("::");
    const Standing* const found = FindStanding(world, frame.substr(0, colon));
    if (found != nullptr && (colon == std::string::npos || found->kind != Standing::Kind::kRobot))
      return found->place;
    failed_ = found == nullptr
                  ? "there is no frame " + frame + ": a frame is a thing or a robot of the world"
                  : "links of robots are no frames here: " + found->name + " is the frame of the robot";
    return {};
  }

  /// Records created, deleted and renamed things.
  void Keep(const Message& reply) {
    std::string names = reply.text.substr(0, reply.text.find('\n'));  // warnings follow
    const WorldAct act = request_.call->act;
    const bool makes = act == WorldAct::kMake || act == WorldAct::kLoad;
    if (makes) answer_ = BottleOf(names);
    for (const std::int32_t id : reply.params) {
      const std::string name = names.substr(0, names.find(' '));
      names.erase(0, name.size() + 1);
      if (makes || (act == WorldAct::kRename && made_->Has(id, request_.words[0]))) made_->Add(id, name);
      if (act == WorldAct::kDelete || act == WorldAct::kDeleteAll) made_->Remove(id);
    }
  }

  /// A program reads only the value that it expects, as from the plugin on a failure. A person gets the
  /// reason.
  YarpAnswer Failure(bool typed) const {
    YarpAnswer answer{BottleOf(YarpVocab{"fail"}, why_), {}};
    if (typed) return answer;
    const WorldReply reply = request_.call->reply;
    const Bottle value = reply == WorldReply::kName    ? BottleOf(std::string())
                         : reply == WorldReply::kPose  ? Bottle(6, BottleValue{std::int32_t{0}})
                         : reply == WorldReply::kNames ? BottleOf(Bottle())
                                                       : BottleOf(YarpVocab{"fail"});
    EncodeBottle(value, YarpDialect::k3, answer.bytes);  // the same in both dialects
    return answer;
  }

  const std::shared_ptr<YarpMadeThings> made_;
  WorldRequest request_;
  std::optional<YarpAnswer> fixed_;  // for the last decoded request
  bool asked_ = false;               // the world has been requested
  std::string failed_, why_;         // reason of this failure; of the last failure
  Bottle answer_;
};

}  // namespace

void YarpMadeThings::Add(std::int32_t id, std::string name) {
  const MutexLock lock(mutex_);
  names_[id] = std::move(name);
}

void YarpMadeThings::Remove(std::int32_t id) {
  const MutexLock lock(mutex_);
  names_.erase(id);
}

bool YarpMadeThings::Has(std::int32_t id, std::string_view name) const {
  const MutexLock lock(mutex_);
  const auto found = names_.find(id);
  return found != names_.end() &&
         std::ranges::equal(
             found->second, name, {}, [](char c) { return ToLower(c); }, [](char c) { return ToLower(c); });
}

std::unique_ptr<YarpTranslator> MakeWorldTranslator(std::shared_ptr<YarpMadeThings> made) {
  return std::make_unique<WorldTranslator>(std::move(made));
}

}  // namespace coopdyn
