// SPDX-License-Identifier: MIT
// Common base of a robot's joints, muscles and thrusters, which are addressed by name or id.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace coopdyn::client {

class Session;
struct RobotLink;

/// Joints, muscles or the like by name or by id, counted from 1; {}: all.
struct Which {
  Which() = default;
  Which(const char* name) : names{name} {}
  Which(std::string name) : names{std::move(name)} {}
  Which(std::int32_t id) : ids{id} {}
  Which(std::initializer_list<std::string> all) : names(all) {}
  Which(std::initializer_list<std::int32_t> all) : ids(all) {}
  Which(std::vector<std::string> all) : names(std::move(all)) {}
  Which(std::vector<std::int32_t> all) : ids(std::move(all)) {}

  std::vector<std::string> names;
  std::vector<std::int32_t> ids;
};

/// Ids of the parts that `which` selects among `names`, the parts of `whose`. `one`: their singular, e.g.
/// "joint". Throws Error.
std::vector<std::int32_t> SelectIds(const Which& which, const std::vector<std::string>& names,
                                    const std::string& one, const std::string& whose);
/// Returns `count` values; a single value is repeated.
std::vector<double> Broadcast(const std::vector<double>& values, std::size_t count, const std::string& one);

class Parts {
 public:
  const std::string& name() const;
  /// The names of all parts in order; the first has id 1.
  const std::vector<std::string>& names() const { return names_; }

 protected:
  /// `one`: their singular, e.g. "joint". The reply to the command `limits` has their names.
  Parts(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link, const char* one,
        std::int32_t limits);

  std::vector<std::int32_t> Ids(const Which& which) const;
  void Actuate(std::int32_t command, const std::vector<double>& values, const Which& which, const char* what);
  /// Reads `count` values of each part; returns them by column.
  std::vector<std::vector<double>> Columns(std::int32_t command, std::size_t count, const Which& which);

  std::shared_ptr<Session> session_;
  std::shared_ptr<RobotLink> link_;
  const char* one_;
  std::vector<std::string> names_;
};

}  // namespace coopdyn::client
