// SPDX-License-Identifier: MIT
// What joints, muscles and thrusters of a robot have in common: they are driven one by one, by name or id.
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

/// Ids of those of `whose` parts, called `names`, that are meant. `one` of them is a "joint". Throws Error.
std::vector<std::int32_t> Chosen(const Which& which, const std::vector<std::string>& names,
                                 const std::string& one, const std::string& whose);
/// One value for each of `count`: as many, or one for all.
std::vector<double> Spread(const std::vector<double>& values, std::size_t count, const std::string& one);

class Parts {
 public:
  const std::string& name() const;
  /// Of them all, in their order: the first has the id 1.
  const std::vector<std::string>& names() const { return names_; }

 protected:
  /// `one` of them is a "joint"; the reply to the command `limits` has their names.
  Parts(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link, const char* one,
        std::int32_t limits);

  std::vector<std::int32_t> Ids(const Which& which) const;
  void Actuate(std::int32_t command, const std::vector<double>& values, const Which& which, const char* what);
  /// What is read of each, by column.
  std::vector<std::vector<double>> Columns(std::int32_t command, std::size_t count, const Which& which);

  std::shared_ptr<Session> session_;
  std::shared_ptr<RobotLink> link_;
  const char* one_;
  std::vector<std::string> names_;
};

}  // namespace coopdyn::client
