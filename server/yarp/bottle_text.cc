// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/codec.h"
#include "protocol/text_scan.h"
#include "server/yarp/bottle.h"

namespace coopdyn {
namespace {

bool IsSpace(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\n' || c == '\0';
}

std::optional<BottleValue> WholeNumber(std::string_view token) {
  const bool minus = token.starts_with('-');
  if (minus || token.starts_with('+')) token.remove_prefix(1);
  const bool hex = token.starts_with("0x") || token.starts_with("0X");
  if (hex) token.remove_prefix(2);
  std::uint64_t size = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, size, hex ? 16 : 10);
  if (error != std::errc() || stop != end || size > std::uint64_t{INT64_MAX}) return {};
  const std::int64_t value = minus ? -static_cast<std::int64_t>(size) : static_cast<std::int64_t>(size);
  if (value < INT32_MIN || value > INT32_MAX) return BottleValue{value};
  return BottleValue{static_cast<std::int32_t>(value)};
}

BottleValue TokenValue(std::string_view token) {
  if (token == "true") return {YarpVocab{"1"}};
  if (token == "false") return {YarpVocab{}};
  if (token == "null") return {YarpVocab{"null"}};
  if (token.size() >= 2 && token.size() <= 6 && token.front() == '[' && token.back() == ']')
    return {YarpVocab{std::string(token.substr(1, token.size() - 2))}};
  if (std::optional<BottleValue> whole = WholeNumber(token)) return *std::move(whole);
  double value = 0;
  if (ReadDouble(token, value) == NumberRead::kOk) return {value};
  return {std::string(token)};
}

class TextReader {
 public:
  explicit TextReader(std::string_view text) : text_(text) {}

  /// The items before `end`, consuming `end`; '\0' means the end of the text.
  std::optional<Bottle> Items(char end, std::size_t depth) {
    if (depth > kMaxBottleDepth) return {};
    Bottle items;
    while (true) {
      while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
      if (at_ == text_.size()) return end == '\0' ? std::optional(std::move(items)) : std::nullopt;
      const char c = text_[at_];
      if (c == end) {
        ++at_;
        return items;
      }
      std::optional<BottleValue> item = c == '(' || c == '{' ? Nested(depth)
                                        : c == '"'           ? Quote()
                                                             : Plain(end);
      if (!item) return {};
      items.push_back(std::move(*item));
    }
  }

 private:
  std::optional<BottleValue> Nested(std::size_t depth) {
    const bool blob = text_[at_++] == '{';
    std::optional<Bottle> items = Items(blob ? '}' : ')', depth + 1);
    if (!items) return {};
    if (!blob) return BottleValue{std::move(*items)};
    YarpBlob bytes;
    for (const BottleValue& item : *items) {
      const std::int32_t* const byte = item.As<std::int32_t>();
      bytes.bytes += static_cast<char>(byte == nullptr ? 0 : *byte);
    }
    return BottleValue{std::move(bytes)};
  }

  std::optional<BottleValue> Quote() {
    std::string text;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] != '\\' || at_ + 1 == text_.size()) {
        text += text_[at_];
        continue;
      }
      const char escaped = text_[++at_];
      text += escaped == 'n' ? '\n' : escaped == 'r' ? '\r' : escaped == '0' ? '\0' : escaped;
    }
    if (at_ == text_.size()) return {};
    ++at_;
    return BottleValue{std::move(text)};
  }

  BottleValue Plain(char end) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !IsSpace(text_[at_]) && text_[at_] != '(' && text_[at_] != '{' &&
           text_[at_] != '"' && (end == '\0' || text_[at_] != end))
      ++at_;
    return TokenValue(text_.substr(begin, at_ - begin));
  }

  const std::string_view text_;
  std::size_t at_ = 0;
};

bool NeedsQuotes(std::string_view text) {
  const auto plain = [](char c) { return IsLetter(c) || IsDigit(c) || c == '_' || c == '.' || c == '-'; };
  return text.empty() || text == "true" || text == "false" || text == "null" || text.front() == '.' ||
         text.front() == '-' || IsDigit(text.front()) || !std::all_of(text.begin(), text.end(), plain) ||
         !TokenValue(text).As<std::string>();
}

void AppendText(const BottleValue& item, std::string& out) {
  struct {
    std::string& out;
    void operator()(std::int32_t value) const { out += std::to_string(value); }
    void operator()(std::int64_t value) const { out += std::to_string(value); }
    void operator()(double value) const { AppendDouble(value, out); }
    void operator()(const std::string& text) const {
      if (!NeedsQuotes(text)) {
        out += text;
        return;
      }
      out += '"';
      for (const char c : text) {
        if (c == '\n' || c == '\r' || c == '\0' || c == '\\' || c == '"') out += '\\';
        out += c == '\n' ? 'n' : c == '\r' ? 'r' : c == '\0' ? '0' : c;
      }
      out += '"';
    }
    void operator()(const YarpVocab& vocab) const {
      out += vocab.text.empty() ? "false" : vocab.text == "1" ? "true" : "[" + vocab.text + "]";
    }
    void operator()(const YarpBlob& blob) const {
      out += '{';
      for (const char& byte : blob.bytes) {
        if (&byte != blob.bytes.data()) out += ' ';
        out += std::to_string(static_cast<unsigned char>(byte));
      }
      out += '}';
    }
    void operator()(const Bottle& list) const { out += "(" + BottleText(list) + ")"; }
  } const append{out};
  std::visit(append, item.value);
}

}  // namespace

std::optional<Bottle> ParseBottle(std::string_view text) {
  return TextReader(text).Items('\0', 0);
}

void OpenBottle::Take(char c) {
  last_ = c;
  if (std::exchange(escaped_, false)) return;
  if (quoted_ && c == '\\') {
    escaped_ = true;
  } else if (c == '"') {
    quoted_ = !quoted_;
  } else if (!quoted_) {
    lists_ += c == '(' || c == '{' ? 1 : c == ')' || c == '}' ? -1 : 0;
  }
}

std::string BottleText(const Bottle& bottle) {
  std::string text;
  for (const BottleValue& item : bottle) {
    if (&item != bottle.data()) text += ' ';
    AppendText(item, text);
  }
  return text;
}

}  // namespace coopdyn
