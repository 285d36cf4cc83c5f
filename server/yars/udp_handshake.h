// SPDX-License-Identifier: MIT
// The handshakes of YARS's UDP protocol: the robot's structure as a list of tags, depth first. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/yars/wire.h"

namespace coopdyn {

class YarsUdpHandshake {
 public:
  static constexpr std::size_t kUsable = 1020;  // bytes of a datagram

  YarsUdpHandshake() = default;
  explicit YarsUdpHandshake(const YarsChannel& channel);

  /// Appends as many tags as fit, without mappings and auxiliary values. The next call continues; after the
  /// last tag it starts again.
  void AppendBasic(std::string& datagram);
  /// Restarts AppendExtended().
  void BeginExtended();
  bool in_extended() const { return in_extended_; }
  /// Appends the tags up to the next motor or value and its mapping; or, after a mapping, the entry's name.
  void AppendExtended(std::string& datagram);

  /// True if both have motors and values of the same names.
  bool IsLike(const YarsUdpHandshake& other) const;
  /// Indices of motors and values in the channel, in the order of the tags.
  const std::vector<std::size_t>& motor_order() const { return motor_order_; }
  const std::vector<std::size_t>& value_order() const { return value_order_; }
  /// The number of leading values that are not auxiliary.
  std::size_t sensor_count() const { return sensor_count_; }

 private:
  struct Tag {
    std::int32_t tag = 0;
    bool is_entry = false;
    YarsEntry entry = {};
  };

  std::vector<Tag> tree_;
  std::vector<std::size_t> motor_order_, value_order_;
  std::size_t sensor_count_ = 0;
  std::size_t next_entry_ = 0;  // index into tree_
  bool names_next_ = false;     // the name of tree_[next_entry_ − 1] comes next
  bool in_extended_ = false;
};

}  // namespace coopdyn
