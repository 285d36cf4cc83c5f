// SPDX-License-Identifier: MIT
#include "server/state/run_control.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "protocol/ascii.h"

namespace coopdyn {

const char* ToString(RunState state) {
  constexpr std::array kNames{"running", "paused", "waiting", "playing", "ended"};
  return kNames[static_cast<std::size_t>(state)];
}

bool IsLogName(std::string_view name) {
  constexpr std::size_t kLongest = 63;
  return !name.empty() && name.size() <= kLongest && IsLetter(name.front()) &&
         std::ranges::all_of(name, [](char c) { return IsLetter(c) || IsDigit(c) || c == '_'; });
}

const char* ToString(RunEnd end) {
  constexpr std::array kNames{"duration", "controller", "recording", "quit",      "signal",
                              "score",    "limit",      "client",    "supervisor"};
  return kNames[static_cast<std::size_t>(end)];
}

std::string RunEndedText(const std::string& why) {
  constexpr std::string_view kRun = "the run ";
  return "the run has ended: " + (why.starts_with(kRun) ? "it " + why.substr(kRun.size()) : why);
}

const char* WhyEarly(RunEnd end) {
  constexpr std::array kTexts{"for an unknown reason",
                              "because a controller failed",
                              "because the recording failed",
                              "by quit",
                              "by a signal",
                              "by a score",
                              "by the limit of a score",
                              "by a client",
                              "by the supervisor"};
  return kTexts[static_cast<std::size_t>(end)];
}

void RunControl::AddDeed(Event deed, const std::string& by) {
  constexpr std::ptrdiff_t kNewest = 4;
  const std::string plain = deed.text;
  deed.text += " by " + by;
  const MutexLock lock(mutex_);
  const auto newest = events_.end() - std::min<std::ptrdiff_t>(kNewest, std::ssize(events_));
  const auto own = std::find_if(newest, events_.end(), [&](const Event& one) { return one.text == plain; });
  if (own != events_.end()) {
    own->text = deed.text;
    return;
  }
  const auto same =
      std::find_if(newest, events_.end(), [&](const Event& one) { return one.text == deed.text; });
  if (same != events_.end()) events_.erase(same);
  events_.push_back(std::move(deed));
  if (events_.size() > kMaxEvents) events_.pop_front();
}

}  // namespace coopdyn
