// SPDX-License-Identifier: MIT
#include "server/yarp/world_call.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include "protocol/ascii.h"

namespace coopdyn {
namespace {

constexpr std::size_t kMaxThingsName = 63;

bool IsOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}
bool IsWordOf(std::string_view word, std::string_view signs) {
  return !word.empty() && word.size() <= kMaxThingsName && std::ranges::all_of(word, [signs](char c) {
    return IsLower(c) || IsUpper(c) || IsDigit(c) || signs.find(c) != std::string_view::npos;
  });
}

/// Structs may arrive as lists.
void FlattenParts(const Bottle& bottle, std::size_t at, std::vector<const BottleValue*>& parts) {
  for (; at < bottle.size(); ++at) {
    if (const Bottle* const inner = bottle[at].As<Bottle>()) {
      FlattenParts(*inner, 0, parts);
    } else {
      parts.push_back(&bottle[at]);
    }
  }
}

/// True if a section of this name is not a thing's.
bool IsOtherSection(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) { return ToLower(c); });
  return IsOneOf(name, {"world", "simulation", "target", "floor", "set"}) ||
         IsOneOf(name.substr(0, name.find('_')), {"robot", "swarm", "light", "score", "random"});
}

}  // namespace

bool WorldRequest::Take(std::string_view part, const BottleValue& value) {
  const std::string_view word = value.word();
  const std::optional<double> number = NumberOf(value);
  const bool is_word = value.As<std::string>() != nullptr || value.As<YarpVocab>() != nullptr;
  if (IsOneOf(part, {"ON", "[GRAVITY]", "[COLLISION]"})) {
    const bool yes = IsOneOf(word, {"ok", "1", "true"});
    if (!number && !yes && !IsOneOf(word, {"fail", "0", "false", ""})) return false;
    typed |= !IsOneOf(word, {"ok", "fail"});
    (part == "ON" ? on : part == "[GRAVITY]" ? gravity : collision) = number ? *number != 0 : yes;
    return true;
  }
  if (IsOneOf(part, {"[FRAME]", "[NAME]"})) {
    (part == "[NAME]" ? name : frame) = word;
    return is_word;
  }
  if (IsOneOf(part, {"ID", "LINK", "MODEL", "NEW_NAME"})) {
    words.emplace_back(word);
    return is_word;
  }
  if (!number || !std::isfinite(*number)) return false;
  const bool is_place = IsOneOf(part, {"X", "Y", "Z", "ROLL", "PITCH", "YAW"});
  (is_place ? pose : IsOneOf(part, {"RED", "GREEN", "BLUE"}) ? color : sizes_m).push_back(*number);
  return true;
}

std::string WorldCallUsage(const WorldCall& call) {
  return std::string(call.name) + (call.parts.empty() ? "" : " ") + std::string(call.parts);
}

bool ReadWorldParts(const Bottle& bottle, std::size_t from, WorldRequest& request) {
  std::vector<const BottleValue*> given;
  FlattenParts(bottle, from, given);
  std::string_view parts = request.call->parts;
  auto next = given.begin();
  for (; next != given.end() && !parts.empty(); ++next) {
    const std::string_view part = parts.substr(0, parts.find(' '));
    if (!request.Take(part, **next)) return false;
    parts.remove_prefix(std::min(part.size() + 1, parts.size()));
  }
  request.typed |= !parts.empty();
  return next == given.end() && (parts.empty() || parts.front() == '[');
}

std::string WhyNoRequest(WorldRequest& request) {
  const WorldAct act = request.call->act;
  if (act == WorldAct::kRefuse) return std::string(request.call->thing);
  if (!request.collision || (act == WorldAct::kCollision && !request.on))
    return "things always touch each other here: say 1 for COLLISION, or nothing";
  if (std::ranges::any_of(request.color, [](double part) { return part < 0 || part > 255; }))
    return "red, green and blue are from 0 to 255";
  if (request.frame == "world") request.frame.clear();
  std::vector<std::string> names = request.words;
  if (act == WorldAct::kLoad) {
    names.clear();
    std::string& model = request.words[0];
    constexpr std::string_view kScheme = "model://";
    if (model.starts_with(kScheme))
      model = model.substr(kScheme.size(), model.find('/', kScheme.size()) - kScheme.size());
    if (!IsWordOf(model, "_-.") || model.front() == '.')
      return "a model is called by the name of its folder in robots/ on the search path, as in "
             "loadModelFromFile coopbot, not by a path";
  }
  if (act == WorldAct::kMake && IsOtherSection(request.name))
    return request.name + " would be a section of another kind in a scenario: take another name";
  if (!request.name.empty()) names.push_back(request.name);
  if (std::ranges::all_of(names, [](const std::string& name) { return IsWordOf(name, "_-"); })) return {};
  return "a name has letters, digits, _ and -, at most 63";
}

}  // namespace coopdyn
