// SPDX-License-Identifier: MIT
#include "clients/cpp/json.h"

#include <charconv>
#include <cstdint>

#include "clients/cpp/error.h"

namespace coopdyn::client {

class JsonParser {
 public:
  explicit JsonParser(std::string_view text) : text_(text) {}

  Json All() {
    Json value = Value(0);
    SkipBlanks();
    if (at_ != text_.size()) Fail();
    return value;
  }

 private:
  static constexpr int kMaxDepth = 100;

  [[noreturn]] void Fail() const { throw Error(7, "not JSON at character " + std::to_string(at_ + 1)); }
  void SkipBlanks() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  char Peek() {
    SkipBlanks();
    if (at_ >= text_.size()) Fail();
    return text_[at_];
  }
  void Expect(char c) {
    if (Peek() != c) Fail();
    ++at_;
  }
  bool Accept(char c) {
    if (Peek() != c) return false;
    ++at_;
    return true;
  }
  void Word(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) Fail();
    at_ += word.size();
  }

  Json Value(int depth) {
    if (depth > kMaxDepth) Fail();
    Json value;
    switch (Peek()) {
      case '{':
        value.kind_ = Json::Kind::kObject;
        ++at_;
        if (Accept('}')) return value;
        do {
          Peek();
          value.keys_.push_back(Text());
          Expect(':');
          value.items_.push_back(Value(depth + 1));
        } while (Accept(','));
        Expect('}');
        return value;
      case '[':
        value.kind_ = Json::Kind::kList;
        ++at_;
        if (Accept(']')) return value;
        do {
          value.items_.push_back(Value(depth + 1));
        } while (Accept(','));
        Expect(']');
        return value;
      case '"':
        value.kind_ = Json::Kind::kText;
        value.text_ = Text();
        return value;
      case 't':
        Word("true");
        value.kind_ = Json::Kind::kBool;
        value.number_ = 1;
        return value;
      case 'f':
        Word("false");
        value.kind_ = Json::Kind::kBool;
        return value;
      case 'n':
        Word("null");
        return value;
      default:
        value.kind_ = Json::Kind::kNumber;
        const auto [end, error] =
            std::from_chars(text_.data() + at_, text_.data() + text_.size(), value.number_);
        if (error != std::errc()) Fail();
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }
  }

  std::string Text() {
    Expect('"');
    std::string out;
    while (true) {
      if (at_ >= text_.size()) Fail();
      const char c = text_[at_++];
      if (c == '"') return out;
      if (c != '\\') {
        out += c;
        continue;
      }
      if (at_ >= text_.size()) Fail();
      const char escape = text_[at_++];
      const std::size_t which = std::string_view("\"\\/bfnrt").find(escape);
      if (which != std::string_view::npos) {
        out += "\"\\/\b\f\n\r\t"[which];
      } else if (escape == 'u') {
        AppendUtf8(CodePoint(), out);
      } else {
        Fail();
      }
    }
  }

  std::uint32_t Hex4() {
    std::uint32_t unit = 0;
    if (at_ + 4 > text_.size()) Fail();
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + at_ + 4, unit, 16);
    if (error != std::errc() || end != text_.data() + at_ + 4) Fail();
    at_ += 4;
    return unit;
  }

  std::uint32_t CodePoint() {
    const std::uint32_t first = Hex4();
    if (first < 0xD800 || first > 0xDBFF) return first;
    if (text_.substr(at_, 2) != "\\u") Fail();
    at_ += 2;
    return 0x10000 + ((first - 0xD800) << 10) + ((Hex4() - 0xDC00) & 0x3FF);
  }

  static void AppendUtf8(std::uint32_t c, std::string& out) {
    if (c < 0x80) {
      out += static_cast<char>(c);
      return;
    }
    const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    const std::uint32_t lead = more == 1 ? 0xC0 : more == 2 ? 0xE0 : 0xF0;
    out += static_cast<char>(lead | (c >> (6 * more)));
    for (int i = more - 1; i >= 0; --i) out += static_cast<char>(0x80 | ((c >> (6 * i)) & 0x3F));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

Json Json::Parse(std::string_view text) {
  return JsonParser(text).All();
}

const Json& Json::operator[](std::size_t index) const {
  static const Json nothing;
  return index < items_.size() ? items_[index] : nothing;
}

const Json& Json::operator[](std::string_view key) const {
  static const Json nothing;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (keys_[i] == key) return items_[i];
  }
  return nothing;
}

}  // namespace coopdyn::client
