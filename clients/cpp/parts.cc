// SPDX-License-Identifier: MIT
#include "clients/cpp/parts.h"

#include <set>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"

namespace coopdyn::client {

std::vector<std::int32_t> SelectIds(const Which& which, const std::vector<std::string>& names,
                                    const std::string& one, const std::string& whose) {
  const auto count = static_cast<std::int32_t>(names.size());
  std::vector<std::int32_t> ids = which.ids;
  for (const std::string& name : which.names) {
    const std::size_t before = ids.size();
    for (std::int32_t id = 1; id <= count; ++id) {  // values of a channel may share a name
      if (names[static_cast<std::size_t>(id) - 1] == name) ids.push_back(id);
    }
    if (ids.size() == before)
      throw Error(10, whose + " has no " + one + " '" + name + "'; " + Nearest(name, names) +
                          "there are: " + ListOf(names));
  }
  if (ids.empty()) {
    for (std::int32_t id = 1; id <= count; ++id) ids.push_back(id);
  }
  for (const std::int32_t id : ids) {
    if (id < 1 || id > count)
      throw Error(
          4, whose + " has the " + one + "s 1 to " + std::to_string(count) + ", not " + std::to_string(id));
  }
  if (std::set<std::int32_t>(ids.begin(), ids.end()).size() < ids.size())
    throw Error(2, "name each " + one + " once; there are: " + ListOf(names));
  return ids;
}

std::vector<double> Broadcast(const std::vector<double>& values, std::size_t count, const std::string& one) {
  if (values.size() == 1) return std::vector<double>(count, values[0]);
  if (values.size() != count)
    throw Error(3, "write a value for each of the " + std::to_string(count) + " " + one +
                       "s, or one for all, not " + std::to_string(values.size()));
  return values;
}

Parts::Parts(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link, const char* one,
             std::int32_t limits)
    : session_(std::move(session)), link_(std::move(link)), one_(one) {
  names_ = Words(link_->Read(link_->actuator, {limits}).text);
}

const std::string& Parts::name() const {
  return link_->actuator;
}

std::vector<std::int32_t> Parts::Ids(const Which& which) const {
  return SelectIds(which, names_, one_, link_->label());
}

void Parts::Actuate(std::int32_t command, const std::vector<double>& values, const Which& which,
                    const char* what) {
  for (const double value : values) Finite(value, what);
  std::vector<std::int32_t> ids = Ids(which);
  std::vector<double> data = Broadcast(values, ids.size(), one_);
  link_->Actuate(command, std::move(data), std::move(ids));
}

std::vector<std::vector<double>> Parts::Columns(std::int32_t command, std::size_t count, const Which& which) {
  const bool all = which.ids.empty() && which.names.empty();
  const std::vector<std::int32_t> ids = all ? std::vector<std::int32_t>{} : Ids(which);
  const std::size_t values = count * (all ? names_.size() : ids.size());
  const Message reply = link_->Read(link_->actuator, {command, ids});
  Require(reply, 0, values);
  std::vector<std::vector<double>> columns(count);
  for (std::size_t k = 0; k < values; ++k) columns[k % count].push_back(reply.data[k]);
  return columns;
}

}  // namespace coopdyn::client
