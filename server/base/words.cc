// SPDX-License-Identifier: MIT
#include "server/base/words.h"

#include <algorithm>

namespace coopdyn {

std::string ToLower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::string ToUpper(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return out;
}

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> SplitWords(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  constexpr const char* kBlank = " \t\r\n";
  while ((at = text.find_first_not_of(kBlank, at)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlank, at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string JoinNames(std::span<const std::string> names, bool quoted) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " and " : ", ";
    out += quoted ? "'" + names[i] + "'" : names[i];
  }
  return out;
}

namespace {

/// Edits (insert, remove, replace, swap of neighbours) that turn `a` into `b`.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        now[j] = std::min(now[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

}  // namespace

std::string_view RootElement(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\r\n", kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
    const bool comment = text.starts_with("<!--");
    if (!comment && !text.starts_with("<?") && !text.starts_with("<!DOCTYPE")) break;
    const std::string_view end = comment ? "-->" : ">";
    const std::size_t at = text.find(end, comment ? 4 : 2);
    if (at == std::string_view::npos) return {};
    text.remove_prefix(at + end.size());
  }
  const std::size_t end = text.find_first_of(" \t\r\n/>");
  if (!text.starts_with('<') || end == std::string_view::npos) return {};
  return text.substr(1, end - 1);
}

std::string Nearest(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t kLongest = 64, kShortest = 3;
  if (word.empty() || word.size() > kLongest) return {};
  const std::string lower = ToLower(word);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, std::min<std::size_t>(3, word.size() / 2)) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(lower, ToLower(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  // A prefix of a candidate is no coincidence.
  const auto begun = [&lower](const std::string& candidate) { return ToLower(candidate).starts_with(lower); };
  const auto found = std::ranges::find_if(candidates, begun);
  return word.size() < kShortest || found == candidates.end() ? "" : *found;
}

std::string DidYouMean(std::string_view word, std::span<const std::string> candidates) {
  const std::string best = Nearest(word, candidates);
  if (!best.empty()) return "; did you mean '" + best + "'?";
  if (candidates.empty()) return {};
  constexpr std::size_t kShown = 24;
  if (candidates.size() > kShown) return "; known are " + JoinNames(candidates.first(kShown)) + " and others";
  return "; known are " + JoinNames(candidates);
}

}  // namespace coopdyn
