// SPDX-License-Identifier: MIT
#include "server/web/page_message.h"

#include <boost/json.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "protocol/codec.h"
#include "protocol/json_text.h"

namespace coopdyn {
namespace {

namespace json = boost::json;

constexpr std::size_t kMaxNameBytes = 256;

/// Thrown and caught in this file only.
struct Wrong {
  std::string text;
};

std::string Clean(std::string text, std::string_view key) {
  if (!IsCleanUtf8(text)) throw Wrong{"\"" + std::string(key) + "\" has bytes that are not clean UTF-8"};
  return text;
}

std::string StringAt(const json::object& object, std::string_view key) {
  const json::value* value = object.if_contains(key);
  if (value == nullptr || value->is_null()) return {};
  if (!value->is_string()) throw Wrong{"\"" + std::string(key) + "\" must be a string"};
  return Clean(std::string(value->get_string()), key);
}

std::string NameAt(const json::object& object, std::string_view key) {
  std::string name = StringAt(object, key);
  if (name.size() > kMaxNameBytes) throw Wrong{"\"" + std::string(key) + "\" is too long"};
  return name;
}

std::string ModuleAt(const json::object& object) {
  std::string module = NameAt(object, "module");
  if (module.empty()) throw Wrong{R"(say which module: "module": "/robot1/motors")"};
  if (module.front() != '/') module.insert(module.begin(), '/');
  return module;
}

/// A number, or one of the strings for non-finite numbers.
std::optional<double> ToNumber(const json::value& value) {
  if (value.is_number()) return value.to_number<double>();
  if (value.is_string()) {
    const std::string_view text = value.get_string();
    if (text == "inf" || text == "+inf") return std::numeric_limits<double>::infinity();
    if (text == "-inf") return -std::numeric_limits<double>::infinity();
    if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  }
  return std::nullopt;
}

std::optional<std::int32_t> ToInt32(const json::value& value) {
  const std::optional<double> number = value.is_number() ? ToNumber(value) : std::nullopt;
  if (!number || *number != std::floor(*number) ||
      std::abs(*number) > std::numeric_limits<std::int32_t>::max()) {
    return std::nullopt;
  }
  return static_cast<std::int32_t>(*number);
}

const json::array& ArrayAt(const json::object& object, std::string_view key) {
  static const json::array kNone;
  const json::value* value = object.if_contains(key);
  if (value == nullptr || value->is_null()) return kNone;
  if (!value->is_array()) throw Wrong{"\"" + std::string(key) + "\" must be a list of numbers"};
  return value->get_array();
}

json::value IdAt(const json::object& object) {
  const json::value* id = object.if_contains("id");
  if (id == nullptr || id->is_null()) return nullptr;
  const bool short_text = id->is_string() && id->get_string().size() <= kMaxNameBytes;
  if (short_text || id->is_int64() || id->is_uint64()) return *id;
  throw Wrong{"\"id\" must be a whole number or a short string"};
}

PageCall ReadCall(const json::object& object) {
  PageCall call;
  call.id = IdAt(object);
  call.module = ModuleAt(object);
  call.channel = NameAt(object, "channel");
  call.token = NameAt(object, "token");
  const json::value* command = object.if_contains("command");
  if (object.contains("line")) {
    if (command != nullptr) throw Wrong{"give either \"line\" or \"command\", not both"};
    call.line = StringAt(object, "line");
    if (call.line->find_first_of("\r\n") != std::string::npos) throw Wrong{"\"line\" must be one line"};
    return call;
  }
  if (command != nullptr && command->is_string()) {
    call.command_name = NameAt(object, "command");
  } else if (const auto id = command != nullptr ? ToInt32(*command) : std::nullopt) {
    call.message.command = *id;
  } else {
    throw Wrong{R"(say which command: "command": "get_pose" or its number)"};
  }
  call.message.text = StringAt(object, "text");
  for (const json::value& value : ArrayAt(object, "params")) {
    const auto param = ToInt32(value);
    if (!param) throw Wrong{"\"params\" must be a list of whole numbers (32 bits)"};
    call.message.params.push_back(*param);
  }
  for (const json::value& value : ArrayAt(object, "data")) {
    const auto number = ToNumber(value);
    if (!number) throw Wrong{R"("data" must be a list of numbers (or "inf", "-inf", "nan"))"};
    call.message.data.push_back(*number);
  }
  return call;
}

std::optional<Vector3> PointAt(const json::object& object, std::string_view key) {
  const json::array& array = ArrayAt(object, key);
  if (array.empty()) return std::nullopt;
  Vector3 point;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = array.size() == 3 ? ToNumber(array[i]) : std::nullopt;
    if (!number) throw Wrong{"\"" + std::string(key) + "\" must be three numbers, in metres"};
    point[static_cast<Eigen::Index>(i)] = *number;
  }
  return point;
}

PageView ReadView(const json::object& object) {
  if (!object.contains("width")) return {};
  ImageRequest request;
  const auto width = ToInt32(object.at("width"));
  const auto height = object.contains("height") ? ToInt32(object.at("height")) : std::nullopt;
  if (!width || !height) throw Wrong{"\"width\" and \"height\" must be whole numbers of pixels"};
  request.width = *width;
  request.height = *height;
  request.eye_m = PointAt(object, "eye");
  request.look_m = PointAt(object, "look");
  const json::value* rays = object.if_contains("rays");
  request.show_rays = rays != nullptr && rays->is_bool() && rays->get_bool();
  request.format = ImageFormat::kJpeg;
  if (std::string error = CheckImageRequest(request); !error.empty()) throw Wrong{std::move(error)};
  return PageView{std::move(request)};
}

double RateAt(const json::object& object, const std::string& type) {
  const json::value* rate = object.if_contains("rate");
  if (rate == nullptr || !rate->is_number() || !(rate->to_number<double>() >= 0))
    throw Wrong{type + " need a rate per second, 0 for none: {\"type\":\"" + type + "\",\"rate\":30}"};
  return std::min(rate->to_number<double>(), PagePoses::kMaxRate_hz);
}

PageMessage ReadObject(const json::object& object) {
  const std::string type = NameAt(object, "type");
  if (type.empty() || type == "call") return ReadCall(object);
  if (type == "hello") return PageHello{NameAt(object, "token")};
  if (type == "view") return ReadView(object);
  if (type == "shown") return PageShown{};
  if (type == "poses") return PagePoses{RateAt(object, type)};
  if (type == "sensors") return PageSensors{RateAt(object, type)};
  if (type == "close") return PageClose{ModuleAt(object), NameAt(object, "channel")};
  if (type == "me") {
    PageMe me{NameAt(object, "name"), NameAt(object, "selected")};
    const bool fits =
        me.name.size() <= PageMe::kMaxNameBytes && me.selected.size() <= PageMe::kMaxSelectedBytes;
    if (!fits) throw Wrong{"a name has at most 40 bytes, what is selected 63"};
    return me;
  }
  throw Wrong{"unknown type: write call, hello, view, shown, poses, sensors, close or me"};
}

json::value NumberOrWord(double value) {
  if (std::isfinite(value)) return value;
  std::string word;
  AppendDouble(value, word);
  return json::string(word);
}

}  // namespace

PageRead ReadPageMessage(std::string_view text) {
  PageRead read;
  boost::system::error_code failed;
  const json::value value = json::parse(text, failed);
  if (failed || !value.is_object()) {
    read.error = R"(not a JSON object: write e.g. {"id":1,"module":"/robot1/pose","command":"get_pose"})";
    return read;
  }
  try {
    read.id = IdAt(value.get_object());
    read.message = ReadObject(value.get_object());
  } catch (const Wrong& wrong) {
    read.error = wrong.text;
  }
  return read;
}

std::string WritePageReply(const PageReply& reply) {
  const Message& message = reply.message;
  json::array data;
  for (const double value : message.data) data.push_back(NumberOrWord(value));
  json::object said;
  if (reply.id) {
    said["id"] = *reply.id;
  } else {
    said["push"] = true;
  }
  said["module"] = reply.module;
  if (!reply.channel.empty()) said["channel"] = reply.channel;
  said["error"] = message.error;
  said["text"] = message.text;
  said["command"] = message.command;
  said["params"] = json::value_from(message.params);
  said["data"] = std::move(data);
  if (!reply.line.empty()) said["line"] = reply.line;
  if (reply.sent) {
    json::array sent_data;
    for (const double value : reply.sent->data) sent_data.push_back(NumberOrWord(value));
    said["sent"] = {{"command", reply.sent->command},
                    {"params", json::value_from(reply.sent->params)},
                    {"data", std::move(sent_data)},
                    {"text", reply.sent->text}};
  }
  if (!reply.note.empty()) said["note"] = reply.note;
  return JsonText(said);
}

}  // namespace coopdyn
