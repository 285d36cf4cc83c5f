// SPDX-License-Identifier: MIT
// The connections at a door. When there are too many, the oldest leaves of those who have the most, so nobody
// keeps the others out by opening many. The io_context's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace coopdyn {

class Crowd {
 public:
  using Ticket = std::uint64_t;

  /// `most`: connections of all; `most_of_one`: of one name.
  Crowd(std::size_t most, std::size_t most_of_one) : most_(most), most_of_one_(most_of_one) {}

  /// A connection of `who` has come; makes room for it. `leave` ends the connection, and may call nothing
  /// here.
  Ticket Enter(const std::string& who, std::function<void()> leave);
  /// It has ended, or is somebody else's concern; no matter whether it still is here.
  void Leave(Ticket ticket);
  /// Ends all.
  void Clear();

  bool contains(Ticket ticket) const { return guests_.contains(ticket); }
  std::size_t size() const { return guests_.size(); }

 private:
  struct Guest {
    std::string who;
    std::function<void()> leave;
  };
  void EndOldestOf(const std::string& who);

  const std::size_t most_, most_of_one_;
  Ticket last_ = 0;
  std::map<Ticket, Guest> guests_;             // the oldest first
  std::map<std::string, std::size_t> counts_;  // by Guest::who
};

}  // namespace coopdyn
