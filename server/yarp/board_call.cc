// SPDX-License-Identifier: MIT
#include "server/yarp/board_call.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

namespace coopdyn {
namespace {

/// Reads the arguments after a word.
class Arguments {
 public:
  Arguments(const Bottle& items, std::size_t at) : items_(items), at_(at) {}

  bool ok() const { return ok_; }
  bool at_end() const { return at_ >= items_.size(); }
  int NextJoint() {
    const std::optional<double> joint = at_end() ? std::nullopt : NumberOf(items_[at_++]);
    ok_ &= joint && std::abs(*joint) < 1e9 && *joint == std::round(*joint);
    return ok_ ? static_cast<int>(*joint) : 0;
  }
  std::vector<int> NextJoints() {
    std::vector<int> joints;
    const Bottle* const list = at_end() ? nullptr : items_[at_++].As<Bottle>();
    ok_ &= list != nullptr;
    if (list == nullptr) return joints;
    Arguments items(*list, 0);
    while (!items.at_end()) joints.push_back(items.NextJoint());
    ok_ &= items.ok();
    return joints;
  }
  /// Appends all remaining values, including those in nested lists.
  void AppendValues(BoardItem item, std::vector<double>& values) {
    for (; !at_end(); ++at_) AppendValue(item, items_[at_], values);
  }

 private:
  void AppendValue(BoardItem item, const BottleValue& value, std::vector<double>& values) {
    if (const auto* list = value.As<Bottle>()) {
      for (const BottleValue& each : *list) AppendValue(item, each, values);
      return;
    }
    std::optional<double> number = NumberOf(value);
    if (item == BoardItem::kMode) {
      const std::optional<BoardMode> mode = BoardModeNamed(WordOf(value));
      number = mode ? std::optional(static_cast<double>(*mode)) : std::nullopt;
    } else if (item == BoardItem::kCompliant) {
      const std::string word = WordOf(value);
      number = word == "comp" ? std::optional(1.0) : word == "stif" ? std::optional(0.0) : std::nullopt;
    }
    ok_ &= number.has_value();
    values.push_back(number.value_or(0));
  }

  const Bottle& items_;
  std::size_t at_;
  bool ok_ = true;
};

BoardCall Make(const BoardWord& word, bool tells, Arguments arguments, Arguments* values) {
  BoardCall call{.item = word.item, .tells = tells};
  if (word.scope == BoardScope::kCounted) arguments.NextJoint();
  if (word.scope == BoardScope::kOne) {
    call.joints = {arguments.NextJoint()};
  } else if (word.scope == BoardScope::kGroup || word.scope == BoardScope::kCounted) {
    call.joints = arguments.NextJoints();
  }
  if (!arguments.ok()) return RefuseBoardCall("joints are whole numbers, counted from 0");
  if (values == nullptr) values = &arguments;
  if (tells) values->AppendValues(word.item, call.values);
  if (values->ok()) return call;
  if (word.item == BoardItem::kMode)
    return RefuseBoardCall("the modes are idl, pos, posd, vel and torq: there is no pwm or current here");
  if (word.item == BoardItem::kCompliant) return RefuseBoardCall("the interaction modes are stif and comp");
  return RefuseBoardCall("values are numbers");
}

}  // namespace

BoardCall MakeBoardCall(const BoardWord& word, bool tells, const Bottle& request, std::size_t at) {
  return Make(word, tells, Arguments(request, at), nullptr);
}

BoardCall MakeBoardCall(const BoardWord& word, const Bottle& head, std::size_t at, const Bottle& body) {
  Arguments values(body, 0);
  return Make(word, true, Arguments(head, at), &values);
}

std::string WordOf(const BottleValue& value) {
  const auto* const code = value.As<std::int32_t>();
  if (code == nullptr) return std::string(value.word());
  char letters[sizeof *code + 1] = {};
  std::memcpy(letters, code, sizeof *code);
  return letters;
}

BoardCall RefuseBoardCall(std::string why) {
  BoardCall call;
  call.refusal = std::move(why);
  return call;
}

}  // namespace coopdyn
