// SPDX-License-Identifier: MIT
#include "server/base/wrong_tokens.h"

#include <arpa/inet.h>

#include <algorithm>

namespace coopdyn {

namespace {

/// After this long without a wrong token, the count of an address starts at 0 again.
constexpr Nanoseconds kForgotten = 600 * kNanosecondsPerSecond;

/// The address of `peer`; of IPv6 the network, in which one machine has as many addresses as it likes.
std::string AddressOf(const std::string& peer) {
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

}  // namespace

TokenVerdict WrongTokens::Judge(bool right, const std::string& peer, Nanoseconds now) {
  const std::string address = AddressOf(peer);
  int wrong = 0;
  {
    const MutexLock lock(mutex_);
    const auto found = tries_.find(address);
    if (found != tries_.end() && now < found->second.next) return TokenVerdict::kTooSoon;
    if (right) {
      if (found != tries_.end()) tries_.erase(found);
      return TokenVerdict::kRight;
    }
    if (found == tries_.end()) MakeRoom(now);
    Tries& tries = tries_[address];
    if (now - tries.last > kForgotten) tries.wrong = 0;
    wrong = ++tries.wrong;
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
  const auto found = tries_.find(AddressOf(peer));
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

}  // namespace coopdyn
