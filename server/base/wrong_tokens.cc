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
  const std::string address = NetworkOf(peer);
  int wrong = 0;
  {
    const MutexLock lock(mutex_);
    const auto found = tries_.find(address);
    if (found != tries_.end() && now < found->second.next) return TokenVerdict::kTooSoon;
    if (right) {
      if (found == tries_.end()) return TokenVerdict::kRight;
      if (const auto mine = found->second.wrong_for.extract(what)) found->second.wrong -= mine.mapped();
      if (found->second.wrong <= 0) tries_.erase(found);
      return TokenVerdict::kRight;
    }
    if (found == tries_.end()) MakeRoom(now);
    Tries& tries = tries_[address];
    if (now - tries.last > kForgotten) tries = {};
    wrong = ++tries.wrong;
    if (tries.wrong_for.size() < kMaxKinds || tries.wrong_for.contains(what)) ++tries.wrong_for[what];
    tries.last = tries.next = now;
    constexpr int kLongestPower = 6;
    if (wrong >= kFree) {
      const Nanoseconds wait = kNanosecondsPerSecond << std::min(wrong - kFree, kLongestPower);
      tries.next = now + std::min(wait, kLongestWait);
    }
  }
  logger_->warn("a wrong token from {} ({} so far)", peer, wrong);
  return TokenVerdict::kWrong;
}

std::string WrongTokens::WaitText(const std::string& peer, Nanoseconds now) const {
  const MutexLock lock(mutex_);
  const auto found = tries_.find(NetworkOf(peer));
  if (found == tries_.end() || now >= found->second.next) return {};
  const Nanoseconds wait_s = (found->second.next - now + kNanosecondsPerSecond - 1) / kNanosecondsPerSecond;
  return "too many wrong tokens came from your address: wait " + std::to_string(wait_s) +
         " s, then try again";
}

void WrongTokens::MakeRoom(Nanoseconds now) {
  if (tries_.size() < kMaxAddresses) return;
  std::erase_if(tries_, [now](const auto& item) { return now - item.second.last > kForgotten; });
  if (tries_.size() < kMaxAddresses) return;
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
