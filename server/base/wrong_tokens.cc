// SPDX-License-Identifier: MIT
#include "server/base/wrong_tokens.h"

#include <arpa/inet.h>

#include <algorithm>

namespace coopdyn {

namespace {

/// After this time without a wrong token, an address's count restarts at 0.
constexpr Nanoseconds kForgotten = 600 * kNanosecondsPerSecond;

}  // namespace

std::string NetworkOf(const std::string& peer) {
  std::string address = peer.substr(peer.rfind(' ') + 1);  // without "page "
  address.resize(std::min(address.rfind(':'), address.size()));
  if (address.size() < 2 || address.front() != '[') return address;
  in6_addr bytes{};
  if (inet_pton(AF_INET6, address.substr(1, address.size() - 2).c_str(), &bytes) != 1) return address;
  std::fill(bytes.s6_addr + 8, bytes.s6_addr + 16, 0);
  char text[INET6_ADDRSTRLEN] = "";
  inet_ntop(AF_INET6, &bytes, text, sizeof(text));
  return std::string(text) + "/64";
}

TokenVerdict WrongTokens::Judge(bool right, const std::string& peer, Nanoseconds now,
                                const std::string& what) {
  const std::string address = NetworkOf(peer), key = KeyOf(address, what);
  int wrong = 0;
  {
    const MutexLock lock(mutex_);
    if (WaitOf(address, what, now) > 0) return TokenVerdict::kTooSoon;
    if (right) {
      const auto mine = tries_.extract(key);
      const auto all = tries_.find(address + kAll);
      if (mine && all != tries_.end() && (all->second.wrong -= mine.mapped().wrong) <= 0) tries_.erase(all);
      return TokenVerdict::kRight;
    }
    wrong = Count(key, kFree, now);
    Count(address + kAll, kFreeForAll, now);
  }
  logger_->warn("a wrong {} from {} ({} so far)", what.empty() ? "token" : "PIN for " + what, peer, wrong);
  return TokenVerdict::kWrong;
}

int WrongTokens::Count(const std::string& key, int free, Nanoseconds now) {
  if (!tries_.contains(key)) MakeRoom(now);
  Tries& tries = tries_[key];
  if (now - tries.last > kForgotten) tries = {};
  ++tries.wrong;
  tries.last = tries.next = now;
  constexpr int kLongestPower = 6;
  if (tries.wrong >= free) {
    const Nanoseconds wait = kNanosecondsPerSecond << std::min(tries.wrong - free, kLongestPower);
    tries.next = now + std::min(wait, kLongestWait);
  }
  return tries.wrong;
}

Nanoseconds WrongTokens::WaitOf(const std::string& address, const std::string& what, Nanoseconds now) const {
  Nanoseconds next = now;
  for (const std::string& key : {KeyOf(address, what), address + kAll}) {
    const auto found = tries_.find(key);
    if (found != tries_.end()) next = std::max(next, found->second.next);
  }
  return next - now;
}

std::string WrongTokens::WaitText(const std::string& peer, Nanoseconds now, const std::string& what) const {
  const MutexLock lock(mutex_);
  const Nanoseconds wait = WaitOf(NetworkOf(peer), what, now);
  if (wait <= 0) return {};
  const Nanoseconds wait_s = (wait + kNanosecondsPerSecond - 1) / kNanosecondsPerSecond;
  return std::string("too many wrong ") + (what.empty() ? "tokens" : "PINs") +
         " came from your address: wait " + std::to_string(wait_s) + " s, then try again";
}

void WrongTokens::MakeRoom(Nanoseconds now) {
  if (tries_.size() < kMaxCounts) return;
  std::erase_if(tries_, [now](const auto& item) { return now - item.second.last > kForgotten; });
  if (tries_.size() < kMaxCounts) return;
  tries_.erase(std::min_element(tries_.begin(), tries_.end(),
                                [](const auto& a, const auto& b) { return a.second.last < b.second.last; }));
}

bool TokenGuard::Matches(std::string_view given) const {
  if (token_.empty()) return false;
  unsigned difference = token_.size() == given.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(token_[i % token_.size()]);
  }
  return difference == 0;
}

TokenVerdict TokenGuard::Judge(std::string_view given, const std::string& peer, Nanoseconds now) const {
  const bool right = Matches(given);
  if (wrong_ != nullptr) return wrong_->Judge(right, peer, now);
  return right ? TokenVerdict::kRight : TokenVerdict::kWrong;
}

}  // namespace coopdyn
