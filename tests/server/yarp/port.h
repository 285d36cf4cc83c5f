// SPDX-License-Identifier: MIT
// An endpoint with a name and commands that does nothing: tests make the replies.
#pragma once

#include <string>
#include <utility>

#include "protocol/command_table.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class Port final : public Endpoint {
 public:
  Port(std::string path, CommandTable table) : path_(std::move(path)), table_(std::move(table)) {}
  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return table_; }
  void OnRequest(Connection& /*connection*/, Message /*request*/, ReplyFunction /*reply*/) override {}

 private:
  const std::string path_;
  const CommandTable table_;
};

}  // namespace coopdyn
