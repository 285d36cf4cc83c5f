// SPDX-License-Identifier: MIT
#include "server/yars/udp_handshake.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

enum : std::int32_t {
  kTagRobot = 0,
  kTagCompound = 100,
  kTagSegment = 200,
  kTagMotor = 300,
  kTagSensor = 400,
  kTagAuxiliary = 500,
  kTagMore = 999,
};

}  // namespace

YarsUdpHandshake::YarsUdpHandshake(const YarsChannel& channel) : tree_{{kTagRobot}, {kTagCompound}} {
  std::vector<std::size_t> auxiliary;
  std::int32_t segments = std::max(channel.segments, std::int32_t{1});
  for (const auto* entries : {&channel.motors, &channel.values}) {
    for (const YarsEntry& entry : *entries) segments = std::max(segments, entry.segment);
  }
  for (std::int32_t segment = 1; segment <= segments; ++segment) {
    const auto is_here = [&](const YarsEntry& entry) { return std::max(entry.segment, 1) == segment; };
    tree_.push_back({kTagSegment});
    for (std::size_t i = 0; i < channel.motors.size(); ++i) {
      if (!is_here(channel.motors[i])) continue;
      tree_.push_back({kTagMotor, true, channel.motors[i]});
      motor_order_.push_back(i);
    }
    for (const bool is_auxiliary : {false, true}) {
      for (std::size_t i = 0; i < channel.values.size(); ++i) {
        const YarsEntry& value = channel.values[i];
        if (!is_here(value) || value.auxiliary != is_auxiliary) continue;
        tree_.push_back({is_auxiliary ? kTagAuxiliary : kTagSensor, true, value});
        (is_auxiliary ? auxiliary : value_order_).push_back(i);
      }
    }
  }
  sensor_count_ = value_order_.size();
  value_order_.insert(value_order_.end(), auxiliary.begin(), auxiliary.end());
}

bool YarsUdpHandshake::IsLike(const YarsUdpHandshake& other) const {
  return std::equal(
      tree_.begin(), tree_.end(), other.tree_.begin(), other.tree_.end(),
      [](const Tag& a, const Tag& b) { return a.tag == b.tag && a.entry.name == b.entry.name; });
}

void YarsUdpHandshake::AppendBasic(std::string& datagram) {
  if (next_entry_ >= tree_.size() || in_extended_) next_entry_ = 0;
  in_extended_ = false;
  constexpr std::size_t kRoom = 12;  // for the last tags and a number
  for (; next_entry_ < tree_.size() && datagram.size() + kRoom <= kUsable; ++next_entry_) {
    if (tree_[next_entry_].tag != kTagAuxiliary) PutInt(tree_[next_entry_].tag, datagram);
  }
  if (next_entry_ < tree_.size()) PutInt(kTagMore, datagram);
}

void YarsUdpHandshake::BeginExtended() {
  in_extended_ = true;
  next_entry_ = 0;
  names_next_ = false;
}

void YarsUdpHandshake::AppendExtended(std::string& datagram) {
  if (std::exchange(names_next_, false)) {
    const std::string& name = tree_[next_entry_ - 1].entry.name;
    PutInt(static_cast<std::int32_t>(name.size()), datagram);
    datagram += name;
    return;
  }
  constexpr std::size_t kRoom = 24;  // for an entry and the end
  while (next_entry_ < tree_.size()) {
    if (datagram.size() + kRoom > kUsable) return PutInt(kTagMore, datagram);
    const Tag& tag = tree_[next_entry_++];
    PutInt(tag.tag, datagram);
    if (!tag.is_entry) continue;
    PutFloat(static_cast<float>(tag.entry.external_min), datagram);
    PutFloat(static_cast<float>(tag.entry.external_max), datagram);
    names_next_ = true;
    return;
  }
  in_extended_ = false;
}

}  // namespace coopdyn
