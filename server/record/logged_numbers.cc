// SPDX-License-Identifier: MIT
#include "server/record/logged_numbers.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <system_error>

namespace coopdyn {

namespace {

/// The newest of `numbers` at or before `step`.
const Logged* NewestOf(const std::vector<Logged>& numbers, std::uint64_t step) {
  const auto after = std::ranges::upper_bound(numbers, step, {}, &Logged::step);
  return after == numbers.begin() ? nullptr : &*std::prev(after);
}

}  // namespace

void LoggedNumbers::Add(std::span<const Event> events) {
  for (const Event& event : events) {
    const std::size_t blank = event.text.find(' ');
    if (event.level != kLogLevel || blank == std::string::npos) continue;
    Logged logged{event.step, event.time_s, 0};
    const char* end = event.text.data() + event.text.size();
    if (std::from_chars(event.text.data() + blank + 1, end, logged.value).ec != std::errc()) continue;
    by_name_[event.text.substr(0, blank)].push_back(logged);
  }
}

std::vector<std::string> LoggedNumbers::Names(std::uint64_t step) const {
  std::vector<std::string> names;
  for (const auto& [name, logged] : At(step)) names.push_back(name);
  return names;
}

const Logged* LoggedNumbers::Find(const std::string& name, std::uint64_t step) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : NewestOf(found->second, step);
}

std::map<std::string, Logged> LoggedNumbers::At(std::uint64_t step) const {
  std::map<std::string, Logged> newest;
  for (const auto& [name, numbers] : by_name_) {
    if (const Logged* logged = NewestOf(numbers, step)) newest.emplace(name, *logged);
  }
  return newest;
}

}  // namespace coopdyn
