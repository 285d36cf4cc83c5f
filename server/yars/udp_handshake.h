// SPDX-License-Identifier: MIT
// The handshakes of YARS's UDP protocol: what a robot consists of, as a list of tags, depth first. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/yars/wire.h"

namespace coopdyn {

class YarsUdpHandshake {
 public:
  static constexpr std::size_t kUsable = 1020;  // of a datagram

  YarsUdpHandshake() = default;
  explicit YarsUdpHandshake(const YarsChannel& channel);

  /// Appends the tags alone, those of auxiliary values left out, as many as fit; the next call goes on, and
  /// after the last begins anew.
  void AppendBasic(std::string& datagram);
  /// From now on AppendExtended() begins anew.
  void BeginExtended();
  bool in_extended() const { return in_extended_; }
  /// Appends the tags up to the next motor or value and its mapping, or that one's name.
  void AppendExtended(std::string& datagram);

  /// It tells of motors and values of the same names.
  bool IsLike(const YarsUdpHandshake& other) const;
  /// Of motors and values in the order of the tags: their places in the channel's.
  const std::vector<std::size_t>& motor_order() const { return motor_order_; }
  const std::vector<std::size_t>& value_order() const { return value_order_; }
  /// The first of them, which are not auxiliary.
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
  std::size_t told_ = 0;     // of tree_
  bool names_next_ = false;  // the name of tree_[told_ − 1]
  bool in_extended_ = false;
};

}  // namespace coopdyn
